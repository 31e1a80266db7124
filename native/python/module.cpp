// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/mesh_file.hpp>
#include <dapple/projector.hpp>
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>
#include <dapple/tracker.hpp>
#include <optional>

#include "arrays.hpp"

namespace dapple::python {
namespace {

using ContextPtr = std::shared_ptr<Context>;

/// A property that shows an array of the object without copying it.
template <typename Class, typename Member>
auto array_property(Member Class::*member) {
  return [member](const py::object& self) { return view(self, self.cast<const Class&>().*member); };
}

std::shared_ptr<Surface> make_surface(const py::object& vertices, const py::object& faces,
                                      const py::object& density) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const IntArray triangles = integers("faces", faces, 3);
  const DoubleArray values = density.is_none() ? DoubleArray() : doubles("density", density, 0);
  if (!density.is_none() && values.size() == 0)
    throw SurfaceError("density has 0 values for " + std::to_string(points.shape(0)) +
                       " vertices: one per vertex is needed");
  const py::gil_scoped_release released;
  return std::make_shared<Surface>(as_points(points), as_faces(triangles), as_span(values));
}

py::object density_of(const Surface& surface) {
  return surface.uniform() ? py::object(py::none()) : py::object(give(surface.density()));
}

Method method_named(const std::string& name) {
  if (name == "trust_region") return Method::kTrustRegion;
  if (name == "line_search") return Method::kLineSearch;
  throw ArgumentError("method is '" + name + "': it must be 'trust_region' or 'line_search'");
}

OptimizerOptions optimizer_options(double capacity_weight, double gap_weight, double tolerance,
                                   int max_evaluations, const std::string& method) {
  OptimizerOptions options;
  options.method = method_named(method);
  options.capacity_weight = capacity_weight;
  options.gap_weight = gap_weight;
  options.tolerance = tolerance;
  options.max_evaluations = max_evaluations;
  return options;
}

Start start_named(const std::string& name) {
  if (name == "poisson") return Start::kPoisson;
  if (name == "random") return Start::kRandom;
  throw ArgumentError("start is '" + name + "': it must be 'poisson' or 'random'");
}

std::size_t checked_count(std::int64_t count) {
  if (count < 0 || count > std::numeric_limits<std::int32_t>::max())
    throw ArgumentError("count is " + std::to_string(count) + ": it must be in 0..2147483647");
  return static_cast<std::size_t>(count);
}

std::shared_ptr<Samples> sample_surface(const Surface& surface, std::int64_t count,
                                        std::uint64_t seed, double capacity_weight,
                                        double gap_weight, double tolerance, int max_evaluations,
                                        const std::string& method, const std::string& start,
                                        int threads, const ContextPtr& context) {
  SampleOptions options;
  options.seed = seed;
  options.start = start_named(start);
  options.optimizer =
      optimizer_options(capacity_weight, gap_weight, tolerance, max_evaluations, method);
  options.threads = threads;
  const std::size_t checked = checked_count(count);
  const py::gil_scoped_release released;
  return std::make_shared<Samples>(sample(surface, checked, options, context.get()));
}

std::shared_ptr<Samples> make_samples(const Surface& surface, const py::object& faces,
                                      const py::object& barycentric, const py::object& ids,
                                      const py::object& classes) {
  const auto optional = [](const char* name, const py::object& value) {
    return value.is_none() ? IntArray() : integers(name, value, 0);
  };
  return std::make_shared<Samples>(bind_samples(surface, as_span(integers("faces", faces, 0)),
                                                as_points(doubles("barycentric", barycentric, 3)),
                                                as_span(optional("ids", ids)),
                                                as_span(optional("classes", classes))));
}

std::shared_ptr<Tracker> make_tracker(const Surface& surface, const Samples& samples,
                                      double capacity_weight, double gap_weight, double tolerance,
                                      int max_evaluations, double max_slide,
                                      const std::string& method, int threads) {
  TrackerOptions options{
      optimizer_options(capacity_weight, gap_weight, tolerance, max_evaluations, method), threads};
  options.optimizer.max_slide = max_slide;
  const py::gil_scoped_release released;
  return std::make_shared<Tracker>(surface, samples, options);
}

std::shared_ptr<Samples> advance_tracker(Tracker& tracker, const py::object& vertices,
                                         const ContextPtr& context) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const py::gil_scoped_release released;
  return std::make_shared<Samples>(tracker.advance(as_points(points), context.get()));
}

