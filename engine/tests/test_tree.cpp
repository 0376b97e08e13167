// Part trees under the sanitizers: surfaces of every kind, broken imports, early stops.
#include <algorithm>
#include <cstring>
#include <random>

#include "check.hpp"
#include "partuv/parts.hpp"
#include "partuv/topology.hpp"
#include "partuv/tree_cut.hpp"
#include "partuv/tree_import.hpp"
#include "partuv/tree_nbm.hpp"
#include "partuv/tree_ward.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

bool is_tree(const PartTree& tree) {
  const int faces = tree.face_count;
  std::vector<char> child(tree.begin.size(), 0);
  for (int i = 0; i < faces - 1; ++i) {
    const int node = faces + i, left = tree.left[i], right = tree.right[i];
    if (left >= node || right >= node || child[left]++ || child[right]++) return false;
    if (tree.begin[left] != tree.begin[node] || tree.end[left] != tree.begin[right] ||
        tree.end[right] != tree.end[node]) {
      return false;
    }
  }
  for (int f = 0; f < faces; ++f) {
    if (tree.size(f) != 1 || tree.order[tree.begin[f]] != f) return false;
  }
  return true;
}

/// Two charts, even and odd faces, get the parts of a surface whose proxy joins pairs of faces.
void check_parts(const Topology& topology, const PartTree& tree, const Context& context) {
  const Surface& surface = topology.surface;
  const int faces = surface.face_count();
  Proxy proxy;
  proxy.surface = surface;
  proxy.proxy_of_face.resize(faces);
  for (int f = 0; f < faces; ++f) proxy.proxy_of_face[f] = f / 2;
  PartPrior given;
  given.tree = tree;
  CHECK(choose_parts(searched_parts, {}, surface, proxy, tree, context).empty());
  for (const int parts : {named_parts, 1, 2, 1 << 20}) {
    for (const PartPrior& prior : {PartPrior{}, given}) {
      const std::vector<int32_t> labels = choose_parts(parts, prior, surface, proxy, tree, context);
      CHECK(static_cast<int>(labels.size()) == faces);
      std::vector<SolvedChart> charts(std::min(faces, 2));
      Atlas atlas;
      atlas.part.assign(topology.welded.size(), 0);
      for (int f = 0; f < faces; ++f) {
        charts[f % 2].flattening.piece.source_face.push_back(f);
        atlas.part[topology.source_face[f]] = 7 * (f % 2);
      }
      assign_parts(surface, labels, charts);
      for (const SolvedChart& chart : charts) {
        CHECK(std::find(labels.begin(), labels.end(), chart.part) != labels.end());
        atlas.charts.push_back({.part = chart.part});
      }
      write_parts(topology, labels, atlas);
      const int32_t last = *std::max_element(atlas.part.begin(), atlas.part.end());
      CHECK(atlas.part_count == last + 1);
      for (const ChartFigures& chart : atlas.charts) CHECK(chart.part <= last);
    }
  }
}

void check_surface(const Topology& topology, std::mt19937& random) {
  const Surface& surface = topology.surface;
  std::vector<float> features(4 * surface.faces.size());
  for (float& value : features) value = std::normal_distribution<float>()(random);
  Context late(1, 0.0), cancelled;
  cancelled.cancel();
  const Context patient;
  for (const Context* context : {&patient, &std::as_const(late), &std::as_const(cancelled)}) {
    const PartTree tree = build_nbm_tree(surface, {}, *context);
    CHECK(is_tree(tree));
    const auto ward = build_ward_tree(surface, features, 4, *context);
    CHECK(bool(ward) != context->cancelled());
    if (ward) CHECK(is_tree(ward.value()));
    for (const auto& labels : {cut_tree(tree, 7), cut_tree_auto(tree, surface, {})}) {
      CHECK(labels.size() == surface.faces.size());
      CHECK(labels_of_mesh(topology, labels).size() == topology.welded.size());
    }
    check_parts(topology, tree, *context);
  }
}

void check_import(std::mt19937& random) {
  const int faces = 9;
  std::vector<ImportedNode> nodes;
  for (int i = 0; i < faces - 1; ++i) nodes.push_back({faces + i, i ? faces + i - 1 : 0, i + 1});
  const auto chain = import_tree(faces, nodes);
  CHECK(bool(chain));
  CHECK(is_tree(chain.value()));
  std::vector<int32_t> words{faces - 1};
  for (const ImportedNode& node : nodes) {
    for (const int64_t word : {node.id, node.left, node.right}) {
      words.push_back(static_cast<int32_t>(word));
    }
  }
  std::vector<std::byte> file(4 * words.size());
  std::memcpy(file.data(), words.data(), file.size());
  CHECK(bool(read_tree_file(faces, file)));
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<std::byte> damaged = file;
    const size_t at = std::uniform_int_distribution<size_t>(0, file.size() - 1)(random);
    damaged[at] ^= static_cast<std::byte>(1 + random() % 255);
    if (trial % 4 == 0) damaged.resize(at);
    const auto tree = read_tree_file(faces, damaged);
    if (tree) {
      CHECK(is_tree(tree.value()));
    } else {
      CHECK(tree.failure().error == Error::invalid_tree);
    }
  }
  const auto kept = restrict_tree(chain.value(), {4, 0, 8});
  CHECK(kept && is_tree(kept.value()));
  CHECK(!restrict_tree(chain.value(), {4, 9}));
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  std::mt19937 random(1);
  for (partuv::Mesh mesh : {sheet(1, 1), sheet_with_hole(), tube(8, 5), torus(12, 8),
                            pierced_plate(2), sphere(3), soup(40, 400, random)}) {
    for (const double amount : {0.0, 0.3}) {
      shake(mesh, amount, random);
      const auto topology = partuv::build_topology(mesh);
      CHECK(bool(topology));
      if (topology) check_surface(topology.value(), random);
    }
  }
  check_import(random);
  return failures;
}
