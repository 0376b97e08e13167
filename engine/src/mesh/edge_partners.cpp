#include "mesh/edge_partners.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace partuv::detail {
namespace {

/// Sides that alone have the same numbers at both ends; they leave `sides`.
Pairs same_numbers(std::vector<EdgeSide>& sides, std::span<const Triangle> numbers) {
  std::map<std::pair<int32_t, int32_t>, std::vector<size_t>> alike;
  for (size_t i = 0; i < sides.size(); ++i) {
    const int h = sides[i].side;
    int32_t low = numbers[h / 3][h % 3], high = numbers[h / 3][(h % 3 + 1) % 3];
    if (!sides[i].upward) std::swap(low, high);
    alike[{low, high}].push_back(i);
  }
  Pairs pairs;
  std::vector<char> met(sides.size(), 0);
  for (const auto& [ends, at] : alike) {
    if (at.size() != 2) continue;
    const EdgeSide &one = sides[at[0]], &other = sides[at[1]];
    if (one.apex == other.apex || one.upward == other.upward) continue;
    pairs.emplace_back(one.side, other.side);
    met[at[0]] = met[at[1]] = 1;
  }
  std::vector<EdgeSide> others;
  for (size_t i = 0; i < sides.size(); ++i) {
    if (!met[i]) others.push_back(sides[i]);
  }
  sides = std::move(others);
  return pairs;
}

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

/// A face as the wall of a solid that lies behind it, seen along the edge.
struct Wall {
  double angle;  ///< around the edge; the solid lies before an upward wall, after a downward one
  bool upward;
  int32_t side;
};

/// The walls around an edge by angle; none if a face is too thin to have one. Of walls that lie on
/// each other the one that ends a solid comes first: two solids touch there.
std::vector<Wall> walls_around(std::span<const EdgeSide> sides, std::span<const Vec3> positions) {
  constexpr double same_angle = 1e-3;    // rounding to single precision turns small faces by less
  constexpr double least_height = 1e-9;  // of the length of the edge
  const Vec3& low = positions[sides[0].low];
  const Vec3 axis = positions[sides[0].high] - low, along = axis.normalized();
  const Vec3 left = along.cross(positions[sides[0].apex] - low).normalized();
  const Vec3 zero = left.cross(along);
  std::vector<Wall> walls;
  for (const EdgeSide& s : sides) {
    const Vec3 ahead = positions[s.apex] - low;
    if (!(along.cross(ahead).norm() > least_height * axis.norm())) return {};
    const double angle = std::atan2(ahead.dot(left), ahead.dot(zero));
    // What lies on the first wall comes first, not last.
    walls.push_back(
        {angle < -same_angle ? angle + 2.0 * std::numbers::pi : angle, s.upward, s.side});
  }
  std::sort(walls.begin(), walls.end(),
            [](const Wall& a, const Wall& b) { return a.angle < b.angle; });
  for (auto first = walls.begin(); first != walls.end();) {
    auto last = first + 1;
    while (last != walls.end() && last->angle - std::prev(last)->angle < same_angle) ++last;
    std::stable_partition(first, last, [](const Wall& w) { return w.upward; });
    first = last;
  }
  return walls;
}

/// The two walls of every wedge of solid, if walls that begin and that end one alternate.
Pairs wedges(const std::vector<Wall>& walls) {
  Pairs pairs;
  for (size_t i = 0; i < walls.size(); ++i) {
    const Wall& next = walls[(i + 1) % walls.size()];
    if (walls[i].upward == next.upward) return {};
    if (next.upward) pairs.emplace_back(walls[i].side, next.side);
  }
  return pairs;
}

/// How far the surface bends between two walls: 0 if it goes on straight, pi if they cannot meet.
double bend(const Wall& a, const Wall& b) {
  if (a.upward == b.upward) return std::numbers::pi;
  return std::abs(std::abs(a.angle - b.angle) - std::numbers::pi);
}

/// Walls across which the surface goes on straighter than from either of them to any other.
Pairs straight_on(const std::vector<Wall>& walls) {
  constexpr double most_bend = 1.75;  // 100 degrees: no sharper than the corner of a box
  constexpr double clearly = 0.1;
  Pairs pairs;
  for (const Wall& wall : walls) {
    if (!wall.upward) continue;
    for (const Wall& other : walls) {
      const double own = bend(wall, other);
      const bool best = std::none_of(walls.begin(), walls.end(), [&](const Wall& third) {
        const bool rival = third.side != wall.side && third.side != other.side;
        return rival && std::min(bend(wall, third), bend(third, other)) < own + clearly;
      });
      if (best && own < most_bend) pairs.emplace_back(wall.side, other.side);
    }
  }
  return pairs;
}

}  // namespace

Pairs edge_partners(std::vector<EdgeSide> sides, std::span<const Vec3> positions,
                    std::span<const Triangle> numbers) {
  constexpr size_t most_faces = 8;  // copies not counted; more have a choice anyway
  Pairs met;
  if (!numbers.empty()) met = same_numbers(sides, numbers);
  std::vector<Copies> faces;
  for (size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].apex != sides[i - 1].apex) faces.emplace_back();
    if (faces.size() > most_faces) return met;
    faces.back().sides(sides[i].upward).push_back(sides[i].side);
  }
  if (faces.size() < 2) return met;
  Pairs pairs = only_pairing(faces, sides.size());
  if (pairs.empty()) {
    const std::vector<Wall> walls = walls_around(sides, positions);
    pairs = wedges(walls);
    if (pairs.empty()) pairs = only_neighbours(std::move(faces));
    if (pairs.empty()) pairs = straight_on(walls);
  }
  met.insert(met.end(), pairs.begin(), pairs.end());
  return met;
}

}  // namespace partuv::detail
