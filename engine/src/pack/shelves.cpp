#include <algorithm>
#include <cmath>
#include <numeric>

#include "pack/layout.hpp"
#include "pack/orient.hpp"

namespace partuv::packing {

Turn::Turn(double rotation_rad, double scale)
    : cosine(scale * std::cos(rotation_rad)), sine(scale * std::sin(rotation_rad)) {}

namespace {

struct Box {
  Orientation orientation;
  Vec2 offset;  ///< from the box's lower left corner to the outline's centre, unscaled
};

Box make_box(const Outline& outline) {
  Box box;
  box.orientation = least_rectangle(outline.hull);
  const Turn turn(box.orientation.rotation_rad, 1.0);
  Vec2 low = Vec2::Zero();
  Vec2 high = Vec2::Zero();
  for (size_t i = 0; i < outline.hull.size(); ++i) {
    const Vec2 p = turn(outline.hull[i]);
    low = i ? Vec2(low.cwiseMin(p)) : p;
    high = i ? Vec2(high.cwiseMax(p)) : p;
  }
  box.orientation.size = high - low;
  box.offset = -low;
  return box;
}

/// Fill shelf after shelf; corners receives the boxes' lower left corners when given.
bool fill(const std::vector<Box>& boxes, const std::vector<int>& order, const Bin& bin,
          double scale, std::vector<Vec2>* corners) {
  double x = 0.0;
  double y = 0.0;
  double shelf_height = -1.0;
  for (int index : order) {
    const Vec2 size = scale * boxes[index].orientation.size;
    if (size.x() > bin.side) return false;
    if (shelf_height < 0.0 || x + size.x() > bin.side) {
      if (shelf_height >= 0.0) y += shelf_height + bin.gutter;
      x = 0.0;
      shelf_height = size.y();  // the order is by falling height
      if (y + shelf_height > bin.side) return false;
    }
    if (corners) (*corners)[index] = Vec2(x, y);
    x += size.x() + bin.gutter;
  }
  return true;
}

}  // namespace

Layout shelves(const std::vector<Outline>& charts, const Bin& bin) {
  std::vector<Box> boxes;
  boxes.reserve(charts.size());
  for (const Outline& outline : charts) boxes.push_back(make_box(outline));
  std::vector<int> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int one, int two) {
    return boxes[one].orientation.size.y() > boxes[two].orientation.size.y();
  });
  double widest = 0.0;
  for (const Box& box : boxes) widest = std::max(widest, box.orientation.size.x());
  Layout layout;
  layout.poses.resize(charts.size());
  if (widest <= 0.0) widest = bin.side > 0.0 ? bin.side : 1.0;  // only points: any scale will do
  // Bisect on the logarithm: with many gutters the scale may be very small, but not zero.
  double high = bin.side / widest;
  double low = high * 1e-9;
  if (fill(boxes, order, bin, high, nullptr)) {
    low = high;
  } else {
    if (!fill(boxes, order, bin, low, nullptr)) return layout;
    for (int i = 0; i < 48; ++i) {
      const double middle = std::sqrt(low * high);
      (fill(boxes, order, bin, middle, nullptr) ? low : high) = middle;
    }
  }
  std::vector<Vec2> corners(charts.size());
  fill(boxes, order, bin, low, &corners);
  layout.scale = low;
  for (size_t i = 0; i < charts.size(); ++i) {
    layout.poses[i] = {boxes[i].orientation.rotation_rad, corners[i] + low * boxes[i].offset};
  }
  return layout;
}

}  // namespace partuv::packing
