#include "partuv/parts.hpp"

#include <algorithm>
#include <map>

#include "partuv/tree_cut.hpp"

namespace partuv {

std::vector<int32_t> choose_parts(int parts, const PartPrior& prior, const Surface& surface,
                                  const Proxy& proxy, const PartTree& tree,
                                  const Context& context) {
  if (parts == searched_parts) return {};
  const auto cut = [parts](const PartTree& t, const Surface& s) {
    return parts == named_parts ? cut_tree_auto(t, s, {}) : cut_tree(t, parts);
  };
  if (!prior.tree && prior.dimensions == 0) {
    return cut(build_nbm_tree(surface, named_part_options, context), surface);
  }
  const std::vector<int32_t> of_proxy = cut(tree, proxy.surface);
  std::vector<int32_t> labels(surface.faces.size());
  for (size_t f = 0; f < labels.size(); ++f) labels[f] = of_proxy[proxy.proxy_of_face[f]];
  return labels;
}

void assign_parts(const Surface& surface, const std::vector<int32_t>& labels,
                  std::vector<SolvedChart>& charts) {
  if (labels.empty()) return;
  for (SolvedChart& chart : charts) {
    std::map<int32_t, double> area;
    for (const int f : chart.flattening.piece.source_face) {
      area[labels[f]] += face_cross(surface, f).norm();
    }
    const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
    chart.part = std::max_element(area.begin(), area.end(), less)->first;
  }
}

void write_parts(const Topology& topology, const std::vector<int32_t>& labels, Atlas& atlas) {
  const std::vector<int32_t> before =
      labels.empty() ? atlas.part : labels_of_mesh(topology, labels);
  atlas.part = before;
  number_by_first_face(atlas.part);
  atlas.part_count = *std::max_element(atlas.part.begin(), atlas.part.end()) + 1;
  std::map<int32_t, int32_t> number;
  for (size_t f = 0; f < before.size(); ++f) number.emplace(before[f], atlas.part[f]);
  for (ChartFigures& chart : atlas.charts) chart.part = number.at(chart.part);
}

}  // namespace partuv
