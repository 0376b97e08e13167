#include "pack/mask.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pack/capsule.hpp"

namespace partuv::packing {

namespace {

struct RowRun {
  int32_t row;
  Run run;
};

struct Crossing {
  int32_t row;
  int32_t winding;
  double x;
};

/// Items in the order of their rows; `start` receives height + 1 offsets.
template <typename Item>
std::vector<Item> sort_by_row(const std::vector<Item>& items, int height,
                              std::vector<int32_t>& start) {
  start.assign(height + 1, 0);
  for (const Item& item : items) ++start[item.row + 1];
  for (int row = 0; row < height; ++row) start[row + 1] += start[row];
  std::vector<int32_t> next(start.begin(), start.end() - 1);
  std::vector<Item> sorted(items.size());
  for (const Item& item : items) sorted[next[item.row]++] = item;
  return sorted;
}

class Rasteriser {
 public:
  Rasteriser(int width, int height, size_t sides) : width_(width), height_(height) {
    runs_.reserve(3 * sides + 4 * size_t(height));
    crossings_.reserve(sides + 2 * size_t(height));
  }

  void add_grown(const Vec2& a, const Vec2& b, double growth, Cover cover) {
    const Capsule capsule(a, b, growth);
    const double bottom = std::min(a.y(), b.y()) - growth;
    const double top = std::max(a.y(), b.y()) + growth;
    const int first = std::max(0, static_cast<int>(std::floor(bottom)));
    const int last = std::min(height_ - 1, static_cast<int>(std::floor(top)));
    for (int row = first; row <= last; ++row) {
      double left = INFINITY;
      double right = -INFINITY;
      if (cover == Cover::touched) {
        capsule.reach(row, left, right);
        if (left <= right) add(row, int(std::floor(left)), int(std::floor(right)) + 1);
      } else {
        capsule.cut(row + 0.5, left, right);
        if (left <= right) add(row, int(std::ceil(left - 0.5)), int(std::floor(right + 0.5)));
      }
    }
  }

  /// Note where the side crosses the centre lines of rows.
  void add_crossings(const Vec2& a, const Vec2& b) {
    const int winding = a.y() < b.y() ? -1 : 1;
    const Vec2& low = a.y() < b.y() ? a : b;
    const Vec2& high = a.y() < b.y() ? b : a;
    const int first = std::max(0, static_cast<int>(std::ceil(low.y() - 0.5)));
    const int last = std::min(height_, static_cast<int>(std::ceil(high.y() - 0.5)));
    for (int row = first; row < last; ++row) {
      const double share = (row + 0.5 - low.y()) / (high.y() - low.y());
      crossings_.push_back({row, winding, low.x() + (high.x() - low.x()) * share});
    }
  }

  /// Add the cells between crossings where the winding number is not zero.
  void fill_inside(Cover cover) {
    std::vector<int32_t> start;
    std::vector<Crossing> lines = sort_by_row(crossings_, height_, start);
    for (int row = 0; row < height_; ++row) {
      std::sort(lines.begin() + start[row], lines.begin() + start[row + 1],
                [](const Crossing& one, const Crossing& two) {
                  return std::pair(one.x, one.winding) < std::pair(two.x, two.winding);
                });
      int winding = 0;
      double from = 0.0;
      for (int32_t i = start[row]; i < start[row + 1]; ++i) {
        if (winding == 0) from = lines[i].x;
        winding += lines[i].winding;
        if (winding != 0) continue;
        if (cover == Cover::touched) {
          add(row, int(std::floor(from)), int(std::floor(lines[i].x)) + 1);
        } else {
          add(row, int(std::ceil(from - 0.5)), int(std::floor(lines[i].x + 0.5)));
        }
      }
    }
  }

