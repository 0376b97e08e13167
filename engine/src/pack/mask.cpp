#include "pack/mask.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pack/capsule.hpp"

namespace partuv::packing {

namespace {

/// Rows of a mask before their runs are merged.
class Rows {
 public:
  Rows(int width, int height) : width_(width), runs_(height) {}
  void add(int row, int begin, int end) {
    begin = std::max(begin, 0);
    end = std::min(end, width_);
    if (begin < end) runs_[row].push_back({begin, end});
  }
  int height() const { return static_cast<int>(runs_.size()); }
  /// Sort and join the runs of a row.
  const std::vector<Run>& joined(int row) {
    std::vector<Run>& runs = runs_[row];
    std::sort(runs.begin(), runs.end(), [](const Run& one, const Run& two) {
      return std::pair(one.begin, one.end) < std::pair(two.begin, two.end);
    });
    size_t size = 0;
    for (const Run& run : runs) {
      if (size && run.begin <= runs[size - 1].end) {
        runs[size - 1].end = std::max(runs[size - 1].end, run.end);
      } else {
        runs[size++] = run;
      }
    }
    runs.resize(size);
    return runs;
  }

 private:
  int width_;
  std::vector<std::vector<Run>> runs_;
};

/// Cells whose centre line lies inside, by winding number: the boundary keeps the inside left.
void fill_inside(const std::vector<Segment>& segments, Rows& rows) {
  struct Crossing {
    double x;
    int winding;
  };
  std::vector<std::vector<Crossing>> crossings(rows.height());
  for (const auto& [a, b] : segments) {
    const int winding = a.y() < b.y() ? -1 : 1;
    const auto& [low, high] = a.y() < b.y() ? std::pair(a, b) : std::pair(b, a);
    const int first = std::max(0, static_cast<int>(std::ceil(low.y() - 0.5)));
    const int last = std::min(rows.height(), static_cast<int>(std::ceil(high.y() - 0.5)));
    for (int row = first; row < last; ++row) {
      const double share = (row + 0.5 - low.y()) / (high.y() - low.y());
      crossings[row].push_back({low.x() + (high.x() - low.x()) * share, winding});
    }
  }
  for (int row = 0; row < rows.height(); ++row) {
    std::vector<Crossing>& line = crossings[row];
    std::sort(line.begin(), line.end(), [](const Crossing& one, const Crossing& two) {
      return std::pair(one.x, one.winding) < std::pair(two.x, two.winding);
    });
    int winding = 0;
    double start = 0.0;
    for (const Crossing& crossing : line) {
      if (winding == 0) start = crossing.x;
      winding += crossing.winding;
      if (winding == 0) {
        rows.add(row, static_cast<int>(std::floor(start)),
                 static_cast<int>(std::floor(crossing.x)) + 1);
      }
    }
  }
}

/// Rows spread over the whole height first: neighbours collide with the same things.
std::vector<int32_t> spread_order(int height) {
  std::vector<int32_t> order;
  order.reserve(height);
  int stride = 1;
  while (stride * 2 < height) stride *= 2;
  order.push_back(0);
  for (; stride > 0; stride /= 2) {
    for (int row = stride; row < height; row += 2 * stride) order.push_back(row);
  }
  return order;
}

}  // namespace

Mask make_mask(const Outline& outline, double rotation_rad, double scale, double growth) {
  Mask mask;
  mask.rotation_rad = rotation_rad;
  const Turn turn(rotation_rad, scale);
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  std::vector<Segment> segments;
  segments.reserve(outline.segments.size());
  for (const Segment& segment : outline.segments) {
    segments.push_back({turn(segment.a), turn(segment.b)});
    low = low.cwiseMin(segments.back().a);
    high = high.cwiseMax(segments.back().a);
    low = low.cwiseMin(segments.back().b);
    high = high.cwiseMax(segments.back().b);
  }
  if (segments.empty()) {
    segments.push_back({Vec2::Zero(), Vec2::Zero()});
    low = high = Vec2::Zero();
  }
  const Vec2 corner = low.array() - growth;
  mask.centre = -corner;
  const Vec2 size = (high - low).array() + 2.0 * growth;
  // The last row and column may be touched by rounding alone.
  constexpr double rounding = 1e-9;
  mask.width = std::max(1, static_cast<int>(std::ceil(size.x() - rounding)));
  mask.height = std::max(1, static_cast<int>(std::ceil(size.y() - rounding)));
  Rows rows(mask.width, mask.height);
  for (Segment& segment : segments) {
    segment.a -= corner;
    segment.b -= corner;
    const Capsule capsule(segment.a, segment.b, growth);
    const double bottom = std::min(segment.a.y(), segment.b.y()) - growth;
    const double top = std::max(segment.a.y(), segment.b.y()) + growth;
    const int first = std::max(0, static_cast<int>(std::floor(bottom)));
    const int last = std::min(mask.height - 1, static_cast<int>(std::floor(top)));
    for (int row = first; row <= last; ++row) {
      double left = INFINITY;
      double right = -INFINITY;
      capsule.reach(row, left, right);
      if (left > right) continue;
      rows.add(row, static_cast<int>(std::floor(left)), static_cast<int>(std::floor(right)) + 1);
    }
  }
  fill_inside(segments, rows);
  mask.row_start.reserve(mask.height + 1);
  mask.row_start.push_back(0);
  for (int row = 0; row < mask.height; ++row) {
    for (const Run& run : rows.joined(row)) {
      mask.runs.push_back(run);
      mask.filled += run.end - run.begin;
    }
    mask.row_start.push_back(static_cast<int32_t>(mask.runs.size()));
  }
  mask.test_order = spread_order(mask.height);
  return mask;
}

}  // namespace partuv::packing
