#include "partuv/surface.hpp"

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

#include "buckets.hpp"

namespace partuv {

namespace {

/// A side of a face at an edge.
struct EdgeSide {
  int32_t low, high;  ///< vertices of the edge
  int32_t apex;       ///< the face's third vertex
  int32_t side;       ///< half-edge
  bool upward;        ///< runs from low to high
};

/// The sides of copies of one face (equal apex) that have no partner yet, by direction.
struct Copies {
  std::vector<int32_t> upward, downward;

  std::vector<int32_t>& sides(bool up) { return up ? upward : downward; }
};

/// The only other face that has sides in the given direction, null if there are none or several.
Copies* only_other(std::vector<Copies>& faces, const Copies& own, bool up) {
  Copies* found = nullptr;
  for (Copies& other : faces) {
    if (&other == &own || other.sides(up).empty()) continue;
    if (found) return nullptr;
    found = &other;
  }
  return found;
}

using Pairs = std::vector<std::pair<int32_t, int32_t>>;

/// All sides in pairs, if there is one way only to do that; of copies wound alike the first meets
/// the first.
Pairs only_pairing(std::vector<Copies> faces, size_t sides) {
  Pairs pairs;
  for (bool moved = true; moved && 2 * pairs.size() < sides;) {
    moved = false;
    for (Copies& own : faces) {
      for (const bool up : {true, false}) {
        std::vector<int32_t>& mine = own.sides(up);
        Copies* other = mine.empty() ? nullptr : only_other(faces, own, !up);
        if (!other) continue;
        std::vector<int32_t>& theirs = other->sides(!up);
        if (theirs.size() < mine.size()) return {};
        for (size_t i = 0; i < mine.size(); ++i) pairs.emplace_back(mine[i], theirs[i]);
        theirs.erase(theirs.begin(), theirs.begin() + static_cast<std::ptrdiff_t>(mine.size()));
        mine.clear();
        moved = true;
      }
    }
  }
  if (2 * pairs.size() < sides) return {};
  return pairs;
}

/// Sides of faces that could meet no other but each other; copies too many are left alone.
Pairs only_neighbours(std::vector<Copies> faces) {
  Pairs pairs;
  for (Copies& own : faces) {
    Copies* other = own.upward.empty() ? nullptr : only_other(faces, own, false);
    if (!other || only_other(faces, *other, true) != &own) continue;
    const size_t count = std::min(own.upward.size(), other->downward.size());
    for (size_t i = 0; i < count; ++i) pairs.emplace_back(own.upward[i], other->downward[i]);
  }
  return pairs;
}

/// Who meets whom at one edge.
Pairs partners(std::span<const EdgeSide> sides) {
  constexpr size_t most_faces = 8;  // copies not counted; more have a choice anyway
  std::vector<Copies> faces;
  for (size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].apex != sides[i - 1].apex) faces.emplace_back();
    if (faces.size() > most_faces) return {};
    faces.back().sides(sides[i].upward).push_back(sides[i].side);
  }
  Pairs pairs = only_pairing(faces, sides.size());
  return pairs.empty() ? only_neighbours(std::move(faces)) : pairs;
}

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

void link_opposites(Surface& surface) {
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
        for (const auto& [a, b] : partners({first, last})) link(a, b);
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
