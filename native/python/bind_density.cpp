// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/curvature.hpp>
#include <dapple/exposure.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/refine_obstacles.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/solids.hpp>
#include <dapple/visibility.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple::python {
namespace {

std::shared_ptr<Refined> image_refined(const Surface& surface, const py::object& uv,
                                       const py::object& image, const py::kwargs& keywords) {
  const Keywords given(kRefineImage, keywords);
  const ImageOptions options = given.options();
  const ContextPtr context = given.context();
  const DoubleArray rows = corner_rows("uv", uv, 2);
  const Image pixels = image_of("image", image);
  return run(context, [&](Context* watched) {
    return std::make_shared<Refined>(
        refine_image(surface, as_face_uv(rows), pixels, options, watched));
  });
}

/// \throw ArgumentError for an integer that is too large for a double
double number_of(const char* name, const py::object& value) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (!PyErr_Occurred()) return number;
  PyErr_Clear();
  throw ArgumentError(std::string(name) + " is " + digits_of(value) +
                      ": it does not fit into 64 bits");
}

/// Whether the value is a number of Python or numpy or converts to one; arrays with axes are not
/// numbers.
bool is_number(const py::object& value) {
  if (py::isinstance<py::array>(value)) return value.cast<py::array>().ndim() == 0;
  return py::hasattr(value, "__float__");
}

/// One number for all of `count`, or one for each.
DoubleArray numbers_of(const char* name, const py::object& value, py::ssize_t count) {
  if (!is_number(value)) return doubles(name, value, 0);
  DoubleArray numbers(count);
  std::fill_n(numbers.mutable_data(), count, number_of(name, value));
  return numbers;
}

std::vector<std::uint8_t> areas_of(const py::object& value) {
  if (value.is_none()) return {};
  const py::array array = checked_array("areas", value, "b", 0);
  const py::array_t<bool, py::array::c_style | py::array::forcecast> mask(array);
  return {mask.data(), mask.data() + mask.size()};
}

std::shared_ptr<Refined> obstacles_refined(const Surface& surface, const py::object& points,
                                           const py::object& radii, const py::object& areas,
                                           double edge, MaxFaces max_faces,
                                           const ContextPtr& context) {
  const DoubleArray centers = doubles("points", points, 3);
  const DoubleArray sizes = numbers_of("radii", radii, centers.shape(0));
  const std::vector<std::uint8_t> mask = areas_of(areas);
  const ObstacleOptions options{edge, max_faces};
  return run(context, [&](Context* watched) {
    return std::make_shared<Refined>(
        refine_obstacles(surface, {as_points(centers), as_span(sizes), mask}, options, watched));
  });
}

py::array barycentric_of(const py::object& self) {
  const auto& rows = self.cast<const Refined&>().barycentric;
  return view(self, rows[0][0].data(), {static_cast<py::ssize_t>(rows.size()), 3, 3});
}

py::array fine_vertices(const Refined& refined, const py::object& vertices) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  return give(run([&] { return refined.vertices(as_points(points)); }));
}

std::shared_ptr<Refined> deformed(const Refined& refined, const py::object& vertices) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  return run([&] { return std::make_shared<Refined>(refined.deformed(as_points(points))); });
}

/// Wraps a function that transfers samples through a refinement.
template <typename Function>
auto samples_through(const Function& function) {
  return [function](const Refined& refined, const Samples& samples) {
    return run([&] { return std::make_shared<Samples>(function(refined, samples)); });
  };
}

py::object packed_refined(const Refined& r) {
  return py::make_tuple(r.original, r.surface, packed(r.parents), packed(r.barycentric),
                        packed(r.ends), packed(r.shares), r.resolved, r.inset);
}

