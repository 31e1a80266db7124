// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/remesh.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"
#include "profile.hpp"
#include "to_dict.hpp"

namespace dapple {

inline auto members(RemeshReport& r) {
  return std::tie(r.asked, r.vertices, r.faces, r.on_lines, r.corners, r.dropped_lines,
                  r.smallest_angle, r.mean_smallest_angle, r.below_30, r.valence_6, r.flipped,
                  r.self_intersecting, r.nonmanifold_edges, r.euler, r.border_loops, r.flaws,
                  r.distance, r.evaluations, r.converged, r.seconds, r.profile);
}
inline auto members(RemeshResult& r) {
  return std::tie(r.vertices, r.faces, r.source_faces, r.barycentric, r.features, r.lines,
                  r.density, r.report);
}
inline void check_members(const RemeshResult& r) {
  for (const std::size_t length : {r.source_faces.size(), r.barycentric.size(), r.features.size()})
    python::check_equal(length, r.vertices.size());
}

}  // namespace dapple

namespace dapple::python {
namespace {

std::vector<std::array<std::int32_t, 2>> edges_of(const py::object& edges) {
  std::vector<std::array<std::int32_t, 2>> result;
  if (edges.is_none()) return result;
  const IntArray rows = integers("edges", edges, 2);
  for (py::ssize_t k = 0; k < rows.shape(0); ++k) result.push_back({rows.at(k, 0), rows.at(k, 1)});
  return result;
}

template <typename Given>
RemeshOptions options_of(const Given& given) {
  RemeshOptions options = given.options();
  options.edges = edges_of(given.other("edges"));
  return options;
}

std::shared_ptr<RemeshResult> remesh_surface(const Surface& surface, Count count,
                                             const py::kwargs& keywords) {
  const Keywords given(kRemesh, keywords, {"edges", "context"});
  const RemeshOptions options = options_of(given);
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<RemeshResult>(remesh(surface, count, options, watched));
  });
}

std::shared_ptr<NextRemesh> remesh_next_surface(const Surface& before, const RemeshResult& mesh,
                                                const Surface& surface, double capacity,
                                                const py::kwargs& keywords) {
  const Keywords given(kRemeshNext, keywords, {"edges", "context"});
  const RemeshOptions options = options_of(given);
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<NextRemesh>(
        remesh_next(before, mesh, surface, capacity, options, watched));
  });
}

template <std::size_t N>
py::array rows_view(const py::object& owner, const std::vector<std::array<std::int32_t, N>>& rows) {
  return view(owner, rows.empty() ? nullptr : rows[0].data(),
              {static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(N)});
}

py::array features_of(const RemeshResult& mesh) {
  std::vector<std::int32_t> values;
  values.reserve(mesh.features.size());
  for (const VertexFeature feature : mesh.features)
    values.push_back(static_cast<std::int32_t>(feature));
  return give(std::move(values));
}

void bind_report(py::module_& m) {
  py::class_<RemeshReport, std::shared_ptr<RemeshReport>> type(m, "RemeshReport",
                                                               "The quality of a remesh.");
  def_pickle<RemeshReport>(type, "RemeshReport");
  type.def_readonly("asked", &RemeshReport::asked, "Number of vertices asked for.")
      .def_readonly("vertices", &RemeshReport::vertices,
                    "Number of vertices: more than asked for where the topology needs them.")
      .def_readonly("faces", &RemeshReport::faces, "Number of triangles.")
      .def_readonly("on_lines", &RemeshReport::on_lines,
                    "Number of vertices on creases, borders and marked edges, corners included.")
      .def_readonly("corners", &RemeshReport::corners, "Number of vertices at corners of lines.")
      .def_readonly("dropped_lines", &RemeshReport::dropped_lines,
                    "Number of creases that were given up because no mesh of the topology was "
                    "found with them.")
      .def_readonly("smallest_angle", &RemeshReport::smallest_angle,
                    "Smallest angle of all triangles, in degrees.")
      .def_readonly("mean_smallest_angle", &RemeshReport::mean_smallest_angle,
                    "Mean over the triangles of the smallest angle, in degrees.")
      .def_readonly("below_30", &RemeshReport::below_30,
                    "Share of triangles with an angle below 30 degrees.")
      .def_readonly("valence_6", &RemeshReport::valence_6,
                    "Share of vertices with six neighbors, apart from those on lines.")
      .def_readonly("flipped", &RemeshReport::flipped,
                    "Number of triangles that face away from the old surface.")
      .def_readonly("self_intersecting", &RemeshReport::self_intersecting,
                    "Number of triangles that pass through others with which they have no vertex "
                    "in common.")
      .def_readonly("nonmanifold_edges", &RemeshReport::nonmanifold_edges,
                    "Number of edges with three or more triangles.")
      .def_readonly("euler", &RemeshReport::euler, "Vertices - edges + faces.")
      .def_readonly("border_loops", &RemeshReport::border_loops,
                    "Number of closed borders; -1 if the mesh is not manifold.")
      .def_readonly("flaws", &RemeshReport::flaws,
                    "Number of places where the topology differs from that of the surface.")
      .def_readonly("distance", &RemeshReport::distance,
                    "The largest distance that max_distance limits; 0 without a limit,"
                    " if not adaptive.")
      .def_readonly("evaluations", &RemeshReport::evaluations, "Of the energy and its gradient.")
      .def_readonly("converged", &RemeshReport::converged,
                    "False if the evaluations ran out first.")
      .def_readonly("seconds", &RemeshReport::seconds, "Wall time.")
      .def_property_readonly(
          "profile", [](const RemeshReport& r) { return profile_dict(r.profile); },
          "A dict of seconds by stage, which sum to `seconds`.")
      .def("to_dict", &to_dict, "All of it as a dict that json can write.");
}