std::shared_ptr<Energy> energy_at(const Surface& surface, const py::object& positions,
                                  const py::object& faces, double capacity_weight) {
  const DoubleArray points = doubles("positions", positions, 3);
  const IntArray held = integers("faces", faces, 0);
  const auto p = as_points(points);
  const auto f = as_span(held);
  const py::gil_scoped_release released;
  return std::make_shared<Energy>(
      evaluate_energy(surface, Sites{{p.begin(), p.end()}, {f.begin(), f.end()}}, capacity_weight));
}

/// One number of every cell.
template <typename Member>
auto cell_property(Member Moments::*member) {
  return [member](const Energy& energy) {
    std::vector<double> values;
    for (const Moments& cell : energy.diagram.cells) values.push_back(cell.*member);
    return give(std::move(values));
  };
}

std::shared_ptr<Projection> project_points(const Surface& surface, const py::object& points) {
  const DoubleArray array = doubles("points", points, 3);
  const py::gil_scoped_release released;
  return std::make_shared<Projection>(Projector(surface).project(as_points(array)));
}

py::tuple read_mesh_arrays(const std::filesystem::path& path) {
  MeshArrays mesh;
  {
    const py::gil_scoped_release released;
    mesh = read_mesh(path);
  }
  return py::make_tuple(give(std::move(mesh.vertices)), give(std::move(mesh.faces)));
}

void write_mesh_arrays(const std::filesystem::path& path, const py::object& vertices,
                       const py::object& faces) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const IntArray triangles = integers("faces", faces, 3);
  const Surface checked(as_points(points), as_faces(triangles));
  const py::gil_scoped_release released;
  write_mesh(path, as_points(points), as_faces(triangles));
}

py::dict report_dict(const Report& report) {
  using namespace py::literals;
  return py::dict("count"_a = report.count, "spacing"_a = report.spacing,
                  "alpha_min"_a = report.evenness.alpha_min,
                  "alpha_mean"_a = report.evenness.alpha_mean,
                  "capacity_spread"_a = report.evenness.capacity_spread, "energy"_a = report.energy,
                  "evaluations"_a = report.evaluations, "iterations"_a = report.iterations,
                  "converged"_a = report.converged, "seconds"_a = report.seconds,
                  "energies"_a = report.energies, "slide_mean"_a = report.slide_mean,
                  "slide_max"_a = report.slide_max);
}

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
      .def("cancel", &Context::cancel, "Ask the work to stop; it then raises Cancelled.")
      .def_property_readonly("cancelled", &Context::cancelled, "Whether cancel() was called.")
      .def_property_readonly("progress", &Context::progress,
                             "Share of the work done, in [0, 1]; it never falls.");
}

