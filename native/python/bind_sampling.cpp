// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <dapple/errors.hpp>
#include <dapple/relax.hpp>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "classes.hpp"
#include "keywords.hpp"
#include "pickling.hpp"
#include "profile.hpp"
#include "to_dict.hpp"

namespace dapple::python {
namespace {

std::shared_ptr<Samples> sample_surface(const Surface& surface, Count count,
                                        const py::kwargs& keywords) {
  const Keywords given(kSample, keywords, {"locked", "context"});
  SampleOptions options = given.options();
  if (const auto locked = given.object<Samples>("locked"))
    options.locked = {locked->positions, locked->faces, locked->barycentric};
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<Samples>(sample(surface, count, options, watched));
  });
}

std::vector<std::int32_t> locked_rows(const py::object& given) {
  if (given.is_none()) return {};
  const IntArray indices = integers("locked", given, 0);
  const auto rows = as_span(indices);
  return {rows.begin(), rows.end()};
}

std::shared_ptr<Samples> resample_surface(const Surface& surface, const Samples& samples,
                                          Count count, const py::kwargs& keywords) {
  const Keywords given(kResample, keywords, {"locked", "context"});
  ResampleOptions options = given.options();
  options.locked = locked_rows(given.other("locked"));
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<Samples>(resample(surface, samples, count, options, watched));
  });
}

std::shared_ptr<Samples> relax_samples(const Surface& surface, const Samples& samples,
                                       const py::object& changed, const py::kwargs& keywords) {
  const Keywords given(kRelax, keywords, {"classes", "count", "locked", "context"});
  RelaxOptions options = given.options();
  if (const py::object count = given.other("count"); !count.is_none())
    read("count", {0.0, static_cast<double>(kMostSamples)}, count, options.count.emplace());
  options.locked = locked_rows(given.other("locked"));
  if (const py::object classes = given.other("classes"); !classes.is_none())
    options.classes = classes_on(surface, classes.cast<py::sequence>());
  const IntArray faces = integers("changed", changed, 0);
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<Samples>(relax(surface, samples, as_span(faces), options, watched));
  });
}

py::array faces_that_differ(const Surface& before, const Surface& after) {
  return give(run([&] { return changed_faces(before, after); }));
}

std::shared_ptr<Samples> make_samples(const Surface& surface, const py::object& faces,
                                      const py::object& barycentric, const py::object& ids,
                                      const py::object& classes) {
  const auto optional = [](const char* name, const py::object& value) {
    return value.is_none() ? IntArray() : integers(name, value, 0);
  };
  const IntArray held = integers("faces", faces, 0);
  const DoubleArray weights = doubles("barycentric", barycentric, 3);
  const IntArray named = optional("ids", ids), classed = optional("classes", classes);
  return run([&] {
    return std::make_shared<Samples>(
        bind_samples(surface, as_span(held), as_points(weights), as_span(named), as_span(classed)));
  });
}

py::dict report_dict(const py::object& self) {
  py::dict result = to_dict(self);
  py::list classes;
  for (const py::handle quality : self.attr("classes")) classes.append(to_dict(quality));
  result["classes"] = classes;
  return result;
}

