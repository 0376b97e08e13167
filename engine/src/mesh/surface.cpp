#include "partuv/surface.hpp"

#include <algorithm>
#include <span>
#include <tuple>

#include "buckets.hpp"
#include "mesh/edge_partners.hpp"

namespace partuv {

namespace {

using detail::EdgeSide;

/// The sides without an opposite one, by their lower vertex.
Buckets<EdgeSide> open_sides(const Surface& surface) {
  int vertices = 0;
  for (const Triangle& t : surface.faces)
    vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  return grouped<EdgeSide>(vertices, [&](auto&& visit) {
    for (int h = 0; h < 3 * surface.face_count(); ++h) {
      if (surface.opposite[h / 3][h % 3] >= 0) continue;
      const Triangle& t = surface.faces[h / 3];
      const auto [low, high] = std::minmax(t[h % 3], t[(h % 3 + 1) % 3]);
      visit(low, EdgeSide{low, high, t[(h % 3 + 2) % 3], h, low == t[h % 3]});
    }
  });
}

}  // namespace

void link_opposites(Surface& surface, std::span<const Triangle> numbers) {
  surface.opposite.resize(surface.faces.size(), Triangle{-1, -1, -1});
  const auto link = [&](int a, int b) {
    surface.opposite[a / 3][a % 3] = b;
    surface.opposite[b / 3][b % 3] = a;
  };
  Buckets<EdgeSide> open = open_sides(surface);
  for (int v = 0; v < open.count(); ++v) {
    const auto begin = open.items.begin() + open.start[v];
    const auto end = open.items.begin() + open.start[v + 1];
    std::sort(begin, end, [](const EdgeSide& a, const EdgeSide& b) {
      return std::tie(a.high, a.apex, a.side) < std::tie(b.high, b.apex, b.side);
    });
    for (auto first = begin; first != end;) {
      const auto last = std::find_if(first, end, [&](auto& s) { return s.high != first->high; });
      if (last - first == 2) {  // nearly all, so without the ado of the others
        const EdgeSide &one = first[0], &other = first[1];
        if (one.apex != other.apex && one.upward != other.upward) link(one.side, other.side);
      } else {
        for (const auto& [a, b] :
             detail::edge_partners({first, last}, surface.positions, numbers)) {
          link(a, b);
        }
      }
      first = last;
    }
  }
}

int label_components(const Surface& surface, std::vector<int32_t>& component) {
  component.assign(surface.face_count(), -1);
  int count = 0;
  std::vector<int32_t> stack;
  for (int seed = 0; seed < surface.face_count(); ++seed) {
    if (component[seed] >= 0) continue;
    component[seed] = count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h : surface.opposite[f]) {
        if (h >= 0 && component[h / 3] < 0) {
          component[h / 3] = count;
          stack.push_back(h / 3);
        }
      }
    }
    ++count;
  }
  return count;
}

}  // namespace partuv