void bind_surface(py::module_& m) {
  py::class_<Topology>(m, "Topology",
                       "How the faces of a surface hang together (through OpenMesh).")
      .def_readonly("components", &Topology::components, "Sets of faces connected over edges.")
      .def_readonly("border_edges", &Topology::border_edges, "Edges with one face.")
      .def_readonly("border_loops", &Topology::border_loops,
                    "Closed chains of border edges; -1 if not manifold.")
      .def_readonly("nonmanifold_edges", &Topology::nonmanifold_edges,
                    "Edges with three or more faces.")
      .def_readonly("manifold", &Topology::manifold,
                    "Whether every edge and vertex has a disc or half-disc around it.")
      .def_readonly("closed", &Topology::closed, "Whether it is manifold without border.")
      .def_readonly("genus", &Topology::genus,
                    "Handles, summed over the components; -1 if not manifold.");

  py::class_<Surface, std::shared_ptr<Surface>>(m, "Surface",
                                                R"(Immutable, checked triangles with a density.

Args:
    vertices: (v, 3) float64, positions in any unit.
    faces: (m, 3) int32, vertex indices; degenerate, repeated and non-manifold faces are allowed.
    density: (v,) float64 >= 0, linear on each face; None means 1 everywhere.

Raises:
    SurfaceError: naming the first offender: an index out of range, a number that is not finite, a negative density,
        a density of another length, or no area (or no density) at all.
    ValueError: an array of another shape or dtype.)")
      .def(py::init(&make_surface), py::arg("vertices"), py::arg("faces"),
           py::arg("density") = py::none())
      .def_property_readonly(
          "vertices", [](const Surface& s) { return give(s.vertices()); },
          "(v, 3) float64, a read-only copy.")
      .def_property_readonly(
          "faces", [](const Surface& s) { return give(s.faces()); },
          "(m, 3) int32, a read-only copy.")
      .def_property_readonly("density", &density_of,
                             "(v,) float64, a read-only copy, or None if 1 everywhere.")
      .def_property_readonly("area", &Surface::area, "In squared units of the vertices.")
      .def_property_readonly("mass", &Surface::mass, "Integral of the density over the surface.")
      .def_property_readonly("topology", &topology, "A Topology, measured anew at each call.")
      .def(
          "spacing",
          [](const Surface& s, std::int64_t count) { return s.spacing(checked_count(count)); },
          py::arg("count"),
          "Distance between neighbours if count points were packed hexagonally: "
          "sqrt(2 area / (sqrt(3) count)), in the units of the vertices.")
      .def(
          "deformed",
          [](const Surface& s, const py::object& vertices) {
            const DoubleArray points = doubles("vertices", vertices, 3);
            const py::gil_scoped_release released;
            return std::make_shared<Surface>(s.deformed(as_points(points)));
          },
          py::arg("vertices"),
          "The same faces and density over moved vertices, (v, 3) float64. Raises SurfaceError.");
}

void bind_samples_classes(py::module_& m) {
  py::class_<Report>(m, "Report", "What was done to get the samples, and how good they are.")
      .def_readonly("count", &Report::count, "Number of samples.")
      .def_readonly("spacing", &Report::spacing,
                    "Hexagonal packing distance, in the units of the vertices.")
      .def_property_readonly(
          "alpha_min", [](const Report& r) { return r.evenness.alpha_min; },
          "Smallest distance between neighbours / local spacing (normalised Poisson-disk radius).")
      .def_property_readonly(
          "alpha_mean", [](const Report& r) { return r.evenness.alpha_mean; },
          "Mean over the samples of distance to the nearest neighbour / local spacing.")
      .def_property_readonly(
          "capacity_spread", [](const Report& r) { return r.evenness.capacity_spread; },
          "Standard deviation / mean of the capacities.")
      .def_readonly("energy", &Report::energy,
                    "Normalised: n E / mass^2 - capacity_weight; 0.16037 for perfect hexagons.")
      .def_readonly("evaluations", &Report::evaluations, "Of the energy and its gradient.")
      .def_readonly("iterations", &Report::iterations, "Steps taken.")
      .def_readonly("converged", &Report::converged, "False if the evaluations ran out first.")
      .def_readonly("seconds", &Report::seconds, "Wall time.")
      .def_readonly(
          "energies", &Report::energies,
          "What was minimised (energy and gap), normalised, at the start and after each iteration.")
      .def_readonly("slide_mean", &Report::slide_mean,
                    "Tracker: mean distance from the carried position, in spacings.")
      .def_readonly("slide_max", &Report::slide_max, "Tracker: the largest such distance.")
      .def("to_dict", &report_dict, "All of it as a dict that json can write.");

  py::class_<Samples, std::shared_ptr<Samples>>(
      m, "Samples", R"(Samples on a surface; all arrays are read-only views.

Made by sample() and Tracker.advance(), or from stored bindings:

Args:
    surface: the Surface they lie on.
    faces: (n,) int32, indices into its faces.
    barycentric: (n, 3) float64 >= 0 with rows that sum to 1 within 1e-4 (they are normalised).
    ids: (n,) int32, unique; None counts up from 0.
    classes: (n,) int32; None is 0 for all.

Raises:
    ValueError: naming the first entry out of range, not finite, negative, or the row that does not sum to 1.)")
      .def(py::init(&make_samples), py::arg("surface"), py::arg("faces"), py::arg("barycentric"),
           py::kw_only(), py::arg("ids") = py::none(), py::arg("classes") = py::none())
      .def("__len__", &Samples::size)
      .def_property_readonly("positions", array_property(&Samples::positions),
                             "(n, 3) float64, on the surface.")
      .def_property_readonly(
          "normals", array_property(&Samples::normals),
          "(n, 3) float64, unit, interpolated from angle-weighted vertex normals.")
      .def_property_readonly("faces", array_property(&Samples::faces),
                             "(n,) int32, indices into the surface's faces.")
      .def_property_readonly("barycentric", array_property(&Samples::barycentric),
                             "(n, 3) float64, >= 0, sum 1.")
      .def_property_readonly("ids", array_property(&Samples::ids),
                             "(n,) int32, unique; trackers keep them.")
      .def_property_readonly("classes", array_property(&Samples::classes), "(n,) int32.")
      .def_readonly("report", &Samples::report, "A Report.");
}

