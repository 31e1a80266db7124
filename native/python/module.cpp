// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/errors.hpp>

#include "bindings.hpp"

namespace dapple::python {
namespace {

void bind_errors(py::module_& m) {
  py::register_exception<SurfaceError>(m, "SurfaceError", PyExc_ValueError).doc() =
      "The arrays of a surface do not form one; the message names the array, the rule and the "
      "first offender.";
  py::register_exception<Cancelled>(m, "Cancelled", PyExc_RuntimeError).doc() =
      "The work was cancelled through its Context; nothing was changed.";
  py::register_exception<FileError>(m, "FileError", PyExc_OSError).doc() =
      "A mesh file could not be read or written.";
}

void bind_context(py::module_& m) {
  py::class_<Context, ContextPtr>(
      m, "Context",
      "Carries cancel and progress of one piece of long work; every member may be used "
      "from any thread while the work runs in another.")
      .def(py::init<>())
      .def(
          "part",
          [](Context& whole, double from, double to) {
            return std::make_shared<Context>(whole, from, to);
          },
          py::arg("start"), py::arg("end"), py::keep_alive<0, 1>(),
          "A Context for one of several steps: its progress moves this one's from start to end, "
          "and cancel is the same for both.")
      .def("advance", &Context::advance, py::arg("progress"),
           "For the work: raise the progress; a lower value leaves it.")
      .def("check", &Context::check, "For the work: raise Cancelled if someone asked for it.")
      .def("cancel", &Context::cancel, "Ask the work to stop; it then raises Cancelled.")
      .def_property_readonly("cancelled", &Context::cancelled, "Whether cancel() was called.")
      .def_property_readonly("progress", &Context::progress,
                             "Share of the work done, in [0, 1]; it never falls.");
}

}  // namespace

PYBIND11_MODULE(_native, m) {
  m.attr("__version__") = DAPPLE_VERSION;
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
  bind_texture(m);
}

}  // namespace dapple::python
