// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <dapple/errors.hpp>
#include <dapple/mesh_file.hpp>
#include <dapple/projector.hpp>
#include <dapple/surface.hpp>
#include <dapple/surface_record.hpp>
#include <dapple/topology.hpp>
#include <unordered_map>

#include "arrays.hpp"
#include "bindings.hpp"
#include "file_path.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(Topology& t) {
  return std::tie(t.components, t.border_edges, t.border_loops, t.nonmanifold_edges, t.manifold,
                  t.closed, t.genus);
}
inline auto members(Projection& p) {
  return std::tie(p.positions, p.faces, p.barycentric, p.distances);
}
inline auto members(MeshRecord& r) {
  return std::tie(r.weld, r.merge_doubled, r.faces, r.original_face, r.original_vertex,
                  r.next_around_edge, r.welded_vertex, r.component, r.body, r.doubled);
}

}  // namespace dapple

namespace dapple::python {
namespace {

/// \throw ArgumentError for another name
DensityAt place_named(const std::string& name) {
  if (name == "vertices") return DensityAt::kVertices;
  if (name == "faces") return DensityAt::kFaces;
  if (name == "corners") return DensityAt::kCorners;
  throw ArgumentError("density_at is '" + name + "': it must be 'vertices', 'faces' or 'corners'");
}

const char* place_name(const Surface& surface) {
  switch (surface.density_at()) {
    case DensityAt::kFaces:
      return "faces";
    case DensityAt::kCorners:
      return "corners";
    case DensityAt::kVertices:
      break;
  }
  return "vertices";
}

/// The argument `density` and where its values are; `view` is for the library.
struct DensityArgument {
  DensityArgument(const py::object& density, const std::string& density_at)
      : at(place_named(density_at)) {
    if (density.is_none()) return;
    values = doubles("density", density, at == DensityAt::kCorners ? 3 : 0);
    if (values.size() == 0)
      throw SurfaceError("density has 0 values: values at the " + density_at + " are needed");
  }
  [[nodiscard]] Density view() const { return {at, as_span(values)}; }

  DensityAt at;
  DoubleArray values;
};

/// The argument with normals (m, 3, 3) at the corners of faces, or none.
struct NormalsArgument {
  explicit NormalsArgument(const py::object& normals) {
    if (normals.is_none()) return;
    values = corner_rows("normals", normals, 3);
    given = true;
  }
  [[nodiscard]] Surface shade(const Surface& surface) const {
    return given ? surface.with_normals(as_points(values)) : surface;
  }

  bool given = false;
  DoubleArray values;
};

std::shared_ptr<Surface> make_surface(const py::object& vertices, const py::object& faces,
                                      const py::object& density, const std::string& density_at,
                                      std::optional<double> weld, const py::object& normals,
                                      double sharp_angle, bool merge_doubled,
                                      const ContextPtr& context) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const IntArray triangles = integers("faces", faces, 3);
  const DensityArgument values(density, density_at);
  const NormalsArgument corners(normals);
  return run(context, [&](Context* watched) {
    return std::make_shared<Surface>(corners.shade(Surface(
        as_points(points), as_faces(triangles), values.view(),
        {.weld = weld, .sharp_angle = sharp_angle, .merge_doubled = merge_doubled}, watched)));
  });
}

std::shared_ptr<Surface> deformed(const Surface& surface, const py::object& vertices,
                                  const py::object& normals, const ContextPtr& context) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const NormalsArgument corners(normals);
  return run(context, [&](Context* watched) {
    return std::make_shared<Surface>(corners.shade(surface.deformed(as_points(points), watched)));
  });
}

py::object corner_normals_of(const Surface& surface) {
  return give(run([&] { return surface.corner_normals(); })).attr("reshape")(-1, 3, 3);
}

py::object density_of(const Surface& surface) {
  if (surface.uniform()) return py::none();
  py::array values = give(surface.density());
  if (surface.density_at() != DensityAt::kCorners) return values;
  return values.attr("reshape")(-1, 3);
}

std::shared_ptr<Projection> project_points(const Surface& surface, const py::object& points) {
  const DoubleArray array = doubles("points", points, 3);
  return run(
      [&] { return std::make_shared<Projection>(Projector(surface).project(as_points(array))); });
}

