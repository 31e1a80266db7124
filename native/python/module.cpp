// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <cmath>
#include <dapple/errors.hpp>

#include "bindings.hpp"
#include "pickling.hpp"

namespace dapple::python {
namespace {

std::string text_of(double number) { return py::str(py::float_(number)).cast<std::string>(); }

void bind_errors(py::module_& m) {
  py::register_exception<SurfaceError>(m, "SurfaceError", PyExc_ValueError).doc() =
      "The arrays of a surface do not form one; the message names the array, the rule and the "
      "first offender.";
  py::register_exception<Cancelled>(m, "Cancelled", PyExc_RuntimeError).doc() =
      "The work was cancelled through its Context; nothing was changed.";
  py::register_exception<FileError>(m, "FileError", PyExc_OSError).doc() =
      "A mesh file could not be read or written.";
}

constexpr int kDeepest = 1000;  // nested parts: all of them are visited at every check

ContextPtr part_of(const ContextPtr& whole, double start, double end) {
  if (!(start >= 0.0 && start <= end && end <= 1.0))
    throw ArgumentError("start and end are " + text_of(start) + " and " + text_of(end) +
                        ": 0 <= start <= end <= 1 is needed");
  if (whole->depth() >= kDeepest)
    throw ArgumentError("the Context is nested " + std::to_string(kDeepest) +
                        " deep: deeper parts are not possible");
  return std::make_shared<SharedContext>(whole, start, end);
}

void advance(SharedContext& context, double progress) {
  if (!std::isfinite(progress))
    throw ArgumentError("progress is " + text_of(progress) + ": it must be finite");
  context.advance(progress);
}

void bind_context(py::module_& m) {
  py::class_<SharedContext, ContextPtr>(
      m, "Context",
      "Carries cancel and progress of one piece of long work; every member may be used "
      "from any thread while the work runs in another.")
      .def(py::init<>())
      .def("__reduce_ex__", refusal("it belongs to work of this process; make a new one"))
      .def("part", &part_of, py::arg("start"), py::arg("end"),
           "A Context for one of several steps: its progress moves this one's from start to end, "
           "and cancel is the same for both. Raises ValueError unless 0 <= start <= end <= 1, and "
           "for parts of parts more than 1000 deep.")
      .def("advance", &advance, py::arg("progress"),
           "For the work: raise the progress, at most to 1; a lower value leaves it. Raises "
           "ValueError if it is not finite.")
      .def("check", &Context::check, "For the work: raise Cancelled if someone asked for it.")
      .def("cancel", &Context::cancel, "Ask the work to stop; it then raises Cancelled.")
      .def_property_readonly("cancelled", &Context::cancelled, "Whether cancel() was called.")
      .def_property_readonly("progress", &Context::progress,
                             "Share of the work done, in [0, 1]; it never falls.");
}

/// pybind11 gives an object whose constructor was not called uninitialized memory.
void* refuse_without_value(std::size_t) {
  throw py::type_error("the object is empty because only __new__ was called: call __init__ too");
}

void refuse_objects_without_values(const py::module_& m) {
  for (const auto& [name, value] : m.attr("__dict__").cast<py::dict>()) {
    if (!py::isinstance<py::type>(value)) continue;
    auto* type = reinterpret_cast<PyTypeObject*>(value.ptr());
    if (py::detail::type_info* bound = py::detail::get_type_info(type))
      bound->operator_new = refuse_without_value;
  }
}

}  // namespace

PYBIND11_MODULE(_native, m) {
  m.attr("__version__") = DAPPLE_VERSION;
  stop_calls_at_exit();
  bind_errors(m);
  bind_context(m);
  bind_options(m);
  bind_surface(m);
  bind_energy(m);
  bind_class_type(m);
  bind_sampling(m);
  bind_tracking(m);
  bind_density(m);
  bind_planar(m);
  bind_class_samplers(m);
  bind_analysis(m);
  bind_stipple(m);
  bind_mosaic(m);
  bind_lines(m);
  bind_symmetry(m);
  bind_remesh(m);
  bind_texture(m);
  refuse_objects_without_values(m);
}

}  // namespace dapple::python
