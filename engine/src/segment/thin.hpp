#pragma once

#include "partuv/search.hpp"

namespace partuv {

/// Mean width of a chart's map, twice its area over its perimeter: of a strip its width, of a disc
/// its radius.
double mean_width(const Flattening& flat);

/// The narrow side of the rectangle that has the area and the perimeter of a chart's map: of a
/// strip its width, of a disc four fifths of its diameter.
double narrow_width(const Flattening& flat);

/// True if a chart keeps its area bound even where all faces that are no higher than a few
/// `rounding_step` of the options lose their area, or multiply it, when the map is written.
bool survives_rounding(const Flattening& flat, const SearchOptions& options);

}  // namespace partuv
