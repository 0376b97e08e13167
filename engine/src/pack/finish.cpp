#include "pack/finish.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pack/compact.hpp"

namespace partuv::packing {

namespace {

constexpr size_t many = 4000;  // charts that stay as they are
// How far charts may move in the programs, one after the other.
constexpr std::array<double, 3> ways_texels{0.1, 0.02, 0.004};
// Of the gutter: by shift, turn and growth two charts come nearer by less than ten ways in all, so
// that none passes another.
constexpr double most_way = 0.1;
// The room for rounding is tried from none of it to all.
constexpr int shares = 8;

void shift(Layout& layout, double by) {
  for (Pose& pose : layout.poses) pose.centre.array() += by;
}

}  // namespace

void finish(const std::vector<Outline>& charts, const Frame& frame, const Frame& asked,
            const WrittenGrid& grid, Layout& layout, const Context& context) {
  if (charts.size() < 2 || charts.size() > many || layout.scale <= 0.0) return;
  if (ways_texels.front() > most_way * asked.bin.gutter) return;
  const double finest = 0.01 * grid.step_texels() / layout.scale;
  std::vector<Loops> loops;
  for (const Outline& chart : charts) {
    loops.push_back(reduced(chart, finest, asked.bin.gutter / layout.scale));
  }
  Layout closer = layout;
  shift(closer, frame.inset - asked.inset);
  for (const double way : ways_texels) {
    if (!nudge(loops, asked.bin, way, closer, context)) return;
  }
  const WrittenOutlines written(charts, grid);
  const double room = frame.bin.gutter - asked.bin.gutter;
  const double step = grid.step_texels() / asked.bin.side;
  for (int share = 0; share <= shares; ++share) {
    const double kept = room * share / shares;
    Layout trial = closer;
    // A wall is met by one of two charts' roundings.
    const Bin bin{asked.bin.side, asked.bin.gutter + kept, 0.5 * kept};
    if (!nudge(loops, bin, ways_texels.back(), trial, context)) return;
    const double scale = trial.scale;
    for (const double steps : {1.0, 0.5, 0.0, -0.5}) {  // that the whole of the charts grows by
      trial.scale = scale * (1.0 + steps * step);
      if (trial.scale <= layout.scale) return;
      if (!written.hold(trial, asked)) continue;
      layout = std::move(trial);
      shift(layout, asked.inset - frame.inset);
      return;
    }
  }
}

}  // namespace partuv::packing
