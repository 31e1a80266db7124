// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <dapple/sampler.hpp>

namespace dapple::python {

namespace py = pybind11;

/// A class of samples as given in Python; the surface of its density is known only to the sampler.
struct ClassArgument {
  std::int64_t count = 0;
  py::object density = py::none();
  std::string density_at = "vertices";
  double radius = 0.0;
  py::object locked = py::none();  // Samples
};

/// A sequence of SampleClass or integers.
/// \throw ArgumentError naming the first entry that is neither
[[nodiscard]] std::vector<ClassArgument> class_arguments(const py::sequence& classes);

/// The same for a surface.
/// \throw SurfaceError for a density that does not fit it
[[nodiscard]] std::vector<SampleClass> classes_on(const Surface& surface,
                                                  const py::sequence& classes);

}  // namespace dapple::python
