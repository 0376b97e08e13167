#pragma once

#include "partuv/types.hpp"

namespace partuv {

/// Twice the signed area of a triangle in the plane: positive where a, b, c turn counter-clockwise.
inline double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace partuv
