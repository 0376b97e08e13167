#pragma once

#include <nanobind/nanobind.h>

namespace partuv {

void bind_context(nanobind::module_& m);
void bind_flatten(nanobind::module_& m);
void bind_mesh(nanobind::module_& m);
void bind_tree(nanobind::module_& m);
void bind_unwrap(nanobind::module_& m);

}  // namespace partuv