/// \throw ArgumentError for an index out of range
void check_refined(const Refined& r) {
  check_equal(r.parents.size(), r.surface.face_count());
  check_equal(r.barycentric.size(), r.parents.size());
  check_equal(r.original.vertex_count() + r.ends.size(), r.surface.vertex_count());
  check_equal(r.shares.size(), r.ends.size());
  const auto out = [](std::int32_t index, std::size_t count) {
    return index < 0 || static_cast<std::size_t>(index) >= count;
  };
  for (const std::int32_t parent : r.parents)
    if (out(parent, r.original.face_count())) throw ArgumentError("a parent is no face");
  for (std::size_t k = 0; k < r.ends.size(); ++k)
    if (out(r.ends[k][0], r.original.vertex_count() + k) ||
        out(r.ends[k][1], r.original.vertex_count() + k))
      throw ArgumentError("an end is no vertex before it");
}

Refined restored_refined(const py::object& state) {
  const auto items = state.cast<py::tuple>();
  if (items.size() != 8) throw ArgumentError("it has the wrong number of members");
  Refined r{items[0].cast<Surface>(), items[1].cast<Surface>(), {}, {}, {}, {},
            items[6].cast<bool>(),    items[7].cast<double>()};
  unpack(py::object(items[2]), r.parents);
  unpack(py::object(items[3]), r.barycentric);
  unpack(py::object(items[4]), r.ends);
  unpack(py::object(items[5]), r.shares);
  check_refined(r);
  return r;
}

void bind_refined(py::module_& m) {
  py::class_<Refined, std::shared_ptr<Refined>> type(
      m, "Refined",
      "A surface cut into smaller faces that carry a density in detail, and the way back.\n\n"
      "Made by refine_image(), refine_obstacles() and refine_edges(). Sample its surface, then "
      "to_original().");
  def_pickle<Refined>(type, "Refined", &packed_refined, &restored_refined);
  type.def_property_readonly(
          "original", [](const Refined& r) { return std::make_shared<Surface>(r.original); },
          "The Surface that was cut.")
      .def_property_readonly(
          "surface", [](const Refined& r) { return std::make_shared<Surface>(r.surface); },
          "The Surface with smaller faces and the density at their corners. Its first vertices are "
          "the original's.")
      .def_property_readonly("parents", array_property(&Refined::parents),
                             "(m,) int32, per face of surface: the face of original it is of.")
      .def_property_readonly(
          "barycentric", &barycentric_of,
          "(m, 3, 3) float64: coordinates of each corner of a face in its parent.")
      .def_readonly("resolved", &Refined::resolved,
                    "False if max_faces was too few for all detail.")
      .def("to_original", samples_through(&to_original), py::arg("samples"),
           "Samples on surface as Samples on original: the same positions, ids, classes and "
           "report. Raises ValueError.")
      .def("from_original", samples_through(&from_original), py::arg("samples"),
           "Samples on original as Samples on surface: the same positions, ids, classes and "
           "report. Raises ValueError.")
      .def("vertices", &fine_vertices, py::arg("vertices"),
           "(n, 3) float64: where the vertices of surface are once those of original are at "
           "vertices, (v, 3) float64: what a Tracker on surface advances to. Raises ValueError.")
      .def("deformed", &deformed, py::arg("vertices"),
           "The same over moved vertices of original, (v, 3) float64. Raises ValueError.")
      .def(
          "then",
          [](const Refined& refined, const Refined& finer) {
            return run([&] { return std::make_shared<Refined>(refined.then(finer)); });
          },
          py::arg("finer"),
          "Two refinements as one, from this one's original to the surface of finer, which cut "
          "this one's surface further. Raises ValueError if it did not.");
}

void bind_edges(py::module_& m) {
  m.def(
      "refine_edges",
      [](const Surface& surface, const py::object& longest, MaxFaces max_faces,
         const ContextPtr& context) {
        const DoubleArray limits = numbers_of("longest", longest, 1);
        return run(context, [&](Context* watched) {
          return std::make_shared<Refined>(
              refine_edges(surface, as_span(limits), max_faces, watched));
        });
      },
      py::arg("surface"), py::arg("longest"), py::kw_only(), py::arg("max_faces") = 1'000'000,
      py::arg("context") = py::none(),
      R"(Cut the faces of a surface until no edge is longer than a length: for a density that varies within its faces.

Faces are halved at their longest edges (Rivara 1984); the shape and the density stay. Give the surface of the result a
density of its own by with_density().

Args:
    surface: a Surface.
    longest: in the units of the vertices, > 0; one number, or (m,) float64, one for each face, infinite for those that
        need no refinement. Neighbors are cut as far as shared edges require.
    max_faces: 1..200000000; the rest stays coarser, and resolved is False.
    context: a Context to cancel by, or None.

Returns:
    Refined.

Raises:
    ValueError: naming the option out of range.
    Cancelled: through the context.)");
}