  /// Sort and join the runs of every row.
  void finish(Mask& mask) const {
    std::vector<int32_t> start;
    std::vector<RowRun> sorted = sort_by_row(runs_, height_, start);
    mask.row_start.reserve(height_ + 1);
    mask.runs.reserve(2 * size_t(height_));
    mask.row_start.push_back(0);
    for (int row = 0; row < height_; ++row) {
      std::sort(sorted.begin() + start[row], sorted.begin() + start[row + 1],
                [](const RowRun& one, const RowRun& two) {
                  return std::pair(one.run.begin, one.run.end) <
                         std::pair(two.run.begin, two.run.end);
                });
      const size_t first = mask.runs.size();
      for (int32_t i = start[row]; i < start[row + 1]; ++i) {
        const Run run = sorted[i].run;
        if (mask.runs.size() > first && run.begin <= mask.runs.back().end) {
          mask.runs.back().end = std::max(mask.runs.back().end, run.end);
        } else {
          mask.runs.push_back(run);
        }
      }
      mask.row_start.push_back(static_cast<int32_t>(mask.runs.size()));
    }
  }

 private:
  int width_, height_;
  std::vector<RowRun> runs_;
  std::vector<Crossing> crossings_;

  void add(int row, int begin, int end) {
    begin = std::max(begin, 0);
    end = std::min(end, width_);
    if (begin < end) runs_.push_back({row, {begin, end}});
  }
};

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

/// The outline turned and scaled, about its centre.
struct Turned {
  std::vector<Vec2> points;
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);

  Turned(const Loops& loops, const Turn& turn) {
    points.reserve(loops.points.size());
    for (const Vec2& point : loops.points) {
      points.push_back(turn(point));
      low = low.cwiseMin(points.back());
      high = high.cwiseMax(points.back());
    }
  }
};

/// The mask of cells whose grid has its origin at `corner`, as seen from the outline's centre.
Mask rasterise(const Loops& loops, const Turned& turned, const Vec2& corner, double growth,
               Cover cover) {
  Mask mask;
  mask.centre = -corner;
  const Vec2 size = (turned.high - corner).array() + growth;
  // The last row and column may be touched by rounding alone.
  constexpr double rounding = 1e-9;
  mask.width = std::max(1, static_cast<int>(std::ceil(size.x() - rounding)));
  mask.height = std::max(1, static_cast<int>(std::ceil(size.y() - rounding)));
  Rasteriser rasteriser(mask.width, mask.height, loops.points.size());
  for (int loop = 0; loop < loops.count(); ++loop) {
    for (int32_t i = loops.start[loop]; i < loops.start[loop + 1]; ++i) {
      const Vec2 a = turned.points[i] - corner;
      const Vec2 b = turned.points[loops.next(loop, i)] - corner;
      rasteriser.add_grown(a, b, growth, cover);
      rasteriser.add_crossings(a, b);
    }
  }
  rasteriser.fill_inside(cover);
  rasteriser.finish(mask);
  mask.test_order = spread_order(mask.height);
  return mask;
}

}  // namespace

Mask make_mask(const Loops& loops, double rotation_rad, double scale, double growth, Cover cover) {
  const Turned turned(loops, Turn(rotation_rad, scale));
  const Vec2 corner = turned.low.array() - growth;
  Mask mask = rasterise(loops, turned, corner, growth, cover);
  mask.rotation_rad = rotation_rad;
  return mask;
}

PlacedMask make_placed_mask(const Loops& loops, double rotation_rad, const Vec2& centre,
                            double scale, double growth, Cover cover) {
  const Turned turned(loops, Turn(rotation_rad, scale));
  PlacedMask placed;
  placed.x = static_cast<int>(std::floor(centre.x() + turned.low.x() - growth));
  placed.y = static_cast<int>(std::floor(centre.y() + turned.low.y() - growth));
  placed.mask = rasterise(loops, turned, Vec2(placed.x, placed.y) - centre, growth, cover);
  placed.mask.rotation_rad = rotation_rad;
  return placed;
}

}  // namespace partuv::packing
