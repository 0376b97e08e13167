#pragma once

#include <nanobind/nanobind.h>

#include <vector>

#include "partuv/pack.hpp"

namespace partuv {

void bind_context(nanobind::module_& m);
void bind_flatten(nanobind::module_& m);
void bind_mesh(nanobind::module_& m);
void bind_pack(nanobind::module_& m);
void bind_tree(nanobind::module_& m);
void bind_unwrap(nanobind::module_& m);

/// One array per figure, a row per tile.
nanobind::dict tile_table(const std::vector<TileFigures>& tiles);

}  // namespace partuv