void bind_verbs(py::module_& m) {
  def_verb(
      m, kRefineImage, &image_refined,
      R"(refine_image(surface: Surface, uv: numpy.ndarray, image: numpy.ndarray, *, {signature}, context: Context | None = None) -> Refined

Use a picture as density of a surface, through texture coordinates.

Faces are cut until the density, linear on each, follows the picture: their edges are halved while they are longer than
`texels` and the picture deviates from linear by more than the tolerance. A density that the surface has is multiplied.

Args:
    surface: a Surface with m faces.
    uv: (m, 3, 2) float64, u and v of the corners of each face; within 1e6 of 0; they may differ at seams.
    image: (rows, columns) float64 >= 0, row 0 at v = 0. The values hold at the centers of the pixels, ((column + 0.5) /
        columns, (row + 0.5) / rows), and are bilinear in between.
    {options}
    context: a Context to cancel by, or None.

Returns:
    Refined. Samples lie at most one such edge beyond pixels that are not black.

Raises:
    ValueError: naming the first value or option out of range.
    SurfaceError: the picture is 0 wherever the surface has area.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("uv"), py::arg("image"));
  m.def("refine_obstacles", &obstacles_refined, py::arg("surface"), py::arg("points"),
        py::arg("radii"), py::kw_only(), py::arg("areas") = py::none(),
        py::arg("edge") = ObstacleOptions().edge,
        py::arg("max_faces") = ObstacleOptions().max_faces, py::arg("context") = py::none(),
        R"(Remove the density around points and on whole faces.

No sample on the returned surface lies closer to a point than its radius, in a straight line. Faces at the border of such
a ball are refined first, since pieces that reach into it lose their density; elsewhere it does not change.

Args:
    surface: a Surface with m faces.
    points: (k, 3) float64; (0, 3) for none.
    radii: (k,) float64 > 0, or one number for all, in the units of the vertices.
    areas: (m,) bool, faces to avoid, or None.
    edge: longest edge at the border of a ball, of its radius, > 0.
    max_faces: 1..200000000; the rest stays coarser, and resolved is False; the distances are kept.
    context: a Context to cancel by, or None.

Returns:
    Refined.

Raises:
    ValueError: naming the first point, radius or option out of range; if nothing is left.
    Cancelled: through the context.)");
}

py::array exposure_of(const Surface& surface, const py::object& faces,
                      const py::object& barycentric, const ContextPtr& context) {
  if (faces.is_none() != barycentric.is_none())
    throw ArgumentError("faces and barycentric go together: give both or neither");
  if (faces.is_none())
    return give(run(context, [&](Context* watched) { return exposure(surface, watched); }));
  const IntArray places = integers("faces", faces, 0);
  const DoubleArray weights = doubles("barycentric", barycentric, 3);
  return give(run(context, [&](Context* watched) {
    return exposure(surface, as_span(places), as_points(weights), watched);
  }));
}

py::array_t<bool> seen_by(const Surface& surface, const py::object& eye, const py::object& points,
                          const ContextPtr& context) {
  const DoubleArray numbers = doubles("eye", eye, 0);
  if (numbers.size() != 4)
    throw ArgumentError("eye has " + std::to_string(numbers.size()) + " numbers: 4 are needed");
  std::array<double, 4> own{};
  std::copy_n(numbers.data(), 4, own.begin());
  const DoubleArray places = doubles("points", points, 3);
  py::array_t<bool> result(places.shape(0));
  const auto seen = run(context, [&](Context* watched) {
    return seen_from(surface, own, as_points(places), watched);
  });
  std::copy(seen.begin(), seen.end(), result.mutable_data());
  return result;
}

