// Takes a map that lies on itself apart without cutting it.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <queue>

#include "buckets.hpp"
#include "flatten/newton.hpp"
#include "planar.hpp"

namespace partuv {
namespace {

/// The point of the segment from a to b that is nearest to p.
Vec2 nearest_point(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 d = b - a;
  const double square = d.squaredNorm();
  return square > 0.0 ? Vec2(a + std::clamp((p - a).dot(d) / square, 0.0, 1.0) * d) : a;
}

/// Finds the boundary vertices of a map that lie on some other part of it, and the way out.
class Trespassers {
 public:
  Trespassers(const Piece& piece, const std::vector<Vec2>& uv)
      : piece_(piece),
        surface_(piece.surface),
        uv_(uv),
        seen_by_(surface_.faces.size(), -1),
        inward_(uv.size(), Vec2::Zero()) {
    low_ = high_ = uv.front();
    for (const Vec2& p : uv) {
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
    const double area = signed_area(surface_.faces, uv);
    side_ = std::sqrt(2.0 * std::abs(area) / static_cast<double>(surface_.faces.size()));
    touch_ = touching_share * (high_ - low_).maxCoeff();
    // Of a size and a place such that the points of a regular map do not lie on borders of cells.
    const double cell = 1.07 * std::max(side_, (high_ - low_).maxCoeff() / 1000.0);
    low_ -= Vec2::Constant(0.37 * cell);
    cells_per_unit_ = 1.0 / cell;
    const Cell last = cell_at(high_);
    columns_ = last.column + 1;
    std::vector<char> wanted(static_cast<size_t>(columns_) * (last.row + 1), 0);
    for (const auto& loop : piece.loops) {
      for (const int h : loop) {
        const int from = surface_.faces[h / 3][h % 3], to = surface_.faces[h / 3][(h % 3 + 1) % 3];
        const Vec2 side = uv[to] - uv[from];
        for (const int v : {from, to}) inward_[v] += Vec2(-side.y(), side.x());
        boundary_.push_back(from);
        wanted[cell_of(uv[boundary_.back()])] = 1;
      }
    }
    faces_in_cell_ = grouped<int32_t>(static_cast<int>(wanted.size()), [&](auto&& visit) {
      for (int f = 0; f < surface_.face_count(); ++f) {
        const Triangle& t = surface_.faces[f];
        const Cell first = cell_at(uv[t[0]].cwiseMin(uv[t[1]]).cwiseMin(uv[t[2]]));
        const Cell last = cell_at(uv[t[0]].cwiseMax(uv[t[1]]).cwiseMax(uv[t[2]]));
        for (int row = first.row; row <= last.row; ++row) {
          for (int column = first.column; column <= last.column; ++column) {
            const int c = row * columns_ + column;
            if (wanted[c]) visit(c, f);
          }
        }
      }
    });
  }

  /// The boundary vertices that lie on some other part, with the face under each.
  std::vector<std::pair<int32_t, int32_t>> find() const {
    std::vector<std::pair<int32_t, int32_t>> found;
    for (const int v : boundary_) {
      const int f = face_under(v);
      if (f >= 0) found.emplace_back(v, f);
    }
    return found;
  }

  /// True if the sheet around the face f goes on for `most_sides` mean sides on all sides of a
  /// vertex that lies on f.
  bool lies_deep(int v, int f, double most_sides) {
    const Vec2& p = uv_[v];
    const double reach = most_sides * side_;
    std::vector<int> open{f};
    seen_by_[f] = v;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        const Vec2 &a = uv_[surface_.faces[at][k]], &b = uv_[surface_.faces[at][(k + 1) % 3]];
        if ((nearest_point(a, b, p) - p).norm() > reach) continue;
        const int across = surface_.opposite[at][k];
        if (across < 0) return false;
        if (seen_by_[across / 3] == v) continue;
        seen_by_[across / 3] = v;
        open.push_back(across / 3);
      }
    }
    return true;
  }

  /// A spring for each, to a point a little outside of what it lies on; those that have been
  /// trespassing before, marked in `held`, are held where they are. Returns how many trespass; more
  /// than `most` get no springs.
  size_t pull(size_t most, std::vector<char>& held, Springs& springs) {
    const std::vector<std::pair<int32_t, int32_t>> found = find();
    if (found.size() > most) return found.size();
    std::vector<std::pair<int32_t, Vec2>> moves;
    for (const auto& [v, f] : found) moves.emplace_back(v, way_out(v, f));
    if (moves.empty()) moves = uncrossing_moves(most);
    for (const auto& [v, target] : moves) held[v] = 1;
    std::map<int32_t, Vec2> target_of(moves.begin(), moves.end());
    for (size_t v = 0; v < held.size(); ++v) {
      if (!held[v]) continue;
      const auto it = target_of.find(static_cast<int32_t>(v));
      springs.vertex.push_back(static_cast<int32_t>(v));
      springs.target.push_back(it == target_of.end() ? uv_[v] : within_reach(uv_[v], it->second));
    }
    return target_of.size();
  }

