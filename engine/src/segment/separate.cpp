#include "segment/separate.hpp"

#include <algorithm>
#include <cmath>

#include "buckets.hpp"
#include "planar.hpp"
#include "rounded.hpp"
#include "segment/evaluator.hpp"
#include "segment/minimum_cut.hpp"

namespace partuv {
namespace {

/// True if two counter-clockwise triangles have inner points in common: no side of either has the
/// other triangle wholly on its outside.
bool overlap(const std::vector<Vec2>& uv, const Triangle& s, const Triangle& t) {
  for (const auto& [own, other] : {std::pair(&s, &t), std::pair(&t, &s)}) {
    for (int k = 0; k < 3; ++k) {
      const Vec2 &a = uv[(*own)[k]], &b = uv[(*own)[(k + 1) % 3]];
      const double reach = std::max(
          {turn(a, b, uv[(*other)[0]]), turn(a, b, uv[(*other)[1]]), turn(a, b, uv[(*other)[2]])});
      if (reach <= 1e-9 * (b - a).squaredNorm()) return false;
    }
  }
  return true;
}

/// Pairs of faces that overlap, found over a grid of about one face per cell.
std::vector<std::pair<int32_t, int32_t>> overlapping_faces(const Surface& s,
                                                           const std::vector<Vec2>& uv) {
  Vec2 low = uv.front(), high = low;
  for (const Vec2& p : uv) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double cell = std::max((high - low).maxCoeff() / std::sqrt(1.0 + s.face_count()), 1e-12);
  const auto cell_of = [&](double from, double at) { return static_cast<int>((at - from) / cell); };
  const int columns = cell_of(low.x(), high.x()) + 1, rows = cell_of(low.y(), high.y()) + 1;
  const Buckets<int32_t> cells = grouped<int32_t>(columns * rows, [&](auto&& visit) {
    for (int f = 0; f < s.face_count(); ++f) {
      Vec2 from = uv[s.faces[f][0]], to = from;
      for (int k = 1; k < 3; ++k) {
        from = from.cwiseMin(uv[s.faces[f][k]]);
        to = to.cwiseMax(uv[s.faces[f][k]]);
      }
      for (int y = cell_of(low.y(), from.y()); y <= cell_of(low.y(), to.y()); ++y) {
        for (int x = cell_of(low.x(), from.x()); x <= cell_of(low.x(), to.x()); ++x) {
          visit(y * columns + x, f);
        }
      }
    }
  });
  const std::vector<int32_t>& inside = cells.items;
  std::vector<std::pair<int32_t, int32_t>> pairs;
  for (int c = 0; c < cells.count(); ++c) {
    for (int i = cells.start[c]; i < cells.start[c + 1]; ++i) {
      for (int j = i + 1; j < cells.start[c + 1]; ++j) {
        if (overlap(uv, s.faces[inside[i]], s.faces[inside[j]])) {
          pairs.emplace_back(inside[i], inside[j]);
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

/// Patch number of each marked face (connected across sides), -1 for the others.
std::vector<int32_t> patches(const Surface& s, const std::vector<char>& marked) {
  std::vector<int32_t> patch(marked.size(), -1), stack;
  int count = 0;
  for (int seed = 0; seed < s.face_count(); ++seed) {
    if (!marked[seed] || patch[seed] >= 0) continue;
    patch[seed] = count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h : s.opposite[f]) {
        if (h >= 0 && marked[h / 3] && patch[h / 3] < 0) {
          patch[h / 3] = count;
          stack.push_back(h / 3);
        }
      }
    }
    ++count;
  }
  return patch;
}

/// True for each face on the source's side of the cheapest cut of the dual graph, an edge as wide
/// as its 3D length. node: what each face is in the `MinimumCut`, several may be the same.
std::vector<char> cheapest_cut(const Surface& s, const std::vector<int32_t>& node, int nodes,
                               const Context& context) {
  constexpr double steps_per_length = 1 << 24;  // of a surface whose area is at most 1
  constexpr double widest = 1 << 29;
  MinimumCut graph;
  graph.reset(nodes);
  for (int f = 0; f < s.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int other = s.opposite[f][k] / 3;
      if (s.opposite[f][k] < 0 || other < f || node[other] == node[f]) continue;
      const double width = steps_per_length * rounded(side_length(s, 3 * f + k));
      graph.add_edge(node[f], node[other], 1 + static_cast<int32_t>(std::min(width, widest)));
    }
  }
  graph.solve(context);
  std::vector<char> side(s.faces.size());
  for (int f = 0; f < s.face_count(); ++f) side[f] = graph.on_source_side(node[f]);
  return side;
}

/// Join faces that are nodes of their own into clumps of neighbours; returns how many there are.
int clump(const Surface& s, std::vector<int32_t>& node) {
  constexpr size_t clump_faces = 32;
  constexpr int32_t waiting = -1;
  for (int32_t& n : node) n = n < MinimumCut::first_node ? n : waiting;
  int count = 0;
  std::vector<int32_t> faces;
  for (int seed = 0; seed < s.face_count(); ++seed) {
    if (node[seed] != waiting) continue;
    const int number = MinimumCut::first_node + count++;
    node[seed] = number;
    faces.assign(1, seed);
    for (size_t at = 0; at < faces.size(); ++at) {
      for (const int h : s.opposite[faces[at]]) {
        if (h < 0 || node[h / 3] != waiting || faces.size() == clump_faces) continue;
        node[h / 3] = number;
        faces.push_back(h / 3);
      }
    }
  }
  return count;
}

/// Find the cheapest cut through clumps of faces; what lies far from it joins the terminal of its
/// side. Returns how many faces are left as nodes.
int narrow_to_cut(const Surface& s, std::vector<int32_t>& node, const Context& context) {
  constexpr int rings = 6;  // of clumps on either side of the cut that stay
  std::vector<int32_t> clumped = node;
  const int clumps = clump(s, clumped);
  const std::vector<char> side = cheapest_cut(s, clumped, clumps, context);
  std::vector<char> near(MinimumCut::first_node + clumps, 0);
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<char> inner = near;
    for (int f = 0; f < s.face_count(); ++f) {
      for (const int h : s.opposite[f]) {
        near[clumped[f]] |= h >= 0 && (side[h / 3] != side[f] || inner[clumped[h / 3]]);
      }
    }
  }
  int nodes = 0;
  for (int f = 0; f < s.face_count(); ++f) {
    if (node[f] < MinimumCut::first_node) continue;
    const int32_t own_terminal = side[f] ? MinimumCut::source : MinimumCut::sink;
    node[f] = near[clumped[f]] ? MinimumCut::first_node + nodes++ : own_terminal;
  }
  return nodes;
}

/// Faces on the source's side of the cheapest cut between two patches; nearly the cheapest where
/// the surface is large.
std::vector<char> source_side(const Surface& s, const std::vector<int32_t>& patch, int source,
                              int sink, const Context& context) {
  constexpr int large = 50'000;
  std::vector<int32_t> node(s.faces.size());
  for (int f = 0; f < s.face_count(); ++f) {
    node[f] = patch[f] == source ? MinimumCut::source
              : patch[f] == sink ? MinimumCut::sink
                                 : MinimumCut::first_node + f;
  }
  const int nodes = s.face_count() > large ? narrow_to_cut(s, node, context) : s.face_count();
  std::vector<char> side = cheapest_cut(s, node, nodes, context);
  if (context.cancelled()) return {};
  return side;
}

}  // namespace

std::vector<char> separate_overlap(const Flattening& flattening, const Context& context) {
  const Surface& s = flattening.piece.surface;
  const auto pairs = overlapping_faces(s, flattening.uv);
  std::vector<char> marked(s.faces.size(), 0);
  for (const auto& [f, g] : pairs) marked[f] = marked[g] = 1;
  const std::vector<int32_t> patch = patches(s, marked);
  for (const auto& [f, g] : pairs) {
    if (patch[f] != patch[g]) return source_side(s, patch, patch[f], patch[g], context);
  }
  return {};
}

Flattened cut_apart(Flattening flattening, const FlattenOptions& options, const Context& context) {
  const size_t size = flattening.piece.source_face.size();
  const size_t small = size / 20;  // a part this small is better laid anew
  Flattened result;
  std::vector<Flattening> open;
  open.push_back(std::move(flattening));
  while (!open.empty() && !context.cancelled()) {
    Flattening flat = std::move(open.back());
    open.pop_back();
    if (flat.within) {
      result.parts.push_back(std::move(flat));
      continue;
    }
    const std::vector<char> side =
        flat.valid ? std::vector<char>{} : separate_overlap(flat, context);
    if (side.empty()) {
      if (flat.piece.source_face.size() == size) return {};
      result.left_over.push_back(std::move(flat.piece.source_face));
      continue;
    }
    std::vector<int32_t> halves[2];
    for (size_t f = 0; f < side.size(); ++f) halves[side[f] != 0].push_back(f);
    for (const auto& half : halves) {
      for (auto& part : connected_parts(flat.piece.surface, half)) {
        if (part.size() > small) {
          open.push_back(restricted(flat, part, options));
          continue;
        }
        for (int32_t& f : part) f = flat.piece.source_face[f];
        result.left_over.push_back(std::move(part));
      }
    }
  }
  for (auto& part : result.left_over) std::sort(part.begin(), part.end());
  return result;
}

}  // namespace partuv
