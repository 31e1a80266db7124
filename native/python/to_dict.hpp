// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

namespace dapple::python {

/// The properties of a bound object, in the order of their definition; those of a base class first.
inline pybind11::dict to_dict(const pybind11::handle& self) {
  namespace py = pybind11;
  py::dict result;
  const py::object property = py::module_::import("builtins").attr("property");
  const py::list bases(py::type::handle_of(self).attr("__mro__"));
  bases.attr("reverse")();
  for (const py::handle base : bases)
    for (const auto& [name, value] : py::dict(base.attr("__dict__")))
      if (py::isinstance(value, property)) result[name] = self.attr(name);
  return result;
}

}  // namespace dapple::python