py::array reached_by(const py::object& vertices, const py::object& faces, const py::object& points,
                     const py::object& counts, double margin, const ContextPtr& context) {
  const DoubleArray places = doubles("vertices", vertices, 3);
  const IntArray corners = integers("faces", faces, 3);
  const DoubleArray hulls = doubles("points", points, 3);
  const IntArray numbers = integers("counts", counts, 0);
  const Solids solids{as_points(hulls), as_span(numbers), margin};
  const std::vector<Reach> found = run(context, [&](Context* watched) {
    return reached_by_solids(as_points(places), as_faces(corners), solids, watched);
  });
  py::array_t<std::uint8_t> result(static_cast<py::ssize_t>(found.size()));
  std::transform(found.begin(), found.end(), result.mutable_data(),
                 [](Reach reach) { return static_cast<std::uint8_t>(reach); });
  return result;
}

py::array touching(const py::object& points, const py::object& counts, double margin,
                   const ContextPtr& context) {
  const DoubleArray hulls = doubles("points", points, 3);
  const IntArray numbers = integers("counts", counts, 0);
  const Solids solids{as_points(hulls), as_span(numbers), margin};
  const auto pairs =
      run(context, [&](Context* watched) { return touching_solids(solids, watched); });
  py::array_t<std::int32_t> result({static_cast<py::ssize_t>(pairs.size()), py::ssize_t{2}});
  for (std::size_t k = 0; k < pairs.size(); ++k)
    std::copy(pairs[k].begin(), pairs[k].end(), result.mutable_data(static_cast<py::ssize_t>(k)));
  return result;
}

/// The squares in the order in which numpy adds columns.
double squared_length(const Vec3& v) { return v.x() * v.x() + v.y() * v.y() + v.z() * v.z(); }

/// A number of each face by its corners.
template <typename Measure>
DoubleArray measured_faces(const py::object& vertices, const py::object& faces,
                           const Measure& measure) {
  const DoubleArray places = doubles("vertices", vertices, 3);
  const IntArray corners = integers("faces", faces, 3);
  const std::span<const Vec3> x = as_points(places);
  const std::span<const Face> given = as_faces(corners);
  for (const std::int32_t v : std::span(corners.data(), static_cast<std::size_t>(corners.size())))
    if (v < 0 || static_cast<std::size_t>(v) >= x.size())
      throw ArgumentError("faces has the vertex " + std::to_string(v) + " of " +
                          std::to_string(x.size()));
  DoubleArray result(static_cast<py::ssize_t>(given.size()));
  std::transform(given.begin(), given.end(), result.mutable_data(), [&](const Face& face) {
    const auto corner = [&](std::size_t k) { return x[static_cast<std::size_t>(face[k])]; };
    return measure(corner(0), corner(1), corner(2));
  });
  return result;
}

DoubleArray longest_edges(const py::object& vertices, const py::object& faces) {
  return measured_faces(vertices, faces, [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return std::sqrt(
        std::max({squared_length(a - b), squared_length(b - c), squared_length(c - a)}));
  });
}

DoubleArray face_areas(const py::object& vertices, const py::object& faces) {
  return measured_faces(vertices, faces, [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return 0.5 * std::sqrt(squared_length((b - a).cross(c - a)));
  });
}

void bind_faces(py::module_& m) {
  m.def("_longest_edges", &longest_edges, py::arg("vertices"), py::arg("faces"),
        "Longest edge (m,) of faces (m, 3) of vertices (v, 3).");
  m.def("_face_areas", &face_areas, py::arg("vertices"), py::arg("faces"),
        "Area (m,) of faces (m, 3) of vertices (v, 3).");
}