void bind_energy(py::module_& m) {
  py::class_<Energy, std::shared_ptr<Energy>>(m, "Energy",
                                              "The energy at given sites and its gradient.")
      .def_readonly("total", &Energy::total, "cvt + capacity_weight * capacity_term.")
      .def_readonly("cvt", &Energy::cvt,
                    "Sum of the integrals of density^2 |x - site|^2 over the cells.")
      .def_readonly("capacity_term", &Energy::capacity_term, "Sum of the squared capacities.")
      .def_readonly("normalised", &Energy::normalised,
                    "n E / mass^2 - capacity_weight; 0.16037 for perfect hexagons.")
      .def_property_readonly("capacities", cell_property(&Moments::capacity),
                             "(n,) float64: integral of the density over each cell.")
      .def_property_readonly("masses", cell_property(&Moments::mass),
                             "(n,) float64: integral of the squared density over each cell.")
      .def_property_readonly("areas", cell_property(&Moments::area),
                             "(n,) float64: area of each cell.")
      .def_property_readonly("gradient", array_property(&Energy::gradient),
                             "(n, 3) float64: dE/dx in space, not yet tangential.");

  m.def("energy", &energy_at, py::arg("surface"), py::arg("positions"), py::arg("faces"),
        py::kw_only(), py::arg("capacity_weight") = 30.0,
        R"(Evaluate the energy and its gradient over the restricted Voronoi diagram.

E = sum of the integrals of density^2 |x - x_i|^2 + capacity_weight * sum of the squared capacities
(Chen et al. 2012, equation 6 and Theorem 2, with rho = density^2).

Args:
    surface: a Surface.
    positions: (n, 3) float64, on the surface.
    faces: (n,) int32, the faces that hold them.
    capacity_weight: lambda >= 0; the paper finds 20..100 useful.

Returns:
    Energy.

Raises:
    ValueError: naming the first position that is not finite or face out of range.)");
}

void bind_projection(py::module_& m) {
  py::class_<Projection, std::shared_ptr<Projection>>(m, "Projection",
                                                      "Closest points of a surface.")
      .def_property_readonly("positions", array_property(&Projection::positions), "(n, 3) float64.")
      .def_property_readonly("faces", array_property(&Projection::faces),
                             "(n,) int32; the lowest index at ties.")
      .def_property_readonly("barycentric", array_property(&Projection::barycentric),
                             "(n, 3) float64, >= 0, sum 1.")
      .def_property_readonly("distances", array_property(&Projection::distances),
                             "(n,) float64, in the units of the vertices.");
  m.def("project", &project_points, py::arg("surface"), py::arg("points"),
        R"(Closest point of the surface for each point, in double precision (through Embree).

Args:
    surface: a Surface.
    points: (n, 3) float64.

Returns:
    Projection.

Raises:
    ValueError: naming the first point that is not finite.)");
}

