#include "partuv/tree.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "partuv/topology.hpp"
#include "partuv/tree_cut.hpp"
#include "partuv/tree_import.hpp"
#include "partuv/tree_nbm.hpp"
#include "partuv/tree_ward.hpp"
#include "raise.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace partuv {
namespace {

template <typename T>
using Matrix = nb::ndarray<const T, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using NodeArray = nb::ndarray<const int64_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using FaceList = nb::ndarray<const int32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Run `work` without the GIL; its failure is raised with it.
template <typename Work>
auto run(Work&& work) {
  auto result = [&] {
    nb::gil_scoped_release release;
    return work();
  }();
  if (!result) raise(result.failure());
  return std::move(result.value());
}

PartTree nbm(const Topology& topology, double convex_weight, double contrast,
             double least_similarity, const Context* context) {
  const Context unbounded;
  nb::gil_scoped_release release;
  return build_nbm_tree(topology.surface, {convex_weight, contrast, least_similarity},
                        context ? *context : unbounded);
}

PartTree part_tree(const Topology& topology, const Context* context) {
  const Context unbounded;
  nb::gil_scoped_release release;
  return build_nbm_tree(topology.surface, named_part_options, context ? *context : unbounded);
}

template <typename T>
PartTree ward(const Topology& topology, const Matrix<T>& features, const Context* context) {
  const Context unbounded;
  return run([&] {
    return build_ward_tree(topology.surface, std::span<const T>(features.data(), features.size()),
                           static_cast<int>(features.shape(1)), context ? *context : unbounded);
  });
}

PartTree import_nodes(int face_count, const NodeArray& nodes) {
  std::vector<ImportedNode> list(nodes.shape(0));
  for (size_t i = 0; i < list.size(); ++i) list[i] = {nodes(i, 0), nodes(i, 1), nodes(i, 2)};
  return run([&] { return import_tree(face_count, list); });
}

PartTree read_file(int face_count, const nb::bytes& file) {
  const auto* data = static_cast<const std::byte*>(file.data());
  return run([&] { return read_tree_file(face_count, {data, file.size()}); });
}

PartTree restrict_to(const PartTree& tree, const FaceList& representatives) {
  const std::vector<int32_t> list(representatives.data(),
                                  representatives.data() + representatives.shape(0));
  return run([&] { return restrict_tree(tree, list); });
}

/// Part of each face of the mesh; parts = 0: as many as people are likely to name.
nb::ndarray<nb::numpy, int32_t> part_labels(const Topology& topology, const PartTree& tree,
                                            int parts) {
  const std::string faces = std::to_string(tree.face_count);
  if (tree.face_count != topology.surface.face_count()) {
    raise({Error::invalid_tree, "tree of " + faces + " faces, surface of " +
                                    std::to_string(topology.surface.face_count())});
  }
  std::vector<int32_t> labels;
  {
    nb::gil_scoped_release release;
    labels = labels_of_mesh(
        topology, parts > 0 ? cut_tree(tree, parts) : cut_tree_auto(tree, topology.surface, {}));
    number_by_first_face(labels);
  }
  const size_t count = labels.size();
  return to_numpy(std::move(labels), {count});
}

/// A read-only view that keeps the tree alive.
template <std::vector<int32_t> PartTree::* Field>
auto view(const nb::object& self) {
  const std::vector<int32_t>& values = nb::cast<const PartTree&>(self).*Field;
  return nb::ndarray<nb::numpy, const int32_t, nb::ndim<1>>(values.data(), {values.size()}, self);
}

}  // namespace

void bind_tree(nb::module_& m) {
  nb::class_<PartTree>(m, "PartTree",
                       "Binary merge tree over F faces: nodes 0..F-1 are the faces, F..2F-2 the "
                       "merges in order; the faces of a node are order[begin[node]:end[node]].")
      .def_ro("face_count", &PartTree::face_count)
      .def_prop_ro("left", &view<&PartTree::left>)
      .def_prop_ro("right", &view<&PartTree::right>)
      .def_prop_ro("order", &view<&PartTree::order>)
      .def_prop_ro("begin", &view<&PartTree::begin>)
      .def_prop_ro("end", &view<&PartTree::end>)
      .def("restrict", &restrict_to, "representatives"_a,
           "The tree induced on some of the faces: leaf i is face representatives[i].");

  const NbmOptions defaults;
  m.def("build_nbm_tree", &nbm, "surface"_a, "convex_weight"_a = defaults.convex_weight,
        "contrast"_a = defaults.contrast, "least_similarity"_a = defaults.least_similarity,
        "context"_a = nb::none(), "The built-in part tree: short, concave cuts at the top.");
  m.def("build_ward_tree", &ward<float>, "surface"_a, "features"_a, "context"_a = nb::none(),
        "Area-weighted Ward clustering of features, a row per face of the surface.");
  m.def("build_ward_tree", &ward<double>, "surface"_a, "features"_a, "context"_a = nb::none());
  m.def("import_tree", &import_nodes, "face_count"_a, "nodes"_a,
        "A tree from its merges, rows of (id, left, right) in any order.");
  m.def("read_tree_file", &read_file, "face_count"_a, "file"_a,
        "A tree from the bytes of a PartUV tree file.");
  m.def("build_part_tree", &part_tree, "surface"_a, "context"_a = nb::none(),
        "The tree for parts that people would name: convex creases do not count.");
  m.def(
      "cut_tree",
      [](const Topology& topology, const PartTree& tree, int parts) {
        if (parts < 1) raise({Error::invalid_option, "option parts"});
        return part_labels(topology, tree, parts);
      },
      "surface"_a, "tree"_a, "parts"_a,
      "Part of each face of the mesh once the last parts - 1 merges are undone.");
  m.def(
      "cut_tree_auto",
      [](const Topology& topology, const PartTree& tree) { return part_labels(topology, tree, 0); },
      "surface"_a, "tree"_a,
      "Part of each face of the mesh for as many parts as people are likely to name.");
}

}  // namespace partuv
