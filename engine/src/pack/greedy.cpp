#include "pack/greedy.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "pack/board.hpp"
#include "pack/mask.hpp"
#include "pack/orient.hpp"
#include "pack/random.hpp"

namespace partuv::packing {

namespace {

std::vector<int> falling_bulk(const std::vector<Shape>& shapes, uint64_t variant) {
  std::vector<double> bulk(shapes.size());
  for (size_t i = 0; i < shapes.size(); ++i) {
    bulk[i] = shapes[i].bulk;
    if (variant) bulk[i] *= std::exp(0.5 * (uniform(variant, i) - 0.5));
  }
  std::vector<int> order(shapes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return bulk[a] > bulk[b]; });
  return order;
}

/// The lowest row where charts of about a size last found room. Room only shrinks and the charts
/// come by falling size, so looking further down again would be in vain, nearly always.
class Floors {
 public:
  explicit Floors(size_t charts) : enabled_(charts > few) {}
  int get(const Mask& mask) const {
    const auto found = floors_.find(key(mask));
    return found == floors_.end() ? 0 : found->second;
  }
  void set(const Mask& mask, int y) {
    if (enabled_) floors_[key(mask)] = y;
  }

 private:
  static constexpr size_t few = 400;
  bool enabled_;
  std::map<std::pair<int, int>, int> floors_;
  static int step(int size) { return static_cast<int>(std::floor(8.0 * std::log2(size))); }
  static std::pair<int, int> key(const Mask& mask) { return {step(mask.width), step(mask.height)}; }
};

}  // namespace

std::vector<Shape> make_shapes(const std::vector<Outline>& charts, double tolerance, double gutter,
                               bool upright) {
  std::vector<Shape> shapes(charts.size());
  for (size_t i = 0; i < charts.size(); ++i) {
    shapes[i].loops = reduced(charts[i], tolerance, gutter);
    shapes[i].slack = tolerance;
    const Orientation rectangle = least_rectangle(charts[i].hull);
    shapes[i].start_rad = rectangle.rotation_rad;
    shapes[i].length = rectangle.size.x();
    shapes[i].square_rad =
        upright ? rectangle.rotation_rad : least_square(charts[i].hull).rotation_rad;
    // Bulky and long charts both want room early.
    shapes[i].bulk = std::sqrt(charts[i].area + charts[i].radius * charts[i].radius);
  }
  return shapes;
}

double turn_rad(const Shape& shape, int turn, int count, double side) {
  const double start = shape.length > side ? shape.square_rad : shape.start_rad;
  return start + 2.0 * std::numbers::pi * turn / count;
}

Mask make_mask(const Shape& shape, double rotation_rad, double scale, double growth, Cover cover) {
  if (shape.wary) {
    growth += 0.5;
    cover = Cover::touched;
  }
  if (cover == Cover::touched) growth += shape.slack * scale;
  return make_mask(shape.loops, rotation_rad, scale, growth, cover);
}

// Growth beyond half the gutter covers rounding in the mask's own arithmetic.
MaskSet::MaskSet(const std::vector<Shape>& shapes, const Bin& bin, double scale, int cells,
                 int rotations, Cover cover, const Context& context)
    : scale_(scale),
      cell_((bin.side + bin.gutter) / cells),
      gutter_(bin.gutter),
      growth_(0.5 * gutter_ / cell_ + 1e-7),
      cells_(cells),
      rotations_(rotations),
      masks_(shapes.size() * rotations) {
  parallel_for(context, static_cast<int>(shapes.size()), [&](int i) {
    if (context.stopping()) return;
    const Shape& shape = shapes[i];
    for (int turn = 0; turn < rotations; ++turn) {
      const double angle = turn_rad(shape, turn, rotations, bin.side / scale);
      masks_[size_t(i) * rotations + turn] = make_mask(shape, angle, scale / cell_, growth_, cover);
    }
  });
}

Pose MaskSet::pose(const Mask& mask, int x, int y) const {
  return {mask.rotation_rad, ((Vec2(x, y) + mask.centre) * cell_).array() - 0.5 * gutter_};
}

PlacedMask MaskSet::placed(const Outline& outline, const Pose& pose) const {
  const Vec2 centre = (pose.centre.array() + 0.5 * gutter_) / cell_;
  return make_placed_mask(outline.loops, pose.rotation_rad, centre, scale_ / cell_, growth_,
                          Cover::touched);
}

namespace {

Layout fill(const std::vector<Shape>& shapes, const MaskSet& masks, Board board, uint64_t variant,
            const Context& context) {
  Layout layout;
  layout.poses.resize(shapes.size());
  Floors floors(shapes.size());
  for (int index : falling_bulk(shapes, variant)) {
    if (context.stopping()) return layout;
    const Mask* best_mask = nullptr;
    Board::Spot best;
    int best_top = 0;
    for (int turn = 0; turn < masks.rotations(); ++turn) {
      const Mask& mask = masks.at(index, turn);
      const int to = best.found ? best_top - mask.height + 1 : masks.cells();
      const Board::Spot spot = board.lowest(mask, floors.get(mask), to);
      if (!spot.found) continue;
      const int top = spot.y + mask.height;
      if (!best.found || top < best_top || (top == best_top && spot.x < best.x)) {
        best = spot;
        best_top = top;
        best_mask = &mask;
      }
    }
    if (!best.found) return layout;
    board.put(*best_mask, best.x, best.y);
    floors.set(*best_mask, best.y);
    layout.poses[index] = masks.pose(*best_mask, best.x, best.y);
  }
  layout.scale = masks.scale();
  return layout;
}

}  // namespace

Layout greedy(const std::vector<Shape>& shapes, const MaskSet& masks, uint64_t variant,
              const Context& context) {
  return fill(shapes, masks, Board(masks.cells()), variant, context);
}

Layout greedy_strip(const std::vector<Shape>& shapes, const MaskSet& masks, int width,
                    const Context& context) {
  return fill(shapes, masks, Board(masks.cells(), std::clamp(width, 1, masks.cells())), 0, context);
}

Layout greedy_around(const std::vector<Outline>& placed, const Layout& layout,
                     const std::vector<Shape>& shapes, const MaskSet& masks,
                     const Context& context) {
  Board board(masks.cells());
  for (size_t i = 0; i < placed.size(); ++i) {
    const PlacedMask mask = masks.placed(placed[i], layout.poses[i]);
    board.put(mask.mask, mask.x, mask.y);
  }
  return fill(shapes, masks, std::move(board), 0, context);
}

}  // namespace partuv::packing
