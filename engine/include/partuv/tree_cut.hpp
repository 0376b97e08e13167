#pragma once

#include <vector>

#include "partuv/topology.hpp"
#include "partuv/tree.hpp"
#include "partuv/tree_nbm.hpp"

namespace partuv {

/// The options of `build_nbm_tree` for parts that people would name: convex creases do not count,
/// and no crease counts for everything, so that noise is not taken for one.
constexpr NbmOptions named_part_options{
    .convex_weight = 0.0, .contrast = 1.0, .least_similarity = 0.05};

struct PartCutOptions {
  /// Two regions are parts of their own where C (1 / area + 1 / area) of `build_nbm_tree` is below.
  double most_conductance = 1.7;
  double least_area = 0.005;  ///< share of the whole area below which nothing is a part of its own
  NbmOptions creases = named_part_options;
};

/// Part of each face once the last parts - 1 merges are undone (the root alone for parts <= 1, the
/// faces for as many parts as faces or more). Parts are numbered by their smallest face. O(F).
std::vector<int32_t> cut_tree(const PartTree& tree, int parts);

/// Part of each face for as many parts as people are likely to name. From the root down, a merge is
/// undone where the boundary between its sides is cut-like for their size, whatever built the tree;
/// what is too small to be a part goes with its surroundings. Near O(F).
std::vector<int32_t> cut_tree_auto(const PartTree& tree, const Surface& surface,
                                   const PartCutOptions& options);

/// Renumber labels (none negative) in the order of the first face that has them.
void number_by_first_face(std::vector<int32_t>& labels);

/// Labels of the faces of a surface brought to the mesh it was made from: a face outside of the
/// surface takes the label of a face that has a point in common with it, or else 0.
std::vector<int32_t> labels_of_mesh(const Topology& topology, const std::vector<int32_t>& labels);

}  // namespace partuv
