#include "partuv/context.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <limits>
#include <optional>

#include "bindings.hpp"

namespace nb = nanobind;

namespace partuv {

void bind_context(nb::module_& m) {
  nb::class_<Context>(m, "Context",
                      "Cancel flag, deadline, thread count and progress of one engine call.")
      .def(
          "__init__",
          [](Context* self, int threads, std::optional<double> deadline_s) {
            new (self)
                Context(threads, deadline_s.value_or(std::numeric_limits<double>::infinity()));
          },
          nb::arg("threads") = 1, nb::arg("deadline_s") = nb::none())
      .def("cancel", &Context::cancel, "Ask the call to stop; any thread may.")
      .def_prop_ro("cancelled", &Context::cancelled)
      .def_prop_ro("threads", &Context::threads)
      .def_prop_ro(
          "progress",
          [](const Context& self) {
            const Context::Progress progress = self.progress();
            return std::make_pair(progress.fraction, progress.stage);
          },
          "(fraction in [0, 1], stage); the fraction never falls.");
}

}  // namespace partuv
