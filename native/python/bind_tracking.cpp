// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <dapple/errors.hpp>
#include <dapple/population.hpp>
#include <dapple/window.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "classes.hpp"
#include "options.hpp"

namespace dapple::python {
namespace {

/// The options that every way of tracking takes.
TrackerOptions tracker_options(double capacity_weight, double repulsion_weight, double tolerance,
                               MaxEvaluations max_evaluations, double max_slide,
                               const std::string& method, const std::string& cells,
                               double stickiness, double pattern_strength, double longest_motion,
                               Threads threads) {
  TrackerOptions options;
  options.optimizer =
      optimizer_options(capacity_weight, repulsion_weight, tolerance, max_evaluations, method);
  options.optimizer.max_slide = max_slide;
  options.optimizer.stickiness = stickiness;
  options.cells = cells_named(cells);
  options.pattern_strength = pattern_strength;
  options.longest_motion = longest_motion;
  options.threads = threads;
  return options;
}

std::shared_ptr<Tracker> make_tracker(
    const Surface& surface, const Samples& samples, double capacity_weight, double repulsion_weight,
    double tolerance, MaxEvaluations max_evaluations, double max_slide, const std::string& method,
    const std::string& cells, const py::object& classes, double union_weight, double stickiness,
    double pattern_strength, double longest_motion, Threads threads, const ContextPtr& context) {
  TrackerOptions options =
      tracker_options(capacity_weight, repulsion_weight, tolerance, max_evaluations, max_slide,
                      method, cells, stickiness, pattern_strength, longest_motion, threads);
  options.union_weight = union_weight;
  std::vector<SampleClass> wanted;
  if (!classes.is_none()) wanted = classes_on(surface, py::sequence(classes));
  const py::gil_scoped_release released;
  return std::make_shared<Tracker>(surface, samples, options, std::move(wanted), context.get());
}

std::shared_ptr<Samples> advance_tracker(Tracker& tracker, const py::object& vertices,
                                         const ContextPtr& context) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const py::gil_scoped_release released;
  return std::make_shared<Samples>(tracker.advance(as_points(points), context.get()));
}

void resume_tracker(Tracker& tracker, const py::object& vertices, const Samples& samples,
                    bool settled) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const py::gil_scoped_release released;
  tracker.resume(as_points(points), samples, settled);
}

std::shared_ptr<Population> make_population(const Surface& surface, const Samples& samples,
                                            Whole<int, "fade", 1, kMostInt> fade,
                                            double capacity_weight, double repulsion_weight,
                                            double tolerance, MaxEvaluations max_evaluations,
                                            double max_slide, const std::string& method,
                                            const std::string& cells, double stickiness,
                                            double pattern_strength, double longest_motion,
                                            Threads threads, const ContextPtr& context) {
  const PopulationOptions options{
      .tracker =
          tracker_options(capacity_weight, repulsion_weight, tolerance, max_evaluations, max_slide,
                          method, cells, stickiness, pattern_strength, longest_motion, threads),
      .fade = fade};
  const py::gil_scoped_release released;
  return std::make_shared<Population>(surface, samples, options, context.get());
}

std::shared_ptr<Samples> advance_population(Population& population, const py::object& vertices,
                                            const ContextPtr& context) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const py::gil_scoped_release released;
  return std::make_shared<Samples>(population.advance(as_points(points), context.get()));
}

std::vector<std::shared_ptr<Samples>> window_of(
    const Surface& surface, const py::iterable& frames, const Samples& samples, bool closed,
    Whole<int, "sweeps", 0, kMostInt> sweeps, double capacity_weight, double repulsion_weight,
    double tolerance, MaxEvaluations max_evaluations, double max_slide, const std::string& method,
    const std::string& cells, double stickiness, double pattern_strength, double longest_motion,
    Threads threads, const ContextPtr& context) {
  std::vector<std::vector<Vec3>> vertices;
  for (const py::handle frame : frames) {
    const DoubleArray points = doubles("frames", py::reinterpret_borrow<py::object>(frame), 3);
    const std::span<const Vec3> span = as_points(points);
    vertices.emplace_back(span.begin(), span.end());
  }
  const WindowOptions options{
      .tracker =
          tracker_options(capacity_weight, repulsion_weight, tolerance, max_evaluations, max_slide,
                          method, cells, stickiness, pattern_strength, longest_motion, threads),
      .sweeps = sweeps,
      .closed = closed};
  const py::gil_scoped_release released;
  std::vector<std::shared_ptr<Samples>> result;
  for (Samples& one : track_window(surface, vertices, samples, options, context.get()))
    result.push_back(std::make_shared<Samples>(std::move(one)));
  return result;
}

