// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <dapple/context.hpp>
#include <dapple/errors.hpp>
#include <memory>

#include "arrays.hpp"
#include "whole.hpp"

namespace dapple::python {

using ContextPtr = std::shared_ptr<Context>;

/// What the work returns, done while other Python threads run.
template <typename Work>
auto without_gil(const Work& work) {
  const py::gil_scoped_release released;
  return work();
}

/// A property that shows an array of the object without copying it.
template <typename Class, typename Member>
auto array_property(Member Class::*member) {
  return [member](const py::object& self) { return view(self, self.cast<const Class&>().*member); };
}

// Each binds one subject; the order in module.cpp matters, since signatures name the types bound
// before.
void bind_options(py::module_& m);
void bind_surface(py::module_& m);
void bind_energy(py::module_& m);
void bind_class_type(py::module_& m);
void bind_sampling(py::module_& m);
void bind_tracking(py::module_& m);
void bind_density(py::module_& m);
void bind_planar(py::module_& m);
void bind_class_samplers(py::module_& m);
void bind_analysis(py::module_& m);
void bind_stipple(py::module_& m);
void bind_mosaic(py::module_& m);
void bind_texture(py::module_& m);

}  // namespace dapple::python