 private:
  struct Cell {
    int column, row;
  };

  Cell cell_at(const Vec2& p) const {
    return {static_cast<int>((p.x() - low_.x()) * cells_per_unit_),
            static_cast<int>((p.y() - low_.y()) * cells_per_unit_)};
  }

  int cell_of(const Vec2& p) const {
    const Cell at = cell_at(p);
    return at.row * columns_ + at.column;
  }

  /// A face on which the vertex lies, none of its own; -1 if there is none.
  int face_under(int v) const {
    const Vec2& p = uv_[v];
    const int cell = cell_of(p);
    for (int i = faces_in_cell_.start[cell]; i < faces_in_cell_.start[cell + 1]; ++i) {
      const Triangle& t = surface_.faces[faces_in_cell_.items[i]];
      if (t[0] == v || t[1] == v || t[2] == v) continue;
      const Vec2 &a = uv_[t[0]], &b = uv_[t[1]], &c = uv_[t[2]];
      const auto inside = [&](const Vec2& from, const Vec2& to) {
        return turn(from, to, p) >= -touch_ * (to - from).norm();
      };
      if (inside(a, b) && inside(b, c) && inside(c, a)) return faces_in_cell_.items[i];
    }
    return -1;
  }

  /// As far towards a target as a vertex may be pulled at a time: farther, and faces would flip.
  Vec2 within_reach(const Vec2& from, const Vec2& target) const {
    const double reach = 0.5 * side_, distance = (target - from).norm();
    return distance > reach ? Vec2(from + reach / distance * (target - from)) : target;
  }

  double margin() const { return 0.2 * side_; }

  /// Where corners poke through each other no vertex lies on a face. Of two segments that cross,
  /// the end that is nearest to the other segment goes to the side of that where its other end is.
  std::vector<std::pair<int32_t, Vec2>> uncrossing_moves(size_t most) const {
    std::vector<std::pair<int32_t, Vec2>> moves;
    for (const auto& [s, t] : boundary_meetings(piece_, uv_, most)) {
      double least = std::numeric_limits<double>::infinity();
      std::pair<int32_t, Vec2> move{-1, Vec2::Zero()};
      const auto offer = [&](int v, int other, const BoundarySegment& wall) {
        if (v == wall.from || v == wall.to) return;
        const Vec2 &a = uv_[wall.from], &b = uv_[wall.to];
        const Vec2 point = nearest_point(a, b, uv_[v]);
        const double distance = (point - uv_[v]).norm();
        if (distance >= least - touch_) return;
        least = distance;
        const Vec2 left = Vec2(a.y() - b.y(), b.x() - a.x()).normalized();
        const bool left_of = turn(a, b, uv_[other]) >= -touch_ * (b - a).norm();
        const double side = left_of ? margin() : -margin();
        move = {v, point + side * left};
      };
      offer(s.from, s.to, t);
      offer(s.to, s.from, t);
      offer(t.from, t.to, s);
      offer(t.to, t.from, s);
      if (move.first >= 0) moves.push_back(move);
    }
    return moves;
  }

  /// A little beyond the nearest point on the boundary of the sheet around f. Ways back, inward as
  /// seen from the vertex's own side, count as shorter than ways on: so neighbours retreat
  /// together.
  Vec2 way_out(int v, int f) {
    const Vec2& p = uv_[v];
    const Vec2 back = direction_of_sum(inward_[v], 1e-6 * side_);
    constexpr double detour = 12.0;
    Vec2 out = p;
    double least = std::numeric_limits<double>::infinity();
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
        open;
    open.emplace(0.0, f);
    seen_by_[f] = v;
    while (!open.empty() && open.top().first < least) {
      const int at = open.top().second;
      open.pop();
      for (int k = 0; k < 3; ++k) {
        const int from = surface_.faces[at][k], to = surface_.faces[at][(k + 1) % 3];
        const Vec2 point = nearest_point(uv_[from], uv_[to], p);
        const Vec2 way = point - p;
        const double distance = way.norm();
        const int across = surface_.opposite[at][k];
        if (across >= 0 && seen_by_[across / 3] != v) {
          seen_by_[across / 3] = v;
          open.emplace(std::round(distance / touch_) * touch_, across / 3);
        }
        const double cost = distance + detour * (distance - way.dot(back));
        if (across >= 0 || from == v || to == v || cost >= least - touch_) continue;
        least = cost;
        const Vec2 side = uv_[to] - uv_[from];
        out = point + margin() * Vec2(side.y(), -side.x()).normalized();
      }
    }
    return out;
  }

