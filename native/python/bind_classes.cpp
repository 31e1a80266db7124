// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/planar_sampler.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "classes.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple::python {

inline auto members(ClassArgument& c) {
  return std::tie(c.count, c.density, c.density_at, c.radius, c.locked);
}

namespace {

ClassArgument make_class(Count count, const py::object& density, const std::string& density_at,
                         double radius, const py::object& locked) {
  if (!locked.is_none() && !py::isinstance<Samples>(locked))
    throw ArgumentError("locked is " + py::repr(locked).cast<std::string>() +
                        ": Samples or None are needed");
  return {static_cast<std::int64_t>(count.value), density, density_at, radius, locked};
}

Sites sites_of(const py::object& locked) {
  if (locked.is_none()) return {};
  const auto& samples = locked.cast<const Samples&>();
  return {samples.positions, samples.faces, samples.barycentric};
}

std::shared_ptr<Samples> sample_surface(const Surface& surface, const py::sequence& classes,
                                        const py::kwargs& keywords) {
  const Keywords given(kSampleClasses, keywords);
  const ClassOptions options = given.options();
  const ContextPtr context = given.context();
  const std::vector<SampleClass> wanted = classes_on(surface, classes);
  return run(context, [&](Context* watched) {
    return std::make_shared<Samples>(sample_classes(surface, wanted, options, watched));
  });
}

/// The result of a call that reads the density of a class, whose errors then name the class.
auto of_class(std::size_t k, const auto& call) {
  const std::string name = "classes[" + std::to_string(k) + "].";
  try {
    return call();
  } catch (const SurfaceError& error) {
    throw SurfaceError(name + error.what());
  } catch (const ArgumentError& error) {
    throw ArgumentError(name + error.what());
  }
}

std::vector<SampleClass> classes_in_plane(const py::sequence& classes) {
  std::vector<SampleClass> result;
  for (const ClassArgument& argument : class_arguments(classes)) {
    if (!argument.locked.is_none())
      throw ArgumentError("classes[" + std::to_string(result.size()) +
                          "] has locked samples: a surface is needed for them");
    result.push_back(
        {.count = static_cast<std::size_t>(argument.count), .radius = argument.radius});
    if (argument.density.is_none()) continue;
    result.back().image =
        of_class(result.size() - 1, [&] { return image_of("density", argument.density); });
  }
  return result;
}

std::shared_ptr<PlanarSamples> sample_flat(const FlatDomain& domain, const py::sequence& classes,
                                           const py::kwargs& keywords) {
  const Keywords given(kSampleClasses, keywords);
  const ClassOptions options = given.options();
  const ContextPtr context = given.context();
  const std::vector<SampleClass> wanted = classes_in_plane(classes);
  return run(context, [&](Context* watched) {
    return std::make_shared<PlanarSamples>(sample_classes(domain, wanted, options, watched));
  });
}

}  // namespace

std::vector<ClassArgument> class_arguments(const py::sequence& classes) {
  std::vector<ClassArgument> result;
  for (const py::object& entry : items_of(classes)) {
    const std::string name = "classes[" + std::to_string(result.size()) + "]";
    if (py::isinstance<ClassArgument>(entry))
      result.push_back(entry.cast<ClassArgument>());
    else if (const py::object number = whole_number(entry))
      result.push_back(
          {static_cast<std::int64_t>(bounded(name + ".count", number, 0, kMostSamples))});
    else
      throw ArgumentError(name + " is " + py::repr(entry).cast<std::string>() +
                          ": a SampleClass or a count is needed");
  }
  return result;
}

std::vector<SampleClass> classes_on(const Surface& surface, const py::sequence& classes) {
  std::vector<SampleClass> result;
  for (const ClassArgument& argument : class_arguments(classes)) {
    result.push_back({.count = static_cast<std::size_t>(argument.count),
                      .radius = argument.radius,
                      .locked = sites_of(argument.locked)});
    if (argument.density.is_none()) continue;
    result.back().surface = of_class(result.size() - 1, [&] {
      return *with_density(surface, argument.density, argument.density_at, nullptr);
    });
  }
  return result;
}

void bind_class_type(py::module_& m) {
  py::class_<ClassArgument> type(m, "SampleClass",
                                 R"(A class of samples: count, density, radius and locked samples.

Args:
    count: number of samples, 0..100000000.
    density: of the class, or None for the surface's or domain's own. For a Surface an array as Surface takes it; for a
        Plane or Torus an image, all classes' and the domain's own of one shape.
    density_at: 'vertices', 'faces' or 'corners', as for Surface; images do not need it.
    radius: of its discs, in the units of the vertices, >= 0. Pairs are kept apart by the sum of their radii: rocks stay out of trees.
        Samples of radius 0 stay outside the discs of others.
    locked: Samples of the surface that do not move, or None; they come first in their class, and
        count includes them. For surfaces only.

Raises:
    ValueError: count out of range.)");
  def_pickle<ClassArgument>(type, "SampleClass");
  type.def(py::init(&make_class), py::arg("count"), py::kw_only(), py::arg("density") = py::none(),
           py::arg("density_at") = "vertices", py::arg("radius") = 0.0,
           py::arg("locked") = py::none())
      .def_readonly("count", &ClassArgument::count, "Number of samples.")
      .def_readonly("density", &ClassArgument::density, "As given, or None.")
      .def_readonly("density_at", &ClassArgument::density_at, "Where its values are.")
      .def_readonly("radius", &ClassArgument::radius, "Of its discs.")
      .def_readonly("locked", &ClassArgument::locked, "As given, or None.");
}

void bind_class_samplers(py::module_& m) {
  def_verb(
      m, kSampleClasses, &sample_surface,
      R"(sample_classes(surface: Surface, classes: Sequence[SampleClass | int], *, {signature}, context: Context | None = None) -> Samples

Several classes of samples at once: each even by itself, and all together.

Minimizes union_weight * N * E(union) + the sum of E(class) over the N classes that are not empty, each normalized by its
own number and density (Chen et al. 2012, Algorithm 3), from a Poisson-disk set of all classes.
sample_classes(..., **dapple.PAPER, two_stages=True) is the method of the paper.

Args:
    surface: a Surface.
    classes: a sequence of SampleClass or counts.
    {options}
    context: a Context for progress and cancel.

Returns:
    Samples, class by class; their report contains one of each class, and the pair of discs that overlaps most.

Raises:
    ValueError: an option out of range, or radii for which the area cannot suffice.
    SurfaceError: a density that does not fit the surface.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("classes"));
  def_verb(
      m, kSampleClasses, &sample_flat,
      R"(sample_classes(domain: FlatDomain, classes: Sequence[SampleClass | int], *, {signature}, context: Context | None = None) -> PlanarSamples

Several classes of samples of a Plane or Torus at once: see sample_classes().

Args:
    domain: a Plane or a Torus.
    classes: a sequence of SampleClass or counts.
    {options}
    context: a Context for progress and cancel.

Returns:
    PlanarSamples, class by class, with a report.

Raises:
    ValueError: an option out of range, the first image of another shape, or radii for which the area cannot suffice.
    Cancelled: through the context.)",
      py::arg("domain"), py::arg("classes"));
}

}  // namespace dapple::python
