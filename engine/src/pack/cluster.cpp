#include "pack/cluster.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pack/greedy.hpp"
#include "pack/orient.hpp"

namespace partuv::packing {

namespace {

struct Box {
  Vec2 low = Vec2::Constant(INFINITY);
  Vec2 high = Vec2::Constant(-INFINITY);
  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Vec2 size() const { return high - low; }
};

Box box_of(const std::vector<Outline>& charts, const Layout& layout) {
  Box box;
  for (size_t i = 0; i < charts.size(); ++i) {
    const Turn turn(layout.poses[i].rotation_rad, layout.scale);
    for (const Vec2& corner : charts[i].hull) box.add(turn(corner) + layout.poses[i].centre);
  }
  return box;
}

/// The members in the strip whose box, with its gutter, is smallest.
Layout best_strip(const std::vector<Outline>& charts, const Bin& bin, int cells, double scale,
                  const Context& context) {
  constexpr int rotations = 4;
  constexpr double wider = 1.25;
  const double cell = (bin.side + bin.gutter) / cells;
  const std::vector<Shape> shapes =
      make_shapes(charts, 0.05 * cell / scale, bin.gutter / scale, false);
  const MaskSet masks(shapes, bin, scale, cells, rotations, Cover::touched, context);
  double taken = 0.0;
  int widest = 1;
  for (size_t i = 0; i < charts.size(); ++i) {
    const Mask& mask = masks.at(static_cast<int>(i), 0);
    for (const Run& run : mask.runs) taken += run.end - run.begin;
    widest = std::max(widest, std::min(mask.width, mask.height));
  }
  Layout best;
  double least = INFINITY;
  int last = 0;
  double width = std::max<double>(widest, 0.6 * std::sqrt(taken));
  for (; width < 2.5 * std::sqrt(taken) + widest && !context.stopping(); width *= wider) {
    const int columns = std::min(cells, static_cast<int>(std::ceil(width)));
    if (columns == last) break;
    last = columns;
    Layout layout = greedy_strip(shapes, masks, columns, context);
    if (layout.scale <= 0.0) continue;
    const Vec2 size = box_of(charts, layout).size().array() + bin.gutter;
    if (size.prod() >= least) continue;
    least = size.prod();
    best = std::move(layout);
  }
  return best;
}

}  // namespace

Cluster make_cluster(const std::vector<Outline>& charts, std::vector<int> members, const Bin& bin,
                     int cells, double scale, Hull hull, const Context& context) {
  Cluster cluster;
  cluster.members = std::move(members);
  std::vector<Outline> own;
  for (int member : cluster.members) own.push_back(charts[member]);
  Layout layout;
  if (own.size() == 1) {
    layout.scale = scale;
    layout.poses = {{least_rectangle(own.front().hull).rotation_rad, Vec2::Zero()}};
  } else {
    layout = best_strip(own, bin, cells, scale, context);
    if (layout.scale <= 0.0) return cluster;
  }
  const Box box = box_of(own, layout);
  const Vec2 centre = 0.5 * (box.low + box.high);
  Outline& outline = cluster.outline;
  for (size_t i = 0; i < own.size(); ++i) {
    Pose pose = layout.poses[i];
    pose.centre -= centre;
    const Turn turn(pose.rotation_rad, 1.0);
    const Vec2 at = pose.centre / scale;
    for (const Vec2& corner : own[i].hull) outline.hull.push_back(turn(corner) + at);
    if (hull == Hull::outlines) {
      for (int loop = 0; loop < own[i].loops.count(); ++loop) {
        for (int32_t p = own[i].loops.start[loop]; p < own[i].loops.start[loop + 1]; ++p) {
          outline.loops.points.push_back(turn(own[i].loops.points[p]) + at);
        }
        outline.loops.close();
      }
      outline.perimeter += own[i].perimeter;
      outline.area += own[i].area;
    }
    cluster.poses.push_back(pose);
  }
  outline.hull = convex_hull(std::move(outline.hull));
  if (hull == Hull::rectangle) {
    const Vec2 half = 0.5 * box.size() / scale;
    outline.loops.points = {-half, Vec2(half.x(), -half.y()), half, Vec2(-half.x(), half.y())};
    outline.loops.close();
    outline.hull = convex_hull(outline.loops.points);
    outline.perimeter = 4.0 * half.sum();
    outline.area = 4.0 * half.prod();
  }
  for (const Vec2& point : outline.hull) outline.radius = std::max(outline.radius, point.norm());
  return cluster;
}

Layout explode(const std::vector<Cluster>& clusters, size_t charts, double made_at,
               const Layout& placed) {
  Layout layout;
  layout.scale = placed.scale;
  layout.poses.resize(charts);
  for (size_t c = 0; c < clusters.size(); ++c) {
    const Pose& pose = placed.poses[c];
    const Turn turn(pose.rotation_rad, placed.scale / made_at);
    for (size_t i = 0; i < clusters[c].members.size(); ++i) {
      const Pose& own = clusters[c].poses[i];
      layout.poses[clusters[c].members[i]] = {own.rotation_rad + pose.rotation_rad,
                                              turn(own.centre) + pose.centre};
    }
  }
  return layout;
}

}  // namespace partuv::packing
