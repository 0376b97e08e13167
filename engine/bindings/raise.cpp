#include "raise.hpp"

#include <nanobind/nanobind.h>

namespace nb = nanobind;

namespace partuv {

void raise(const Failure& failure) {
  const nb::object type = nb::module_::import_("partuv_engine._errors").attr("EngineError");
  const nb::object error = type(error_name(failure.error), failure.where.c_str());
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

}  // namespace partuv
