// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cctype>
#include <dapple/errors.hpp>
#include <dapple/mesh_file.hpp>

#include "openmesh.hpp"

// CGAL reads and writes OFF, OBJ and PLY in double precision and as a soup, so that every digit and
// every index of the file survives. OpenMesh takes all three through float (measured with 9.0
// and 11.0), and splits vertices where faces do not fit into a half-edge mesh; it serves the
// formats that lose nothing by it: its own OM (double precision, manifold by nature) and STL
// (single precision by nature).

namespace dapple {
namespace {

using SoupPoint = CGAL::Simple_cartesian<double>::Point_3;
using SoupFace = std::vector<std::size_t>;

std::string suffix_of(const std::filesystem::path& path) {
  std::string suffix = path.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

bool is_soup(const std::string& suffix) {
  return suffix == ".off" || suffix == ".obj" || suffix == ".ply";
}
bool is_openmesh(const std::string& suffix) { return suffix == ".om" || suffix == ".stl"; }

void check_suffix(const std::filesystem::path& path) {
  if (!is_soup(suffix_of(path)) && !is_openmesh(suffix_of(path)))
    throw FileError(path.string() + " has the suffix '" + suffix_of(path) +
                    "': known are .off, .obj, .ply, .stl and .om");
}

template <typename Corners>
void add_fan(std::vector<Face>& faces, const Corners& corners) {
  const auto at = [&](std::size_t k) { return static_cast<std::int32_t>(corners[k]); };
  for (std::size_t k = 2; k < corners.size(); ++k) faces.push_back({at(0), at(k - 1), at(k)});
}

bool read_soup(const std::filesystem::path& path, MeshArrays& mesh) {
  std::vector<SoupPoint> points;
  std::vector<SoupFace> polygons;
  if (!CGAL::IO::read_polygon_soup(path.string(), points, polygons,
                                   CGAL::parameters::verbose(false)))
    return false;
  for (const SoupPoint& p : points) mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  for (const SoupFace& polygon : polygons) add_fan(mesh.faces, polygon);
  return true;
}

bool read_openmesh(const std::filesystem::path& path, MeshArrays& mesh) {
  PolygonMesh source;
  if (!OpenMesh::IO::read_mesh(source, path.string())) return false;
  for (const auto vertex : source.vertices()) {
    const auto& p = source.point(vertex);
    mesh.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto face : source.faces()) {
    std::vector<int> corners;
    for (auto corner = source.fv_begin(face); corner.is_valid(); ++corner)
      corners.push_back(corner->idx());
    add_fan(mesh.faces, corners);
  }
  return true;
}

bool write_soup(const std::filesystem::path& path, std::span<const Vec3> vertices,
                std::span<const Face> faces) {
  std::vector<SoupPoint> points;
  std::vector<SoupFace> polygons;
  for (const Vec3& p : vertices) points.emplace_back(p.x(), p.y(), p.z());
  for (const Face& face : faces) polygons.emplace_back(face.begin(), face.end());
  return CGAL::IO::write_polygon_soup(path.string(), points, polygons,
                                      CGAL::parameters::stream_precision(17).use_binary_mode(true));
}

bool write_openmesh(const std::filesystem::path& path, std::span<const Vec3> vertices,
                    std::span<const Face> faces) {
  HalfEdgeMesh target;
  for (const Vec3& p : vertices) target.add_vertex(OpenMesh::Vec3d(p.x(), p.y(), p.z()));
  for (const auto& [a, b, c] : faces)
    if (!target
             .add_face(target.vertex_handle(static_cast<unsigned>(a)),
                       target.vertex_handle(static_cast<unsigned>(b)),
                       target.vertex_handle(static_cast<unsigned>(c)))
             .is_valid())
      throw FileError(path.string() +
                      " cannot hold the mesh: it is not manifold (write .ply, .off or .obj)");
  return OpenMesh::IO::write_mesh(target, path.string(), OpenMesh::IO::Options::Binary);
}

}  // namespace

MeshArrays read_mesh(const std::filesystem::path& path) {
  check_suffix(path);
  if (!std::filesystem::is_regular_file(path))
    throw FileError(path.string() + " is not a readable file");
  MeshArrays mesh;
  if (!(is_soup(suffix_of(path)) ? read_soup(path, mesh) : read_openmesh(path, mesh)))
    throw FileError(path.string() +
                    " could not be read as a mesh: it is broken or of another format");
  if (mesh.faces.empty()) throw FileError(path.string() + " holds no faces");
  return mesh;
}

void write_mesh(const std::filesystem::path& path, std::span<const Vec3> vertices,
                std::span<const Face> faces) {
  check_suffix(path);
  if (!(is_soup(suffix_of(path)) ? write_soup(path, vertices, faces)
                                 : write_openmesh(path, vertices, faces)))
    throw FileError(path.string() + " could not be written");
}

}  // namespace dapple
