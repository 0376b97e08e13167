#pragma once

#include <vector>

#include "pack/compact.hpp"
#include "pack/layout.hpp"
#include "partuv/context.hpp"

namespace partuv::packing {

/// The charts of one bin at the detail the last texel fractions need.
class Polisher {
 public:
  /// `scale` is about the one that will come out (texels per outline unit). Charts keep their turn
  /// where they have to stay upright.
  Polisher(const std::vector<Outline>& charts, const Bin& bin, double scale, bool upright);

  /// Make a layout from a raster pass valid, if need be at a slightly smaller scale, and grow it
  /// until the charts hold each other fast. `steps` bounds the programs solved. On failure the
  /// scale is 0, and the charts that were caught come back, as in holes a little too small for
  /// them.
  Pushed tighten(Layout& layout, int steps, const Context& context) const;

  /// Scale the charts, each about its centre, by the largest factor near 1 at which the full
  /// outlines keep the gutter and the bin. Scale 0 when there is none.
  void settle(Layout& layout, const Context& context) const;

  /// The layout with its charts at a smaller scale, moved a little where shrinking about their
  /// centres brings interlocked ones too near each other. Scale 0 when that does not do.
  Layout shrunk(Layout layout, double scale, const Context& context) const;

 private:
  bool upright_;
  Bin bin_;
  Bin tight_;  // with room for what the simplified loops leave out
  double radius_ = 0.0;
  std::vector<Loops> exact_;
  std::vector<Loops> fine_;

  bool holds(const std::vector<Loops>& loops, const Bin& bin, const Layout& layout) const;
};

}  // namespace partuv::packing