void bind_reports(py::module_& m) {
  py::class_<Quality, std::shared_ptr<Quality>> quality(m, "Quality",
                                                        "Evenness of a set of samples.");
  def_pickle<Quality>(quality, "Quality");
  quality.def_readonly("count", &Quality::count, "Number of samples.")
      .def_readonly("spacing", &Quality::spacing,
                    "Hexagonal packing distance, in the units of the vertices.")
      .def_property_readonly(
          "alpha_min", [](const Quality& q) { return q.evenness.alpha_min; },
          "Smallest distance between neighbors / local spacing (normalized Poisson-disk radius); "
          "0 if no sample has a neighbor, or all are on thin parts.")
      .def_property_readonly(
          "alpha_mean", [](const Quality& q) { return q.evenness.alpha_mean; },
          "Mean over the samples of distance to the nearest neighbor / local spacing.")
      .def_property_readonly(
          "capacity_variation", [](const Quality& q) { return q.evenness.capacity_variation; },
          "Standard deviation / mean of the capacities.")
      .def_readonly("bond_order", &Quality::bond_order,
                    "psi6, how like a hexagonal lattice: white noise 0.36, dart throwing 0.42, "
                    "hexagons 1. Cells at borders are left out.")
      .def_readonly("energy", &Quality::energy,
                    "Normalized: n E / capacity^2 - capacity_weight; 0.16037 for perfect hexagons.")
      .def_readonly(
          "whole_count_variation", &Quality::whole_count_variation,
          "Share of the capacity variation caused by integer counts per component; 0 on one "
          "component.")
      .def_property_readonly(
          "thin_share", [](const Quality& q) { return q.evenness.thin_share; },
          "Share of the samples on parts thinner than the spacing, such as wires: neighbors are "
          "before and behind them only, so no hexagonal spacing fits, and alpha ignores them.");

  py::class_<Report, Quality, std::shared_ptr<Report>> type(
      m, "Report",
      "How the samples were made, and their quality: of all together and of each class.");
  def_pickle<Report>(type, "Report");
  type.def_property_readonly(
          "classes", [](const Report& r) { return r.classes; },
          "A list with the Quality of each class; empty if there is one class only.")
      .def_readonly("worst_overlap", &Report::worst_overlap,
                    "Of discs: 1 - distance / sum of the radii of the pair that "
                    "overlaps most; 0 if none does.")
      .def_property_readonly(
          "overlapping",
          [](const Report& r) { return py::make_tuple(r.overlapping[0], r.overlapping[1]); },
          "Indices of that pair; (-1, -1) if none overlaps.")

      .def_readonly("evaluations", &Report::evaluations, "Of the energy and its gradient.")
      .def_readonly("iterations", &Report::iterations, "Steps taken.")
      .def_readonly("parts", &Report::parts,
                    "Tracker: parts into which the frame was split because the surface moves far.")
      .def_readonly("converged", &Report::converged,
                    "False if the evaluations ran out first, or no step reached the predicted "
                    "decrease and another start might lead lower.")
      .def_readonly("seconds", &Report::seconds, "Wall time.")
      .def_property_readonly(
          "profile", [](const Report& r) { return profile_dict(r.profile); },
          "A dict of seconds by stage, which sum to `seconds`. The stages are start, "
          "neighbors, cells, solver, projection, reporting and other.")
      .def_readonly(
          "energies", &Report::energies,
          "The minimized function (energy and repulsion), normalized, at the start and after "
          "each iteration.")
      .def_readonly(
          "slide_mean", &Report::slide_mean,
          "Tracker and resample(): mean distance from the previous positions, in spacings.")
      .def_readonly("slide_median", &Report::slide_median, "The median of these distances.")
      .def_readonly("slide_max", &Report::slide_max, "The largest such distance.")
      .def_readonly("births", &Report::births,
                    "Population: how many samples appear from this frame on.")
      .def_readonly("deaths", &Report::deaths,
                    "Population: how many samples vanish from this frame on.")
      .def("to_dict", &report_dict, "All of it as a dict that json can write.");
}

py::object fades(const py::object& self) {
  const auto& samples = self.cast<const Samples&>();
  if (!samples.fade.empty()) return view(self, samples.fade);
  py::array_t<double> ones(static_cast<py::ssize_t>(samples.size()));
  std::fill_n(ones.mutable_data(), samples.size(), 1.0);
  return ones;
}

void bind_samples(py::module_& m) {
  py::class_<Samples, std::shared_ptr<Samples>> type(
      m, "Samples", R"(Samples on a surface; all arrays are read-only views.

Made by sample() and Tracker.advance(), or from stored bindings:

Args:
    surface: the Surface they lie on.
    faces: (n,) int32, indices into its faces.
    barycentric: (n, 3) float64 >= 0 with rows that sum to 1 within 1e-4 (they are normalized).
    ids: (n,) int32, unique; None counts up from 0.
    classes: (n,) int32; None is 0 for all.

Raises:
    ValueError: naming the first entry out of range, not finite, negative, or the row that does not sum to 1.)");
  def_pickle<Samples>(type, "Samples");
  type.def(py::init(&make_samples), py::arg("surface"), py::arg("faces"), py::arg("barycentric"),
           py::kw_only(), py::arg("ids") = py::none(), py::arg("classes") = py::none())
      .def("__len__", &Samples::size)
      .def_property_readonly("positions", array_property(&Samples::positions),
                             "(n, 3) float64, on the surface.")
      .def_property_readonly(
          "normals", array_property(&Samples::normals),
          "(n, 3) float64, unit, as the surface is shaded there; see Surface.corner_normals.")
      .def_property_readonly("faces", array_property(&Samples::faces),
                             "(n,) int32, indices into the surface's faces.")
      .def_property_readonly("barycentric", array_property(&Samples::barycentric),
                             "(n, 3) float64, >= 0, sum 1.")
      .def_property_readonly("ids", array_property(&Samples::ids),
                             "(n,) int32, unique; trackers keep them.")
      .def_property_readonly("classes", array_property(&Samples::classes), "(n,) int32.")
      .def_property_readonly(
          "fade", [](const py::object& self) { return fades(self); },
          "(n,) float64 in 0..1, how far each has appeared; 1 for all but those of a Population.")
      .def_readonly("report", &Samples::report, "A Report.");
}

