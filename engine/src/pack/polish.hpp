#pragma once

#include <algorithm>
#include <vector>

#include "pack/compact.hpp"
#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// What becomes of a layout in which a few charts are caught, as in holes a little too small.
enum class Caught {
  fail,
  move_elsewhere,  ///< they are put where there is room
};

/// The charts of one bin at the detail the last texel fractions need.
class Polisher {
 public:
  /// `scale` is about the one that will come out (texels per outline unit). Charts keep their turn
  /// where they have to stay upright. The charts must outlive this.
  Polisher(const std::vector<Outline>& charts, const Bin& bin, double scale, bool upright);

  /// Make a layout from a raster pass valid, if need be at a slightly smaller scale, and grow it
  /// until the charts hold each other fast. `steps` bounds the programs solved. On failure the
  /// scale is 0, and the charts that were caught come back.
  Pushed tighten(Layout& layout, int steps, Caught caught, const Context& context) const;

  /// Scale the charts, each about its centre, by the largest factor near 1 at which the full
  /// outlines keep the gutter and the bin. Scale 0 when there is none.
  void settle(Layout& layout, const Context& context) const;

  /// Grow a settled layout by what the detail of `tighten` leaves between the charts.
  void close_up(Layout& layout, const Context& context) const;

  /// The layout with its charts at a smaller scale, moved a little where shrinking about their
  /// centres brings interlocked ones too near each other. Scale 0 when that does not do.
  Layout shrunk(Layout layout, double scale, const Context& context) const;

 private:
  const std::vector<Outline>& charts_;
  bool upright_;
  Bin bin_;
  Bin tight_;    // with room for what the simplified loops leave out
  Bin tighter_;  // the same for `finest_`
  double radius_ = 0.0;
  std::vector<Loops> exact_;
  std::vector<Loops> finest_;  // for the last steps
  std::vector<Loops> fine_;

  /// A layout without charts that were caught in it.
  struct Freed {
    std::vector<int> out;
    std::vector<int> rest;
    Layout layout;      ///< of the rest
    bool done = false;  ///< none of the rest is caught
    int64_t work = 0;
  };
  /// How many charts may be taken out.
  size_t few() const { return std::min<size_t>(12, charts_.size() / 4); }
  Freed free_without(std::vector<int> out, const Layout& layout, const Context& context) const;
  bool put_elsewhere(const Freed& freed, Layout& layout, const Context& context) const;
  bool holds(const std::vector<Loops>& loops, const Bin& bin, const Layout& layout) const;
};

}  // namespace partuv::packing