/// The name of an attribute; invalid bytes are replaced.
py::object name_of(const MeshAttribute& attribute) {
  return py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
      attribute.name.data(), static_cast<py::ssize_t>(attribute.name.size()), "replace"));
}

/// The rows of all corners, (m, 3, columns); none if the file has none.
template <typename Row>
py::object give_corners(std::vector<Row>&& rows, py::ssize_t columns) {
  using Number = std::remove_cvref_t<decltype(rows[0][0][0])>;
  static_assert(sizeof(Row) % (3 * sizeof(Number)) == 0);
  if (rows.empty()) return py::none();
  auto* kept = new std::vector<Row>(std::move(rows));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Row>*>(p); });
  return view(owner, &(*kept)[0][0][0], {static_cast<py::ssize_t>(kept->size()), 3, columns});
}

py::dict read_mesh_arrays(const FilePath& file, bool may_be_empty) {
  MeshArrays mesh = run([&] { return read_mesh(file.path, may_be_empty); });
  py::dict found, at_vertices, at_faces;
  for (MeshAttribute& attribute : mesh.attributes) {
    const py::dict& owner = attribute.at_faces ? at_faces : at_vertices;
    owner[name_of(attribute)] = give(std::move(attribute.values));
  }
  found["vertices"] = give(std::move(mesh.vertices));
  found["faces"] = give(std::move(mesh.faces));
  found["polygons"] = give(std::move(mesh.polygons));
  found["uv"] = give_corners(std::move(mesh.uv), 2);
  found["normals"] = give_corners(std::move(mesh.normals), 3);
  found["colors"] = give_corners(std::move(mesh.colors), 4);
  found["vertex_attributes"] = at_vertices;
  found["face_attributes"] = at_faces;
  return found;
}

py::dict vertex_columns(const FilePath& file) {
  std::vector<MeshAttribute> columns = run([&] { return read_vertex_columns(file.path); });
  py::dict found;
  for (MeshAttribute& column : columns) found[name_of(column)] = give(std::move(column.values));
  return found;
}

void write_mesh_arrays(const FilePath& file, const py::object& vertices, const py::object& faces) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const IntArray triangles = integers("faces", faces, 3);
  run([&] {
    const Surface checked(as_points(points), as_faces(triangles));
    write_mesh(file.path, as_points(points), as_faces(triangles));
  });
}

/// The connectivity of surfaces, as an object that a pickle of several surfaces contains once.
struct SharedConnectivity {
  std::shared_ptr<const Connectivity> value;
};