void bind_next(py::module_& m) {
  py::class_<NextRemesh, std::shared_ptr<NextRemesh>>(
      m, "NextRemesh", "The mesh of the next surface of a sequence. See remesh_next().")
      .def_property_readonly(
          "mesh",
          [](const py::object& self) {
            static_cast<void>(self.cast<const NextRemesh&>());  // refuses one without constructor
            const auto next = self.cast<std::shared_ptr<NextRemesh>>();
            return std::shared_ptr<RemeshResult>(next, &next->mesh);
          },
          "The RemeshResult.")
      .def_property_readonly("previous", array_property(&NextRemesh::previous),
                             "(n,) int32: per vertex, the vertex of the mesh before that it was; "
                             "-1 for a new one.")
      .def_readonly("kept", &NextRemesh::kept,
                    "Number of vertices that have not moved, because the surface around is the "
                    "same.");
  def_verb(
      m, kRemeshNext, &remesh_next_surface,
      R"(remesh_next(before: Surface, mesh: RemeshResult, surface: Surface, capacity: float, *, {signature}, edges: numpy.ndarray | None = None, context: Context | None = None) -> NextRemesh

The mesh of the next surface of a sequence, whose faces may be others: fluids, torn, carved and built bodies.

Where the surface is the same as before, vertices stay exactly where they are, and so do their triangles. Other vertices
move along with it, each to the nearest place on its side that is not far; where surface appears or is gone, vertices
come and go. The spacing is that of the first mesh: the number of vertices changes with the area. MeshSequence calls
this for one surface after another.

Args:
    before: the Surface that mesh is made from.
    mesh: its RemeshResult.
    surface: the next Surface.
    capacity: of a vertex, > 0: the first surface's capacity, divided by the number of its vertices.
    {options}
    edges: (k, 2) int32: edges of the next surface that stay besides creases and borders.
    context: a Context for progress and cancel.

Returns:
    NextRemesh.

Raises:
    ValueError: naming the option or capacity out of range, or the first of edges that is none; if mesh is not of the
        surface before.
    Cancelled: through the context.)",
      py::arg("before"), py::arg("mesh"), py::arg("surface"), py::arg("capacity"));
}

}  // namespace

void bind_remesh(py::module_& m) {
  bind_report(m);
  py::class_<RemeshResult, std::shared_ptr<RemeshResult>> type(
      m, "RemeshResult",
      "A mesh of n vertices and m triangles whose vertices lie on the surface that it is made "
      "from; all arrays are read-only views. See remesh().");
  def_pickle<RemeshResult>(type, "RemeshResult");
  type.def("__len__", [](const RemeshResult& mesh) { return mesh.vertices.size(); })
      .def_property_readonly("vertices", array_property(&RemeshResult::vertices),
                             "(n, 3) float64, on the surface.")
      .def_property_readonly(
          "faces",
          [](const py::object& self) {
            return rows_view(self, self.cast<const RemeshResult&>().faces);
          },
          "(m, 3) int32: indices of the corners, counter-clockwise from outside.")
      .def_property_readonly("source_faces", array_property(&RemeshResult::source_faces),
                             "(n,) int32: the face of the surface that each vertex lies on.")
      .def_property_readonly("barycentric", array_property(&RemeshResult::barycentric),
                             "(n, 3) float64: of the vertices in those faces, >= 0, sum 1.")
      .def_property_readonly(
          "features", &features_of,
          "(n,) int32: 0 within the surface, 1 on a line (a crease, a border or a marked edge), 2 "
          "at a corner, which is a vertex of the surface.")
      .def_property_readonly(
          "lines",
          [](const py::object& self) {
            return rows_view(self, self.cast<const RemeshResult&>().lines);
          },
          "(k, 2) int32: edges along lines, by their vertices, the lower one first.")
      .def_property_readonly(
          "density",
          [](const py::object& self) -> py::object {
            const std::vector<double>& values = self.cast<const RemeshResult&>().density;
            if (values.empty()) return py::none();
            return view(self, values.data(),
                        {static_cast<py::ssize_t>(values.size() / 3), py::ssize_t{3}});
          },
          "(f, 3) float64 at the corners of the surface's faces: what the vertices follow if "
          "adaptive, for surface.with_density(). None where it is the surface's own density.")
      .def_property_readonly(
          "report", [](const RemeshResult& mesh) { return mesh.report; }, "The RemeshReport.");

  def_verb(
      m, kRemesh, &remesh_surface,
      R"(remesh(surface: Surface, count: int, *, {signature}, edges: numpy.ndarray | None = None, context: Context | None = None) -> RemeshResult

The best triangle mesh with count vertices, which lie on the surface.

It is the dual of the restricted Voronoi diagram of evenly spaced sites, which follow the surface's density (Yan et al.
2009). Borders, creases and marked edges stay; their corners are vertices. The mesh has the topology of the surface once
every cell is a disc and any two of them meet along one curve (Edelsbrunner and Shah 1997). Where that fails sites are
added, and as many are taken away elsewhere. There are more than count vertices only where the topology needs them; the
report tells.

Args:
    surface: the Surface.
    count: number of vertices, >= 1.
    {options}
    edges: (k, 2) int32: edges that stay besides creases and borders, by their vertices.
    context: a Context for progress and cancel.

Returns:
    RemeshResult.

Raises:
    ValueError: naming the option or count out of range, or the first of edges that is none.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("count"));
  bind_next(m);
}

}  // namespace dapple::python