void bind_sampling(py::module_& m) {
  m.def("sample", &sample_surface, py::arg("surface"), py::arg("count"), py::kw_only(),
        py::arg("seed") = 0, py::arg("capacity_weight") = 30.0, py::arg("gap_weight") = 1.0,
        py::arg("tolerance") = 1e-5, py::arg("max_evaluations") = 200,
        py::arg("method") = "trust_region", py::arg("start") = "poisson", py::arg("threads") = 0,
        py::arg("context") = nullptr,
        R"(Exactly count samples of a surface: evenly spaced, unpatterned, following its density.

Minimises the centroidal Voronoi energy plus capacity_weight times the capacity energy (Chen et al. 2012, Algorithm 2)
plus a soft gap between neighbours, by preconditioned L-BFGS within a trust region. sample(..., **dapple.PAPER) is the
paper's own way. The same arguments give the same bytes, whatever the number of threads.

Args:
    surface: a Surface.
    count: number of samples, >= 0.
    seed: of the start, 0..2**64 - 1.
    capacity_weight: lambda >= 0; larger is less regular. The paper finds 20..100 useful.
    gap_weight: kappa >= 0; keeps neighbours apart. 0 is the paper's plain energy.
    tolerance: relative decrease of the energy at which to stop, >= 0; smaller is more regular.
    max_evaluations: of the energy, >= 1.
    method: 'trust_region', or 'line_search' (plain L-BFGS, as in the paper).
    start: 'poisson' (Poisson-disk set) or 'random' (white noise, as in the paper).
    threads: 0 for as many as the machine has.
    context: a Context to watch and cancel it by.

Returns:
    Samples, with a report.

Raises:
    ValueError: an option out of range.
    Cancelled: through the context.)");

  py::class_<Tracker, std::shared_ptr<Tracker>>(m, "Tracker",
                                                R"(Carries samples over a deforming surface.

They ride the moved vertices by their barycentric coordinates and are then re-optimised until they are as even as in
the first frame; index and id of each stay (Chen et al. 2012, section 5.4).

Args:
    surface: the Surface of the first frame.
    samples: its Samples.
    capacity_weight, gap_weight, tolerance, method, threads: as for sample().
    max_evaluations: of the energy, per frame.
    max_slide: farthest that a sample may slide from its carried position within one frame, in spacings, >= 0; after a
        violent frame evenness is caught up over the next ones.

Raises:
    ValueError: the samples are not of the surface.)")
      .def(py::init(&make_tracker), py::arg("surface"), py::arg("samples"), py::kw_only(),
           py::arg("capacity_weight") = 30.0, py::arg("gap_weight") = 1.0,
           py::arg("tolerance") = 1e-5, py::arg("max_evaluations") = 30,
           py::arg("max_slide") = 0.45, py::arg("method") = "trust_region", py::arg("threads") = 0)
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

void bind_files(py::module_& m) {
  m.def("read_mesh", &read_mesh_arrays, py::arg("path"),
        R"(Read a triangle mesh from .off, .obj, .ply, .stl or .om; polygons are cut into fans.

Returns:
    vertices (v, 3) float64 and faces (m, 3) int32, with every digit of the file.

Raises:
    FileError: naming the file and what is wrong with it.)");
  m.def(
      "write_mesh", &write_mesh_arrays, py::arg("path"), py::arg("vertices"), py::arg("faces"),
      R"(Write a triangle mesh in the format of the suffix: .off, .obj, .ply, .stl (single precision) or .om.

Args:
    path: the file.
    vertices: (v, 3) float64.
    faces: (m, 3) int32.

Raises:
    FileError: it cannot be written so.
    SurfaceError: the arrays do not form a surface.)");
}

}  // namespace

PYBIND11_MODULE(_native, m) {
  m.attr("__version__") = DAPPLE_VERSION;
  bind_errors(m);
  bind_context(m);
  bind_surface(m);
  bind_samples_classes(m);
  bind_energy(m);
  bind_projection(m);
  bind_sampling(m);
  bind_files(m);
}

}  // namespace dapple::python
