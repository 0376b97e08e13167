#include "segment/cut_across.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "pack/orient.hpp"
#include "pack/outline.hpp"
#include "planar.hpp"

namespace partuv {
namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();

/// Where along a map its points lie, from 0 at one end to 1 at the other.
struct Course {
  std::vector<double> at;  ///< per vertex
  double length = 0.0;     ///< from end to end
};

/// A line across a course.
struct Line {
  const Course* course;
  double at;
  double estimate;  ///< side of the larger square if the map could be cut right there
};

/// A map as a graph of its sides.
class Sheet {
 public:
  explicit Sheet(const Flattening& flattening)
      : surface_(flattening.piece.surface), uv_(flattening.uv) {
    const size_t vertices = surface_.positions.size();
    start_.assign(vertices + 1, 0);
    for_each_edge([&](int a, int b, int) { ++start_[a + 1], ++start_[b + 1]; });
    for (size_t v = 0; v < vertices; ++v) start_[v + 1] += start_[v];
    ends_.resize(start_.back());
    std::vector<int32_t> next(start_.begin(), start_.end() - 1);
    for_each_edge([&](int a, int b, int h) {
      ends_[next[a]++] = {b, h};
      ends_[next[b]++] = {a, h};
    });
    double most = 0.0;
    for (const auto& loop : flattening.piece.loops) {
      std::vector<int32_t> around;
      double area = 0.0;
      for (const int h : loop) {
        const int from = surface_.faces[h / 3][h % 3];
        const Vec2 &a = uv_[from], &b = uv_[surface_.faces[h / 3][(h % 3 + 1) % 3]];
        around.push_back(from);
        area += 0.5 * turn(Vec2::Zero(), a, b);
      }
      area_ += area;
      if (area <= most) continue;
      most = area;
      outline_ = std::move(around);
    }
    on_outline_.assign(vertices, 0);
    for (const int v : outline_) on_outline_[v] = 1;
  }

  const std::vector<int32_t>& outline() const { return outline_; }

  /// Along a direction.
  Course straight(double angle_rad) const {
    const Vec2 along(std::cos(angle_rad), std::sin(angle_rad));
    Course course;
    for (const Vec2& p : uv_) course.at.push_back(p.dot(along));
    const auto [low, high] = std::minmax_element(course.at.begin(), course.at.end());
    const double least = *low;
    course.length = *high - least;
    for (double& at : course.at) at = (at - least) / course.length;
    return course;
  }

  /// Between the two points of the outline that are furthest apart within the map, as far as two
  /// sweeps tell.
  Course winding() const {
    const int from = furthest(distances(outline_.front()));
    const std::vector<double> near = distances(from);
    const int to = furthest(near);
    const std::vector<double> far = distances(to);
    Course course;
    course.length = near[to];
    for (size_t v = 0; v < near.size(); ++v) {
      course.at.push_back(0.5 + 0.5 * (near[v] - far[v]) / course.length);
    }
    return course;
  }

  /// Sides of the faces (by half-edge) along the cheapest path across a course near a line of it,
  /// between the two stretches of the outline that join the ends. Empty if there is none.
  std::vector<int32_t> path(const Line& line) const {
    constexpr double stray = 8.0;     // dearness of straying from the line
    constexpr double in_hole = 1e-3;  // holes are crossed along their rim, where nothing is cut
    const std::vector<double>& at = line.course->at;
    const double width = area_ / line.course->length;
    const auto dearness = [&](double where) {
      const double off = stray * (where - line.at);
      return off * off;
    };
    const auto by_place = [&](int a, int b) { return at[a] < at[b]; };
    const auto [low, high] = std::minmax_element(outline_.begin(), outline_.end(), by_place);
    std::vector<char> bank(at.size(), 0);
    const size_t count = outline_.size();
    const auto mark = [&](size_t from, size_t to, char side) {
      for (size_t i = (from + 1) % count; i != to; i = (i + 1) % count) bank[outline_[i]] = side;
    };
    mark(low - outline_.begin(), high - outline_.begin(), 1);
    mark(high - outline_.begin(), low - outline_.begin(), 2);
    std::vector<double> cost(at.size(), unreached);
    std::vector<std::pair<int32_t, int32_t>> by(at.size(), {-1, -1});  // vertex, half-edge
    Queue queue;
    for (const int v : outline_) {
      if (bank[v] != 1) continue;
      cost[v] = width * dearness(at[v]);
      queue.emplace(cost[v], v);
    }
    int end = -1;
    double least = unreached;
    while (!queue.empty()) {
      const auto [spent, v] = queue.top();
      queue.pop();
      if (spent >= least) break;
      if (spent > cost[v]) continue;
      for (int32_t i = start_[v]; i < start_[v + 1]; ++i) {
        const auto [next, h] = ends_[i];
        if (on_outline_[next] && bank[next] != 2) continue;
        const bool rim = surface_.opposite[h / 3][h % 3] < 0;
        if (rim && (on_outline_[v] || on_outline_[next])) continue;
        const double length = (uv_[next] - uv_[v]).norm();
        const double step = length * (rim ? in_hole : 1.0 + dearness(0.5 * (at[v] + at[next])));
        if (spent + step >= cost[next]) continue;
        cost[next] = spent + step;
        by[next] = {v, h};
        if (bank[next] != 2) {
          queue.emplace(cost[next], next);
        } else if (cost[next] + width * dearness(at[next]) < least) {
          least = cost[next] + width * dearness(at[next]);
          end = next;
        }
      }
    }
    std::vector<int32_t> sides;
    for (int v = end; v >= 0 && by[v].first >= 0; v = by[v].first) sides.push_back(by[v].second);
    return sides;
  }

