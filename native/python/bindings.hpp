// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <dapple/context.hpp>
#include <dapple/errors.hpp>
#include <dapple/surface.hpp>
#include <memory>

#include "arrays.hpp"
#include "call.hpp"
#include "whole.hpp"

namespace dapple::python {

/// A Python Context, which keeps the Context that it is a part of alive.
class SharedContext : public Context {
 public:
  SharedContext() = default;
  SharedContext(const std::shared_ptr<SharedContext>& whole, double from, double to)
      : Context(*whole, from, to), whole_(whole), depth_(whole->depth_ + 1) {}

  /// The number of nested Contexts that contain it.
  [[nodiscard]] int depth() const { return depth_; }

 private:
  std::shared_ptr<SharedContext> whole_;
  int depth_ = 0;
};

using ContextPtr = std::shared_ptr<SharedContext>;

/// A property that is a view of an array of the object.
template <typename Class, typename Member>
auto array_property(Member Class::*member) {
  return [member](const py::object& self) { return view(self, self.cast<const Class&>().*member); };
}

/// The surface with another density, as Python gives it.
/// \throw SurfaceError, ArgumentError, Cancelled
std::shared_ptr<Surface> with_density(const Surface& surface, const py::object& density,
                                      const std::string& density_at, const ContextPtr& context);

// Each function binds one subject. Their order in module.cpp matters, because signatures contain
// the names of types that were bound earlier.
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
void bind_lines(py::module_& m);
void bind_symmetry(py::module_& m);
void bind_remesh(py::module_& m);
void bind_texture(py::module_& m);

}  // namespace dapple::python