  const Piece& piece_;
  const Surface& surface_;
  const std::vector<Vec2>& uv_;
  std::vector<int32_t> seen_by_;  ///< per face: the vertex that last looked for a way out there
  Vec2 low_, high_;
  double side_ = 0.0, cells_per_unit_ = 0.0;
  double touch_ = 0.0;  ///< distance that is none but for rounding: what is as near, numbers decide
  int columns_ = 0;
  std::vector<int32_t> boundary_;
  std::vector<Vec2> inward_;        ///< per vertex; zero off the boundary
  Buckets<int32_t> faces_in_cell_;  ///< whose boxes touch the cell, ascending
};

/// The largest angle at a boundary vertex of a map, in full turns. Where it is more than one, the
/// faces around the vertex lie on each other.
double widest_corner(const Piece& piece, const std::vector<Vec2>& uv) {
  const std::vector<char> boundary = boundary_vertices(piece.surface);
  std::vector<double> angle(uv.size(), 0.0);
  for (const Triangle& t : piece.surface.faces) {
    for (int k = 0; k < 3; ++k) {
      if (!boundary[t[k]]) continue;
      const Vec2 &at = uv[t[k]], &one = uv[t[(k + 1) % 3]], &other = uv[t[(k + 2) % 3]];
      angle[t[k]] += std::atan2(turn(at, one, other), (one - at).dot(other - at));
    }
  }
  return *std::max_element(angle.begin(), angle.end()) / (2.0 * std::numbers::pi);
}

/// Sheets that cover each other more widely never part within any bound.
size_t most_trespassers(const Piece& piece) { return 5 + piece.source_face.size() / 20; }

/// True if trespassers that go on becoming fewer at the rate of the rounds so far will be left
/// after all of them.
bool falls_short(size_t first, size_t now, int rounds, int most_rounds) {
  constexpr int least_rounds = 3;
  constexpr double most_left = 4.0;
  if (rounds < least_rounds) return false;
  const double left = static_cast<double>(now), share = left / static_cast<double>(first);
  const double rate = std::pow(share, 1.0 / rounds);
  return left * std::pow(rate, most_rounds - rounds) > most_left;
}

}  // namespace

bool overlaps_widely(const Piece& piece, const std::vector<Vec2>& uv) {
  constexpr double most_sides = 3.0;
  // Measured in searches of twelve meshes: of 381 maps that turned that far, 9 would have become
  // charts, of 672 that were wide with that many trespassers 32. Both took a third of the time for
  // maps that fail.
  constexpr double hopeless_turns = 1.4, wide_turns = 1.1;
  constexpr size_t many = 16;
  // Flaps that touch along their sides are no overlap.
  const std::vector<Vec2> inset = inset_boundary(piece, uv);
  Trespassers trespassers(piece, inset);
  const std::vector<std::pair<int32_t, int32_t>> found = trespassers.find();
  if (found.empty()) return false;
  const double turns = widest_corner(piece, inset);
  if (turns > hopeless_turns || (turns > wide_turns && found.size() >= many)) return true;
  return found.size() > most_trespassers(piece) ||
         std::any_of(found.begin(), found.end(), [&](const auto& t) {
           return trespassers.lies_deep(t.first, t.second, most_sides);
         });
}

bool spread_apart(const Piece& piece, const std::vector<RestTriangle>& rest,
                  const PolishOptions& options, int most_rounds,
                  const std::function<bool()>& hopeless, const Context& context,
                  MeshSystem<2>& system, std::vector<Vec2>& uv) {
  constexpr int patience = 4;  // rounds without fewer trespassers than ever before
  const size_t most = most_trespassers(piece);
  Newton newton(piece, rest, options, context, system);
  std::vector<Vec2> step(uv.size());
  std::vector<char> held(uv.size(), 0);
  double stiffness = 0.0;
  size_t first = 0, fewest = uv.size() + 1;
  int waited = 0;
  for (int round = 0; round < most_rounds && !context.stopping(); ++round) {
    Springs springs;
    const size_t count = Trespassers(piece, uv).pull(most, held, springs);
    if (count == 0) break;
    if (count > most) return false;
    if (count < fewest) {
      fewest = count;
      waited = 0;
    } else {
      ++waited;
      stiffness *= 2.0;
    }
    if (round == 0) first = count;
    if (falls_short(first, count, round, most_rounds)) return false;
    if (waited > patience || hopeless()) return false;
    if (round == 0) {
      newton.direction(uv, 0.0, step);
      stiffness = 10.0 * system.mean_diagonal();
    }
    springs.stiffness = stiffness;
    newton.attach(std::move(springs));
    const double current = newton.energy(uv, 0.0);
    const double slope = newton.direction(uv, 0.0, step);
    if (!(slope < 0.0)) break;
    newton.descend(uv, step, newton.safe_length(uv, step), slope, 0.0, current);
  }
  return boundary_is_simple(piece, uv);
}

}  // namespace partuv