  /// Faces on the two sides of a path; empty if there are not just two.
  std::array<std::vector<int32_t>, 2> halves(const std::vector<int32_t>& path) const {
    Surface apart = surface_;
    for (const int h : path) {
      int32_t& across = apart.opposite[h / 3][h % 3];
      if (across < 0) continue;
      apart.opposite[across / 3][across % 3] = -1;
      across = -1;
    }
    std::array<std::vector<int32_t>, 2> found;
    std::vector<int32_t> half;
    if (label_components(apart, half) != 2) return {};
    for (size_t f = 0; f < half.size(); ++f) found[half[f]].push_back(static_cast<int32_t>(f));
    return found;
  }

  double seam_length(const std::vector<int32_t>& path) const {
    double length = 0.0;
    for (const int h : path) {
      if (surface_.opposite[h / 3][h % 3] < 0) continue;  // along a hole
      const Triangle& t = surface_.faces[h / 3];
      length += (uv_[t[(h % 3 + 1) % 3]] - uv_[t[h % 3]]).norm();
    }
    return length;
  }

  double side_of(const std::vector<int32_t>& faces) const {
    std::vector<Vec2> points;
    for (const int f : faces) {
      for (const int v : surface_.faces[f]) points.push_back(uv_[v]);
    }
    return least_square_side(points);
  }

 private:
  using Queue = std::priority_queue<std::pair<double, int32_t>,
                                    std::vector<std::pair<double, int32_t>>, std::greater<>>;

  const Surface& surface_;
  const std::vector<Vec2>& uv_;
  std::vector<int32_t> start_;                     // per vertex, into `ends_`
  std::vector<std::pair<int32_t, int32_t>> ends_;  // other vertex, half-edge
  std::vector<int32_t> outline_;                   // vertices in order
  std::vector<char> on_outline_;
  double area_ = 0.0;

  template <typename Body>
  void for_each_edge(const Body& body) const {
    for (int h = 0; h < 3 * surface_.face_count(); ++h) {
      if (surface_.opposite[h / 3][h % 3] > h) continue;
      body(surface_.faces[h / 3][h % 3], surface_.faces[h / 3][(h % 3 + 1) % 3], h);
    }
  }

  std::vector<double> distances(int from) const {
    std::vector<double> distance(uv_.size(), unreached);
    Queue queue;
    distance[from] = 0.0;
    queue.emplace(0.0, from);
    while (!queue.empty()) {
      const auto [gone, v] = queue.top();
      queue.pop();
      if (gone > distance[v]) continue;
      for (int32_t i = start_[v]; i < start_[v + 1]; ++i) {
        const int next = ends_[i].first;
        const double reached = gone + (uv_[next] - uv_[v]).norm();
        if (reached >= distance[next]) continue;
        distance[next] = reached;
        queue.emplace(reached, next);
      }
    }
    return distance;
  }

  int furthest(const std::vector<double>& distance) const {
    return *std::max_element(outline_.begin(), outline_.end(),
                             [&](int a, int b) { return distance[a] < distance[b]; });
  }
};

/// The lines that promise the smallest squares, best first.
std::vector<Line> promising(const Sheet& sheet, const std::vector<Vec2>& uv,
                            const std::vector<Course>& courses) {
  constexpr size_t most = 8;
  std::vector<Line> lines;
  for (const Course& course : courses) {
    for (const double at : {0.5, 0.45, 0.55, 0.4, 0.6, 0.33, 0.67}) {
      std::array<std::vector<Vec2>, 2> points;
      for (const int v : sheet.outline()) points[course.at[v] > at].push_back(uv[v]);
      if (points[0].empty() || points[1].empty()) continue;
      lines.push_back(
          {&course, at, std::max(least_square_side(points[0]), least_square_side(points[1]))});
    }
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Line& a, const Line& b) { return a.estimate < b.estimate; });
  if (lines.size() > most) lines.resize(most);
  return lines;
}

}  // namespace

double least_square_side(const std::vector<Vec2>& uv) {
  return packing::least_square(packing::convex_hull(uv)).size.maxCoeff();
}

std::optional<std::array<Flattening, 2>> cut_across(const Flattening& flattening,
                                                    const FlattenOptions& options) {
  constexpr double seam_cost = 0.1;  // a little longer a side for a shorter seam
  const Sheet sheet(flattening);
  if (sheet.outline().size() < 4) return std::nullopt;
  const double axis = -packing::least_rectangle(packing::convex_hull(flattening.uv)).rotation_rad;
  std::vector<Course> courses{sheet.winding()};
  for (int eighth = 0; eighth < 4; ++eighth) {
    courses.push_back(sheet.straight(axis + 0.25 * eighth * std::numbers::pi));
  }
  struct Candidate {
    double side;
    double badness;
    std::array<std::vector<int32_t>, 2> halves;
  };
  std::vector<Candidate> candidates;
  for (const Line& line : promising(sheet, flattening.uv, courses)) {
    Candidate candidate;
    const std::vector<int32_t> path = sheet.path(line);
    candidate.halves = sheet.halves(path);
    if (candidate.halves[0].empty()) continue;
    candidate.side =
        std::max(sheet.side_of(candidate.halves[0]), sheet.side_of(candidate.halves[1]));
    candidate.badness = candidate.side + seam_cost * sheet.seam_length(path);
    candidates.push_back(std::move(candidate));
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.badness < b.badness; });
  const double whole = least_square_side(flattening.uv);
  for (const Candidate& candidate : candidates) {
    if (!(candidate.side < whole)) continue;
    std::array<Flattening, 2> sides{restricted(flattening, candidate.halves[0], options),
                                    restricted(flattening, candidate.halves[1], options)};
    if (sides[0].within && sides[1].within) return sides;
  }
  return std::nullopt;
}

}  // namespace partuv
