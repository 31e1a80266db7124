// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <algorithm>
#include <dapple/crowding.hpp>
#include <dapple/neighbors.hpp>
#include <dapple/progressive.hpp>
#include <dapple/projector.hpp>
#include <dapple/spectrum.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(RadialStatistics& r) { return std::tie(r.radius, r.mean, r.anisotropy); }
inline auto members(Spectrum& s) {
  return std::tie(s.runs, s.half_width, s.periodogram, s.radial, s.frequency_unit);
}
inline auto members(SurfaceSpectrum& s) {
  return std::tie(s.runs, s.centers, s.radius, s.bins, s.differentials, s.radial_differentials,
                  s.half_width, s.power, s.radial_power, s.frequency_step);
}

inline void check_square(const std::vector<double>& values) {
  const auto side = static_cast<std::size_t>(std::lround(std::sqrt(values.size())));
  python::check_equal(values.size(), side * side);
}
inline void check_members(const Spectrum& s) { check_square(s.periodogram); }
inline void check_members(const SurfaceSpectrum& s) {
  check_square(s.differentials);
  check_square(s.power);
}

}  // namespace dapple

namespace dapple::python {
namespace {

// Shares of the progress if points are given instead of samples: of the whole when they are bound,
// and of the binding when the projector is created.
constexpr double kBound = 0.6, kTreeBuilt = 0.8;

/// Convert one set of points or a sequence of several; `is_one` says which it is.
template <typename Convert>
auto each_run(const py::object& runs, bool is_one, const Convert& convert) {
  std::vector<decltype(convert("", runs))> result;
  if (is_one || !py::isinstance<py::sequence>(runs)) {
    result.push_back(convert("runs", runs));
    return result;
  }
  for (const py::handle run : runs) {
    const std::string name = "runs[" + std::to_string(result.size()) + "]";
    result.push_back(convert(name.c_str(), py::reinterpret_borrow<py::object>(run)));
  }
  return result;
}

/// Whether a sequence contains rows of coordinates, not sets of rows.
bool holds_rows(const py::object& runs) {
  if (py::isinstance<py::array>(runs)) return runs.cast<py::array>().ndim() != 3;
  if (!py::isinstance<py::sequence>(runs) || py::len(runs) == 0) return false;
  const py::array first = py::array::ensure(runs[py::int_(0)]);
  return first && first.ndim() == 1;
}

std::vector<Vec2> plane_points(const char* name, const py::object& value) {
  const DoubleArray array = doubles(name, value, 2);
  std::vector<Vec2> points;
  for (py::ssize_t k = 0; k < array.shape(0); ++k)
    points.emplace_back(array.at(k, 0), array.at(k, 1));
  return points;
}

std::shared_ptr<Spectrum> plane_spectrum(const py::object& runs,
                                         Whole<int, "half_width", 0, 8192> half_width,
                                         Threads threads, const ContextPtr& context) {
  const auto sets = each_run(runs, holds_rows(runs), plane_points);
  const std::vector<std::span<const Vec2>> spans(sets.begin(), sets.end());
  const SpectrumOptions options{half_width, threads};
  return run(context, [&](Context* watched) {
    return std::make_shared<Spectrum>(spectrum(spans, options, watched));
  });
}

py::array ranks_of(const py::object& points, const py::object& classes, const ContextPtr& context) {
  const DoubleArray places = doubles("points", points, 3);
  const IntArray own = classes.is_none() ? IntArray(0) : integers("classes", classes, 0);
  return give(run(context, [&](Context* watched) {
    return progressive_ranks(as_points(places), as_span(own), watched);
  }));
}

py::array distances_of(const py::object& points) {
  const DoubleArray places = doubles("points", points, 3);
  return give(run([&] { return nearest_distances(as_points(places)); }));
}

py::array away_of(const py::object& points) {
  const DoubleArray places = doubles("points", points, 3);
  return give(run([&] { return away_from_neighbors(as_points(places)); }));
}

using SamplesPtr = std::shared_ptr<Samples>;

/// Samples, or points that are bound at the nearest points of the surface.
struct SamplesArgument {
  SamplesPtr samples;
  DoubleArray points;
};

SamplesArgument samples_of(const char* name, const py::object& value) {
  if (py::isinstance<Samples>(value)) return {value.cast<SamplesPtr>(), {}};
  return {nullptr, doubles(name, value, 3)};
}

SamplesPtr bound(const Surface& surface, const SamplesArgument& given, Context* context) {
  if (given.samples) return given.samples;
  const Projector projector(surface, false, context);
  context->advance(kTreeBuilt);
  const Projection near = projector.project(as_points(given.points), {}, context);
  return std::make_shared<Samples>(bind_samples(surface, near.faces, near.barycentric));
}

std::shared_ptr<Report> analyze_samples(const Surface& surface, const py::object& samples,
                                        const py::kwargs& keywords) {
  const Keywords given(kAnalyze, keywords);
  const SampleOptions options = given.options();
  const SamplesArgument argument = samples_of("samples", samples);
  return run(given.context(), [&](Context* watched) {
    const double share = argument.samples ? 0.0 : kBound;
    Context binding(*watched, 0.0, share), analyzing(*watched, share, 1.0);
    const SamplesPtr own = bound(surface, argument, &binding);
    return std::make_shared<Report>(
        analyze(surface, *own, options.optimizer.capacity_weight, options.cells, &analyzing));
  });
}

std::shared_ptr<SurfaceSpectrum> differential_spectrum(const Surface& surface,
                                                       const py::object& runs, double radius,
                                                       Whole<int, "bins", 2, 4096> bins,
                                                       Threads threads, const ContextPtr& context) {
  const bool is_one = py::isinstance<Samples>(runs) || holds_rows(runs);
  const std::vector<SamplesArgument> sets = each_run(runs, is_one, samples_of);
  const SurfaceSpectrumOptions options{radius, bins, threads};
  return run(context, [&](Context* watched) {
    Context binding(*watched, 0.0, 0.0);  // no share of the progress, because samples are usual
    std::vector<SamplesPtr> own;
    std::vector<const Samples*> pointers;
    pointers.reserve(sets.size());
    for (const SamplesArgument& set : sets)
      pointers.push_back(own.emplace_back(bound(surface, set, &binding)).get());
    return std::make_shared<SurfaceSpectrum>(surface_spectrum(surface, pointers, options, watched));
  });
}

/// A square array that is a view of the object's values.
template <typename Class>
auto square_property(std::vector<double> Class::*member) {
  return [member](const py::object& self) {
    const std::vector<double>& values = self.cast<const Class&>().*member;
    const auto side = static_cast<py::ssize_t>(std::lround(std::sqrt(values.size())));
    return view(self, values.data(), {side, side});
  };
}

void bind_spectra(py::module_& m) {
  py::class_<RadialStatistics, std::shared_ptr<RadialStatistics>> radial(
      m, "RadialStatistics", "What a quantity over the plane is like at each distance.");
  def_pickle<RadialStatistics>(radial, "RadialStatistics");
  radial
      .def_property_readonly("radius", array_property(&RadialStatistics::radius),
                             "(k,) float64: middle of each annulus.")
      .def_property_readonly("mean", array_property(&RadialStatistics::mean),
                             "(k,) float64: mean over the annulus.")
      .def_property_readonly("anisotropy", array_property(&RadialStatistics::anisotropy),
                             "(k,) float64: variance / mean^2 over the annulus, in decibels; -inf "
                             "where nothing varies.");

  py::class_<Spectrum, std::shared_ptr<Spectrum>> flat(
      m, "Spectrum", "The spectrum of point sets on the unit torus or square.");
  def_pickle<Spectrum>(flat, "Spectrum");
  flat.def_readonly("runs", &Spectrum::runs, "Number of point sets.")
      .def_readonly("half_width", &Spectrum::half_width, "Largest frequency on either axis.")
      .def_property_readonly("periodogram", square_property(&Spectrum::periodogram),
                             "(2 half_width + 1, 2 half_width + 1) float64: mean power at [f_y, "
                             "f_x], 1 for white noise; the middle is f = 0.")
      .def_readonly("radial", &Spectrum::radial,
                    "RadialStatistics of the power; white noise has the mean 1 and the anisotropy "
                    "-10 log10(runs).")
      .def_readonly("frequency_unit", &Spectrum::frequency_unit,
                    "sqrt(n): spectra of different n agree in frequency / frequency_unit.");

  py::class_<SurfaceSpectrum, std::shared_ptr<SurfaceSpectrum>> curved(
      m, "SurfaceSpectrum", "The spectrum of samples on a surface, from their differentials.");
  def_pickle<SurfaceSpectrum>(curved, "SurfaceSpectrum");
  curved.def_readonly("runs", &SurfaceSpectrum::runs, "Number of sets of samples.")
      .def_readonly("centers", &SurfaceSpectrum::centers,
                    "Samples farther than the radius from any border, over all runs.")
      .def_readonly("radius", &SurfaceSpectrum::radius, "Of the neighborhood, in spacings.")
      .def_readonly("bins", &SurfaceSpectrum::bins, "Of the differentials on either axis.")
      .def_property_readonly("differentials", square_property(&SurfaceSpectrum::differentials),
                             "(bins, bins) float64 over [-radius, radius]^2, [y, x]: "
                             "differentials found / expected of white noise; nan beyond the "
                             "radius.")
      .def_readonly("radial_differentials", &SurfaceSpectrum::radial_differentials,
                    "RadialStatistics of the differentials, in spacings.")
      .def_readonly("half_width", &SurfaceSpectrum::half_width, "Of the power, in steps.")
      .def_property_readonly("power", square_property(&SurfaceSpectrum::power),
                             "(2 half_width + 1, 2 half_width + 1) float64: power at [f_y, f_x], "
                             "1 for white noise.")
      .def_readonly("radial_power", &SurfaceSpectrum::radial_power,
                    "RadialStatistics of the power, in sqrt(n / area).")
      .def_readonly("frequency_step", &SurfaceSpectrum::frequency_step, "In sqrt(n / area).");
}

}  // namespace

void bind_analysis(py::module_& m) {
  bind_spectra(m);
  def_verb(
      m, kAnalyze, &analyze_samples,
      R"(analyze(surface: Surface, samples: Samples | numpy.ndarray, *, {signature}, context: Context | None = None) -> Report

Measure samples of any origin: evenness, pattern and energy.

Args:
    surface: the Surface they lie on.
    samples: Samples, or (n, 3) float64 points, which are bound to the nearest points of the surface.
    {options}
    context: a Context for progress and cancel.

Returns:
    Report; fields about the optimization keep their defaults.

Raises:
    ValueError: naming the first point that is not finite, face out of range or cell that reaches so
        far that the energy is not finite.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("samples"));
  m.def("away_from_neighbors", &away_of, py::arg("points"),
        R"(Where points have no neighbors, such as for plants that lean to the light.

For each point the mean of the unit vectors that lead away from its neighbors, with the weights
(1 - distance / reach)^2. Its reach is three times the distance to the nearest other point;
neighbors are those of the 24 nearest that are within it. Weights count as at least 1 in all, so
that one neighbor counts less than many.

Args:
    points: (n, 3) float64.

Returns:
    (n, 3) float64: short among even points, about 0.5 long at a straight border, never longer than
    1; 0 for a point that lies on another one, or has no other.

Raises:
    ValueError: naming the first point that is not finite.)");
  m.def("nearest_distances", &distances_of, py::arg("points"),
        R"(Distance of each point to the nearest other one, in a straight line.

Args:
    points: (n, 3) float64.

Returns:
    (n,) float64 in the units of the points; infinite where there is no other point.

Raises:
    ValueError: naming the first point that is not finite.)");
  m.def(
      "progressive_ranks", &ranks_of, py::arg("points"), py::arg("classes") = py::none(),
      py::kw_only(), py::arg("context") = ContextPtr(),
      R"(An order of points of which every beginning is evenly spread, for showing a share of them.

The points whose rank is below m are spread as evenly as m of them can be, for every m; a density is kept. With classes,
each is even by itself too and keeps its share. Weighted sample elimination (Yuksel 2015) over points and classes.

Args:
    points: (n, 3) float64.
    classes: (n,) integers >= 0, or None for a single class.
    context: a Context for progress and cancel.

Returns:
    (n,) int32, the rank of each point in 0..n-1.

Raises:
    ValueError: naming the first point that is not finite or class below 0.
    Cancelled: through the context.)");
  m.def("spectrum", &plane_spectrum, py::arg("runs"), py::kw_only(), py::arg("half_width") = 0,
        py::arg("threads") = 0, py::arg("context") = ContextPtr(),
        R"(Power spectrum of points on the unit torus or square, averaged over runs, by direct sums.

Schloemer and Deussen, Accurate Spectral Analysis of Two-Dimensional Point Sets, 2011.

Args:
    runs: (n, 2) float64 in [0, 1], or a sequence of such arrays.
    half_width: largest frequency on either axis; 0 is 3 sqrt(n).
    threads: 0 uses all processors; the result has the same bytes for any number.
    context: a Context for progress and cancel.

Returns:
    Spectrum.

Raises:
    ValueError: naming the first run without points, or point that is not finite or outside.
    Cancelled: through the context.)");
  m.def("surface_spectrum", &differential_spectrum, py::arg("surface"), py::arg("runs"),
        py::kw_only(), py::arg("radius") = 5.0, py::arg("bins") = 128, py::arg("threads") = 0,
        py::arg("context") = ContextPtr(),
        R"(Spectrum of samples on a surface from the differentials between them, averaged over runs.

Wei and Wang, Differential Domain Analysis for Non-Uniform Sampling, 2011, with the approximate
geodesic distance of Bowers et al., Parallel Poisson Disk Sampling with Spectrum Analysis on
Surfaces, 2010. Samples nearer to a border than the radius are no centers of differentials.

Args:
    surface: a Surface.
    runs: Samples or (n, 3) float64 points on it, or a sequence of such.
    radius: radius of the analyzed neighborhood, in (local) spacings.
    bins: number of bins on either axis; even.
    threads: 0 uses all processors; the result has the same bytes for any number.
    context: a Context for progress and cancel.

Returns:
    SurfaceSpectrum.

Raises:
    ValueError: naming the first run with fewer than two samples, point that is not finite or option
        out of range; or no sample is farther than the radius from the border.
    Cancelled: through the context.)");
}

}  // namespace dapple::python