/// The same object for the same connectivity, as long as it is in use.
std::shared_ptr<SharedConnectivity> shared_object(std::shared_ptr<const Connectivity> value) {
  static std::unordered_map<const Connectivity*, std::weak_ptr<SharedConnectivity>> known;
  std::erase_if(known, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<SharedConnectivity>& place = known[value.get()];
  if (auto found = place.lock()) return found;
  auto made = std::make_shared<SharedConnectivity>(SharedConnectivity{std::move(value)});
  place = made;
  return made;
}

py::object packed_surface(const Surface& surface) {
  const SurfaceRecord record = run([&] { return record_of(surface); });
  return py::make_tuple(shared_object(record.connectivity), packed(record.vertices),
                        packed(record.density_at), packed(record.density), record.sharp_angle,
                        packed(record.hard_edges), packed(record.normals));
}

Surface restored_surface(const py::object& state) {
  const auto items = state.cast<py::tuple>();
  if (items.size() != 7) throw ArgumentError("it has the wrong number of members");
  SurfaceRecord record;
  record.connectivity = items[0].cast<const SharedConnectivity&>().value;
  unpack(py::object(items[1]), record.vertices);
  unpack(py::object(items[2]), record.density_at);
  unpack(py::object(items[3]), record.density);
  unpack(py::object(items[4]), record.sharp_angle);
  unpack(py::object(items[5]), record.hard_edges);
  unpack(py::object(items[6]), record.normals);
  return run([&] { return restored(record); });
}

void bind_connectivity(py::module_& m) {
  py::class_<SharedConnectivity, std::shared_ptr<SharedConnectivity>> type(
      m, "_Connectivity", "How the faces of surfaces are connected, in their pickles.");
  def_pickle<SharedConnectivity>(
      type, "_Connectivity",
      [](const SharedConnectivity& c) { return packed(record_of(*c.value)); },
      [](const py::object& state) {
        MeshRecord record;
        unpack(state, record);
        return run([&] { return SharedConnectivity{restored(std::move(record))}; });
      });
}

void bind_surface_class(py::module_& m) {
  bind_connectivity(m);
  py::class_<Topology> connections(
      m, "Topology",
      "How the faces of a surface are connected (through OpenMesh); border edges at "
      "the same place are, see Surface.");
  def_pickle<Topology>(connections, "Topology");
  connections
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

  py::class_<Surface, std::shared_ptr<Surface>> type(
      m, "Surface",
      R"(An immutable, validated triangle mesh with a density.

Args:
    vertices: (v, 3) float64, positions in any unit.
    faces: (m, 3) int32, vertex indices; degenerate, repeated and non-manifold faces are allowed.
    density: float64 >= 0, linear on each face; None means 1 everywhere.
    density_at: where the values are given: 'vertices', shape (v,): continuous; 'faces', (m,): constant on each face;
        'corners', (m, 3), row f for the corners 0, 1, 2 of face f: it may jump between faces.
    weld: border edges whose ends are within this distance of each other, as a share of the bounding box's diagonal,
        are connected like one edge: >= 0, 0 for equal coordinates. Files repeat vertices along hard edges and texture
        seams, triangle soups repeat all of them. Faces that lie on each other stay apart. None: faces are connected
        by the indices of their vertices alone.
    normals: (m, 3, 3) float64, normals at the corners of the faces for shading, of any length; zero
        where none is known. None: those of the faces, smooth except over hard edges.
    sharp_angle: edges whose faces' normals differ by more than this, in degrees 0..180, are hard.
    merge_doubled: whether faces that lie on each other corner by corner, turned the same way or not, count as one: the
        first of them. The others have no area, connect nothing, and get no samples. Corners are at one place as weld
        says, or if their indices are equal. Faces that overlap otherwise are not changed.
    context: a Context for progress and cancel.

Raises:
    SurfaceError: naming the first offender: an index out of range, a number that is not finite, a negative density,
        a density or normals of another length, no area, or a density whose integral is 0 or not finite.
    ValueError: an array has the wrong shape or dtype, or a name is unknown.
    Cancelled: through the context.)");
  def_pickle<Surface>(type, "Surface", &packed_surface, &restored_surface);
  type.def(py::init(&make_surface), py::arg("vertices"), py::arg("faces"),
           py::arg("density") = py::none(), py::kw_only(), py::arg("density_at") = "vertices",
           py::arg("weld") = SurfaceOptions{}.weld, py::arg("normals") = py::none(),
           py::arg("sharp_angle") = SurfaceOptions{}.sharp_angle,
           py::arg("merge_doubled") = SurfaceOptions{}.merge_doubled, py::arg("context") = nullptr)
      .def_property_readonly(
          "vertices", [](const Surface& s) { return give(s.vertices()); },
          "(v, 3) float64, a read-only copy.")
      .def_property_readonly(
          "faces", [](const Surface& s) { return give(s.faces()); },
          "(m, 3) int32, a read-only copy.")
      .def_property_readonly("density", &density_of,
                             "(v,) float64 at vertices, (m,) at faces, (m, 3) at corners: a "
                             "read-only copy, or None if 1 everywhere.")
      .def_property_readonly("density_at", &place_name,
                             "Where the density is given: 'vertices', 'faces' or 'corners'.")
      .def_property_readonly(
          "weld", [](const Surface& s) { return s.weld(); },
          "The distance up to which border edges are connected, as a share of the bounding box's "
          "diagonal; None: by indices alone.")
      .def_property_readonly("sharp_angle", &Surface::sharp_angle,
                             "Edges whose faces differ by more are hard, in degrees.")
      .def_property_readonly("doubled_faces", &Surface::doubled_faces,
                             "How many faces do not count because they lie on others.")
      .def_property_readonly("merge_doubled", &Surface::merge_doubled,
                             "Whether faces that lie on each other count as one.")
      .def_property_readonly("corner_normals", &corner_normals_of,
                             "(m, 3, 3) float64, unit normals at the corners of the faces, as the "
                             "surface is shaded there: those that were given, elsewhere the mean "
                             "of the faces around that no hard edge separates, weighted by their "
                             "angles.")
      .def_property_readonly("area", &Surface::area, "In squared units of the vertices.")
      .def_property_readonly("capacity", &Surface::capacity,
                             "Integral of the density over the surface.")
      .def_property_readonly(
          "topology", [](const Surface& s) { return run([&] { return topology(s); }); },
          "A Topology, measured anew at each call.")
      .def_property_readonly(
          "islands", [](const Surface& s) { return give(run([&] { return islands(s); })); },
          "(m,) int32, the island of each face: faces that are connected over edges with density. "
          "Samples do not move from one island to another, so each has a whole number of them. "
          "Numbered from 0 in the order of the first faces; -1 for faces without area or density "
          "and for doubled ones. Found anew at each call.")
      .def(
          "spacing", [](const Surface& s, Count count) { return s.spacing(count); },
          py::arg("count"),
          "Distance between neighbors if count points were packed hexagonally: "
          "sqrt(2 area / (sqrt(3) count)), in the units of the vertices.")
      .def("count", &Surface::count, py::arg("spacing"),
           "How many samples have this distance between neighbors if they are packed hexagonally, "
           "where the density is largest: 2 M / (sqrt(3) spacing^2) to the nearest, at least 1. M "
           "is the capacity over the largest density, so the area if there is one density "
           "everywhere. "
           "Raises ValueError if the spacing is not finite and > 0, or for more than a hundred "
           "million samples.")
      .def("deformed", &deformed, py::arg("vertices"), py::kw_only(),
           py::arg("normals") = py::none(), py::arg("context") = nullptr,
           "The same faces and density over moved vertices, (v, 3) float64. Hard edges stay hard, "
           "whatever their angle is now; normals, (m, 3, 3), are as in the constructor and not "
           "kept from before. Raises SurfaceError, Cancelled.")
      .def("with_density", &with_density, py::arg("density"), py::kw_only(),
           py::arg("density_at") = "vertices", py::arg("context") = nullptr,
           "The same vertices and faces with another density, as in the constructor; None means 1 "
           "everywhere. Raises SurfaceError, Cancelled.");
}

void bind_projection(py::module_& m) {
  py::class_<Projection, std::shared_ptr<Projection>> type(m, "Projection",
                                                           "Closest points of a surface.");
  def_pickle<Projection>(type, "Projection");
  type.def_property_readonly("positions", array_property(&Projection::positions), "(n, 3) float64.")
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

void bind_files(py::module_& m) {
  m.def("_read_mesh", &read_mesh_arrays, py::arg("path"), py::arg("may_be_empty"),
        R"(The arrays of dapple3d.MeshArrays by name, from .off, .obj, .ply or .stl.

Raises:
    FileError: naming the file and the error.)");
  m.def("_read_vertex_columns", &vertex_columns, py::arg("path"),
        R"(All numbers of the vertices of a .ply file by name, also of one without faces.

Raises:
    FileError: naming the file and the error.)");
  m.def(
      "write_mesh", &write_mesh_arrays, py::arg("path"), py::arg("vertices"), py::arg("faces"),
      R"(Write a triangle mesh in the format of the suffix: .off, .obj, .ply or .stl (single precision).

The file is written completely, or the old one is kept.

Args:
    path: the file.
    vertices: (v, 3) float64.
    faces: (m, 3) int32.

Raises:
    FileError: the file cannot be written.
    SurfaceError: the arrays do not form a surface.)");
}

}  // namespace

std::shared_ptr<Surface> with_density(const Surface& surface, const py::object& density,
                                      const std::string& density_at, const ContextPtr& context) {
  const DensityArgument values(density, density_at);
  return run(context, [&](Context* watched) {
    return std::make_shared<Surface>(surface.with_density(values.view(), watched));
  });
}

void bind_surface(py::module_& m) {
  bind_surface_class(m);
  bind_projection(m);
  bind_files(m);
}

}  // namespace dapple::python