void bind_solids(py::module_& m) {
  m.def("reached_by_solids", &reached_by, py::arg("vertices"), py::arg("faces"), py::arg("points"),
        py::arg("counts"), py::kw_only(), py::arg("margin") = Solids().margin,
        py::arg("context") = py::none(),
        R"(How faces lie relative to convex solids, which are the convex hulls of points.

A face that counts as clear is so for certain: a plane separates it from each solid. The search is that of Gilbert,
Johnson and Keerthi (1988).

Args:
    vertices: (v, 3) float64.
    faces: (m, 3) int32.
    points: (p, 3) float64, those of all solids, one after the other. A hull may be flat, a line or a point.
    counts: (s,) int32, number of points of each solid, >= 0; with 0 there is none.
    margin: >= 0, what is not farther from a hull belongs to the solid.
    context: a Context for progress and cancel.

Returns:
    (m,) uint8: 0 for faces that touch no solid, 2 for faces inside one, 1 for the others.

Raises:
    ValueError: naming the first coordinate that is not finite, face with a missing vertex, or negative count; if the
        counts do not sum up to p, or margin is out of range.
    Cancelled: through the context.)");
  m.def("touching_solids", &touching, py::arg("points"), py::arg("counts"), py::kw_only(),
        py::arg("margin") = Solids().margin, py::arg("context") = py::none(),
        R"(Which convex solids touch or overlap, of the solids of reached_by_solids().

Args:
    points: (p, 3) float64, those of all solids, one after the other.
    counts: (s,) int32, number of points of each solid, >= 0; with 0 there is none.
    margin: >= 0, what is not farther from a hull belongs to the solid.
    context: a Context for progress and cancel.

Returns:
    (k, 2) int32, pairs of solids in ascending order, the smaller index first.

Raises:
    ValueError: as reached_by_solids().
    Cancelled: through the context.)");
}

void bind_seen_from(py::module_& m) {
  m.def("seen_from", &seen_by, py::arg("surface"), py::arg("eye"), py::arg("points"), py::kw_only(),
        py::arg("context") = py::none(),
        R"(Which points an eye sees: nothing of the surface is between them and the eye.

Faces block from both sides. Those nearer to a point than a few millionths of the surface's size do not, so points may
lie on it.

Args:
    surface: a Surface.
    eye: (4,) float64, homogeneous: (x, y, z, 1) is a place, (x, y, z, 0) the direction to an eye at infinity, as of an
        orthographic camera.
    points: (n, 3) float64.
    context: a Context to cancel by, or None.

Returns:
    (n,) bool.

Raises:
    ValueError: if the eye is not finite, its last number is neither 0 nor 1 or its direction has no length; naming the
        first point that is not finite.
    Cancelled: through the context.)");
}

std::vector<std::vector<Vec3>> poses_of(const py::sequence& poses) {
  std::vector<std::vector<Vec3>> result;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const std::string name = "poses[" + std::to_string(k) + "]";
    const DoubleArray points = doubles(name.c_str(), poses[k], 3);
    const std::span<const Vec3> read = as_points(points);
    result.emplace_back(read.begin(), read.end());
  }
  return result;
}

void bind_exposure(py::module_& m) {
  m.def("exposure", &exposure_of, py::arg("surface"), py::arg("faces") = py::none(),
        py::arg("barycentric") = py::none(), py::kw_only(), py::arg("context") = py::none(),
        R"(How much of the sky places of a surface see: the share of free directions above the face.

96 directions are tried (a Fibonacci lattice on the sphere). A convex body has 1 everywhere, what is inside another part of
the model 0. A face has two sides. If a patch of consistently oriented faces sees far more on one side, as bodies do also
where they are open, only that side counts, so what is hidden in front is not seen through the hollow body behind it.
Otherwise, as on leaves, the side that sees more counts. The orientation of faces does not matter.

Args:
    surface: a Surface with m faces.
    faces: (n,) int32, the face of each place; None: the centers of all m faces.
    barycentric: (n, 3) float64, where on its face each place is; given exactly if faces are.
    context: a Context to cancel by, or None.

Returns:
    (n,) or (m,) float64 in 0..1; 0 on faces without area, and on all but the first of faces that lie on each other.

Raises:
    ValueError: naming the first face out of range; if the lengths differ or one is given without the other.
    Cancelled: through the context.)");
  m.def(
      "refine_outside",
      [](const Surface& surface, double edge, double openness, MaxFaces max_faces,
         const py::sequence& poses, const ContextPtr& context) {
        const OutsideOptions options{openness, edge, max_faces, poses_of(poses)};
        return run(context, [&](Context* watched) {
          return std::make_shared<Refined>(refine_outside(surface, options, watched));
        });
      },
      py::arg("surface"), py::arg("edge"), py::kw_only(),
      py::arg("openness") = OutsideOptions().openness,
      py::arg("max_faces") = OutsideOptions().max_faces, py::arg("poses") = py::tuple(),
      py::arg("context") = py::none(),
      R"(Remove the density where a surface is not seen from outside, such as on parts that are stuck into others.

Faces that pass through each other are cut along their common line and connected there. So samples on different parts keep
their distance across the visible joint, and the hidden sides get none. Elsewhere faces are halved until the border of what
is hidden is resolved; pieces with a hidden corner lose their density. Faces are connected where they cross in the
surface's own pose.

Args:
    surface: a Surface of v vertices.
    edge: longest edge at the border of what is hidden, > 0, in the units of the vertices: a tenth of the distance between
        samples suffices.
    openness: least exposure() of a place that counts as outside, 0..1; more leaves out crevices too. In a hollow part,
        such as a house without a floor, it must be up to four times as much, or 0.2.
    max_faces: 1..200000000; the rest stays coarser, and resolved is False.
    poses: of (v, 3) float64 each, other places of the vertices while the surface moves: what is hidden in one of them
        counts as hidden.
    context: a Context to cancel by, or None.

Returns:
    Refined.

Raises:
    ValueError: naming the option out of range, the first pose with another number of vertices or with one that is not
        finite; if nothing is seen.
    Cancelled: through the context.)");
}