void bind_tracker(py::module_& m) {
  py::class_<Tracker, std::shared_ptr<Tracker>>(m, "Tracker",
                                                R"(Carries samples over a deforming surface.

They ride the moved vertices by their barycentric coordinates and are then re-optimized until they are as even as in
the first frame; index and id of each stay (Chen et al. 2012, section 5.4).

Args:
    surface: the Surface of the first frame.
    samples: its Samples.
    capacity_weight, repulsion_weight, tolerance, method, cells, threads: as for sample().
    max_evaluations: of the energy, per frame or part of one.
    max_slide: farthest that a sample may slide from its carried position within one frame, in spacings, >= 0; after a
        violent frame evenness is caught up over the next ones.
    classes: the SampleClass of each class of the samples (their counts are the samples'), or None: all are one class.
    union_weight: mu >= 0, as for sample_classes().
    stickiness: gamma >= 0, the weight of the squared distances from the carried positions: more of it, and samples
        slide less and are less even; 1 is the weight of E_cvt.
    pattern_strength: 0..1, how strongly samples return to the first frame's pattern where a deformation has gone; 0 lets the
        pattern drift.
    longest_motion: farthest that the surface's shape may move at once, relative to its size, apart from moving as a
        whole; a frame on which it moves farther is split (report.parts). 0 never splits.
    context: a Context to watch and cancel it by.

Raises:
    ValueError: the samples are not of the surface, or of a class that is not given; an option out of range.
    Cancelled: through the context.)")
      .def(py::init(&make_tracker), py::arg("surface"), py::arg("samples"), py::kw_only(),
           py::arg("capacity_weight") = 30.0, py::arg("repulsion_weight") = 3.0,
           py::arg("tolerance") = 5e-5, py::arg("max_evaluations") = 6, py::arg("max_slide") = 0.45,
           py::arg("method") = "trust_region", py::arg("cells") = "connected",
           py::arg("classes") = py::none(), py::arg("union_weight") = 1.0,
           py::arg("stickiness") = 0.0, py::arg("pattern_strength") = 0.8,
           py::arg("longest_motion") = 0.02, py::arg("threads") = 0, py::arg("context") = nullptr)
      .def(
          "resume", &resume_tracker, py::arg("vertices"), py::arg("samples"), py::kw_only(),
          py::arg("settled") = false,
          R"(Go on from a frame that was solved before: the next frames get the bytes that they would have had.

Args:
    vertices: (v, 3) float64, of that frame.
    samples: Samples with its faces and barycentric coordinates, as many as the tracker has; ids and classes stay.
    settled: what the property said then.

Raises:
    SurfaceError: vertices of another number or not finite.
    ValueError: samples of another number, or not of the surface.)")
      .def_property_readonly(
          "settled", &Tracker::settled,
          "Whether nothing was left to be caught up when the last frame was done.")
      .def("advance", &advance_tracker, py::arg("vertices"), py::kw_only(),
           py::arg("context") = nullptr,
           R"(Move to the next frame; the tracker is unchanged if this raises.

Args:
    vertices: (v, 3) float64, as many as the surface has, in the same order.
    context: a Context to watch and cancel it by.

Returns:
    Samples of the new frame; report.slide_mean and slide_max are distances from the carried positions, in spacings.

Raises:
    SurfaceError: vertices of another number or not finite.
    Cancelled: through the context.)")
      .def_property_readonly(
          "surface", [](const Tracker& t) { return std::make_shared<Surface>(t.surface()); },
          "The Surface of the current frame.")
      .def_property_readonly(
          "samples", [](const Tracker& t) { return std::make_shared<Samples>(t.samples()); },
          "The Samples of the current frame.");
}

void bind_population(py::module_& m) {
  py::class_<Population, std::shared_ptr<Population>>(
      m, "Population",
      R"(Samples on a deforming surface at a constant density per area.

Where the surface grows samples appear, where it shrinks some vanish; they never pop (Samples.fade goes from 0 to 1 or
back), and an id is never used again. Apart from that it is a Tracker.

Args:
    surface: the Surface of the first frame.
    samples: its Samples, of one class; their number per capacity is kept.
    fade: frames that a sample takes to appear or to vanish, >= 1.
    the others: as for Tracker.

Raises:
    ValueError: the samples are not of the surface, or an option is out of range.
    Cancelled: through the context.)")
      .def(py::init(&make_population), py::arg("surface"), py::arg("samples"), py::kw_only(),
           py::arg("fade") = 12, py::arg("capacity_weight") = 30.0,
           py::arg("repulsion_weight") = 3.0, py::arg("tolerance") = 5e-5,
           py::arg("max_evaluations") = 6, py::arg("max_slide") = 0.45,
           py::arg("method") = "trust_region", py::arg("cells") = "connected",
           py::arg("stickiness") = 0.0, py::arg("pattern_strength") = 0.8,
           py::arg("longest_motion") = 0.02, py::arg("threads") = 0, py::arg("context") = nullptr)
      .def("advance", &advance_population, py::arg("vertices"), py::kw_only(),
           py::arg("context") = nullptr,
           R"(Move to the next frame; the population is unchanged if this raises.

Args:
    vertices: (v, 3) float64, as many as the surface has, in the same order.
    context: a Context to watch and cancel it by.

Returns:
    Samples of the new frame: those that stay, then those that vanish; their fade tells how far.

Raises:
    SurfaceError: vertices of another number or not finite.
    ValueError: the surface has grown so much that more samples or ids are needed than there can be.
    Cancelled: through the context.)")
      .def_property_readonly(
          "surface", [](const Population& p) { return std::make_shared<Surface>(p.surface()); },
          "The Surface of the current frame.")
      .def_property_readonly(
          "samples", [](const Population& p) { return std::make_shared<Samples>(p.samples()); },
          "The Samples of the current frame.");
}

void bind_window(py::module_& m) {
  m.def("track_window", &window_of, py::arg("surface"), py::arg("frames"), py::arg("samples"),
        py::kw_only(), py::arg("closed") = false, py::arg("sweeps") = 2,
        py::arg("capacity_weight") = 30.0, py::arg("repulsion_weight") = 3.0,
        py::arg("tolerance") = 5e-5, py::arg("max_evaluations") = 6, py::arg("max_slide") = 0.45,
        py::arg("method") = "trust_region", py::arg("cells") = "connected",
        py::arg("stickiness") = 1.0, py::arg("pattern_strength") = 0.8,
        py::arg("longest_motion") = 0.02, py::arg("threads") = 0, py::arg("context") = nullptr,
        R"(Samples on all frames of a motion at once, smooth both ways in time.

A Tracker goes first; then sweeps go forwards and backwards over the frames and draw each sample to the middle between
where the surface carries it from the frame before and from the one after, as far as evenness allows.

Args:
    surface: the Surface of the first frame, which stays.
    frames: vertices, (v, 3) float64, of each frame after it.
    samples: Samples of the first frame, of one class.
    closed: whether the last frame leads back to the first: the loop then closes.
    sweeps: forwards and backwards, >= 0.
    stickiness: gamma >= 0, the weight of the squared distances from those middles; 1 is the weight of E_cvt.
    the others: as for Tracker.
    context: a Context to watch and cancel it by.

Returns:
    list of Samples, of the first frame and of all after it; report.slide_mean and slide_max are distances from where
    the surface carries the samples of the frame before.

Raises:
    SurfaceError: vertices of another number or not finite.
    ValueError: samples that are not of the surface, or an option out of range.
    Cancelled: through the context.)");
}

}  // namespace

void bind_tracking(py::module_& m) {
  bind_tracker(m);
  bind_population(m);
  bind_window(m);
}

}  // namespace dapple::python