void bind_samplers(py::module_& m) {
  def_verb(
      m, kSample, &sample_surface,
      R"(sample(surface: Surface, count: int, *, {signature}, locked: Samples | None = None, context: Context | None = None) -> Samples

Exactly count samples of a surface: evenly spaced, unpatterned, following its density.

Minimizes the centroidal Voronoi energy plus capacity_weight times the capacity energy (Chen et al. 2012, Algorithm 2)
plus a repulsion between neighbors, by preconditioned L-BFGS within a trust region. sample(..., **dapple.PAPER) is the
paper's own way. The same arguments give the same bytes, whatever the number of threads.

Args:
    surface: a Surface.
    count: number of samples, 0..100000000.
    {options}
    locked: Samples of the surface that stay where they are and take part, or None; they come first, and count includes them.
    context: a Context for progress and cancel.

Returns:
    Samples, with a report.

Raises:
    ValueError: an option out of range.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("count"));

  def_verb(
      m, kResample, &resample_surface,
      R"(resample(surface: Surface, samples: Samples, count: int, *, {signature}, locked: ArrayLike | None = None, context: Context | None = None) -> Samples

Another count or density for samples that are there, most of which stay nearly where they are.

Each neighborhood first gets the number that its share of the density asks for: samples are taken out far from each
other, or put into the widest gaps. Then all are made as even as they were.

Args:
    surface: a Surface of the same faces; its density and vertices may be others.
    samples: Samples of one class, which new ones get too. Samples of several classes all become those of class 0:
        relax() is for them.
    count: number of samples wanted, 0..100000000; it includes the locked ones.
    {options}
    locked: (k,) indices of samples that stay where they are, or None; new ones may come between them.
    context: a Context for progress and cancel.

Returns:
    Samples: those that stay first, in their order and with their ids; new ids follow the largest. Their report's
    slide_mean, slide_median and slide_max tell how far they moved, in spacings.

Raises:
    ValueError: samples that are not of the surface, an index or an option out of range, or more locked samples than the
        count.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("samples"), py::arg("count"));

  def_verb(
      m, kRelax, &relax_samples,
      R"(relax(surface: Surface, samples: Samples, changed: ArrayLike, *, {signature}, classes: Sequence[SampleClass | int] | None = None, count: int | None = None, locked: ArrayLike | None = None, context: Context | None = None) -> Samples

Make samples even again where something has changed: the density, some vertices, what is blocked.

Only the samples whose cells have a part of the changed faces and two rings of neighbors around them may move, go or get
others beside them; all others keep every byte. Where samples at the border of that region are left with too much or too
little, it grows. The time follows the size of the change, not that of the surface.

Args:
    surface: the Surface as it is now, of the same faces.
    samples: Samples of one class, or of those that `classes` lists; where vertices have moved, their faces carry them.
    changed: (m,) indices of the faces where something has changed, such as changed_faces(before, surface); none: nothing moves.
    {options}
    classes: what each class is to be, as for sample_classes(); its count is the number of samples wanted of it, unless
        free_counts. Rare classes are relaxed first, the others around them. None: samples are of one class.
    count: number of samples wanted of one class: the difference comes and goes where something has changed. None:
        chosen so that new samples match their neighbors' capacity.
    locked: (k,) indices of samples that stay where they are, or None; new ones may come between them.
    context: a Context for progress and cancel.

Returns:
    Samples: those that stay first, in their order and with their ids; new ids follow the largest. Their report measures
    those that were free to move and those beside them; its count and spacing are of all. With several classes it measures
    each class by itself, and not all together: alpha, energy and the like of the whole are 0, as are those of a class that
    was left alone.

Raises:
    ValueError: samples that are not of the surface or of a class that is not listed, an index or an option out of range,
        or a count that the region cannot reach.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("samples"), py::arg("changed"));
  m.def("changed_faces", &faces_that_differ, py::arg("before"), py::arg("after"),
        R"(The faces whose corners or densities differ between two surfaces of the same faces.

Args:
    before: a Surface.
    after: one that Surface.deformed() or Surface.with_density() made of it, or of what it was made of.

Returns:
    (m,) int32, in increasing order.

Raises:
    ValueError: surfaces of other faces.)");
}

}  // namespace

void bind_sampling(py::module_& m) {
  bind_reports(m);
  bind_samples(m);
  bind_samplers(m);
}

}  // namespace dapple::python