void bind_curvature(py::module_& m) {
  m.def(
      "curvedness",
      [](const Surface& surface, Smoothing smoothing, const ContextPtr& context) {
        return give(run(context,
                        [&](Context* watched) { return curvedness(surface, smoothing, watched); }));
      },
      py::arg("surface"), py::kw_only(), py::arg("smoothing") = CurvatureOptions().smoothing,
      py::arg("context") = nullptr,
      R"(The curvedness of a surface at each vertex: sqrt((k1^2 + k2^2) / 2) of the principal curvatures.

From the normals at the corners of the faces (Rusinkiewicz 2004); 1 / r on a sphere of radius r, 0 where it is flat.

Args:
    surface: a Surface.
    smoothing: rounds of averaging over neighbors against noise, 0..100.
    context: a Context for progress and cancel.

Returns:
    (v,) float64, in 1 / units of the vertices.

Raises:
    ValueError: smoothing is out of range.
    Cancelled: through the context.)");
  m.def(
      "curvature_density",
      [](const Surface& surface, double exponent, double floor, double percentile,
         Smoothing smoothing, const ContextPtr& context) {
        const CurvatureOptions options{exponent, floor, percentile, smoothing};
        return give(run(context, [&](Context* watched) {
          return curvature_density(surface, options, watched);
        }));
      },
      py::arg("surface"), py::kw_only(), py::arg("exponent") = CurvatureOptions().exponent,
      py::arg("floor") = CurvatureOptions().floor,
      py::arg("percentile") = CurvatureOptions().percentile,
      py::arg("smoothing") = CurvatureOptions().smoothing, py::arg("context") = nullptr,
      R"(A density for the vertices that grows with the curvature, for surface.with_density().

floor + (1 - floor) * min(1, curvedness / clamp)**exponent, where clamp is the curvedness that percentile % of the area
do not exceed. 1 everywhere on a flat surface.

Args:
    surface: a Surface.
    exponent: > 0; larger values concentrate the density at sharp bends.
    floor: density where the surface is flat, 0..1.
    percentile: above 0, up to 100.
    smoothing: rounds of averaging over neighbors against noise, 0..100.
    context: a Context for progress and cancel.

Returns:
    (v,) float64 in floor..1.

Raises:
    ValueError: naming the option out of range.
    Cancelled: through the context.)");
}

}  // namespace

void bind_density(py::module_& m) {
  bind_curvature(m);
  bind_refined(m);
  bind_edges(m);
  bind_verbs(m);
  bind_exposure(m);
  bind_seen_from(m);
  bind_solids(m);
  bind_faces(m);
}

}  // namespace dapple::python
