// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <dapple/surface.hpp>
#include <numeric>
#include <string>
#include <unordered_map>

#include "density_unit.hpp"
#include "hexagonal.hpp"
#include "integrate.hpp"
#include "morton.hpp"
#include "parallel.hpp"
#include "validate.hpp"
#include "weld.hpp"

namespace dapple {
namespace {

// A face thinner than this against its longest edge has no usable normal; it counts as having no
// area.
constexpr double kDegenerate = 1e-14;
constexpr std::size_t kGrain = 4096;  // faces a chunk

void check_sizes(std::size_t vertices, std::size_t faces) {
  if (faces > kMostSurfaceFaces)
    throw SurfaceError("faces has " + std::to_string(faces) + " rows: at most " +
                       std::to_string(kMostSurfaceFaces) + " are possible");
  if (vertices > kMostVertices)
    throw SurfaceError("vertices has " + std::to_string(vertices) + " rows: at most " +
                       std::to_string(kMostVertices) + " are possible");
}

/// How many values a density has, and how the message says so.
struct DensityRule {
  std::size_t count;
  const char* where;
  const char* rule;
};

DensityRule density_rule(DensityAt at, std::size_t vertex_count, std::size_t face_count) {
  switch (at) {
    case DensityAt::kFaces:
      return {face_count, "faces", "one per face is needed"};
    case DensityAt::kCorners:
      return {3 * face_count, "corners", "three per face are needed"};
    case DensityAt::kVertices:
      break;
  }
  return {vertex_count, "vertices", "one per vertex is needed"};
}

std::string density_entry(DensityAt at, std::size_t index) {
  return at == DensityAt::kCorners
             ? "density[" + std::to_string(index / 3) + ", " + std::to_string(index % 3) + "]"
             : entry("density", index);
}

void check_density(const Density& density, std::size_t vertex_count, std::size_t face_count) {
  if (density.values.empty()) return;
  const auto [count, where, rule] = density_rule(density.at, vertex_count, face_count);
  if (density.values.size() != count)
    throw SurfaceError("density has " + std::to_string(density.values.size()) + " values for " +
                       std::to_string(count) + " " + where + ": " + rule);
  for (std::size_t k = 0; k < count; ++k)
    if (!std::isfinite(density.values[k]) || density.values[k] < 0.0)
      throw SurfaceError(density_entry(density.at, k) + " is " + number(density.values[k]) +
                         ": it must be finite and >= 0");
}

void check_mesh(std::span<const Vec3> vertices, std::span<const Face> faces,
                const Density& density) {
  check_sizes(vertices.size(), faces.size());
  check_finite<SurfaceError>("vertices", vertices);
  check_faces(faces, vertices.size());
  check_density(density, vertices.size(), faces.size());
}

struct HalfEdgeKey {
  std::int32_t low, high, half_edge;
  auto operator<=>(const HalfEdgeKey&) const = default;
};

/// Link the half-edges of equal keys into rings, in the order of their faces.
std::vector<std::int32_t> link_rings(std::vector<HalfEdgeKey> keys) {
  std::sort(keys.begin(), keys.end());
  std::vector<std::int32_t> next(keys.size());
  for (std::size_t first = 0; first < keys.size();) {
    std::size_t last = first;
    while (last + 1 < keys.size() && keys[last + 1].low == keys[first].low &&
           keys[last + 1].high == keys[first].high)
      ++last;
    for (std::size_t k = first; k <= last; ++k)
      next[static_cast<std::size_t>(keys[k].half_edge)] = keys[k == last ? first : k + 1].half_edge;
    first = last + 1;
  }
  return next;
}

/// Link the half-edges that share an (undirected) edge.
std::vector<std::int32_t> link_edges(std::span<const Face> faces) {
  std::vector<HalfEdgeKey> keys;
  keys.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces[f][k], faces[f][(k + 1) % 3]);
      keys.push_back({low, high, static_cast<std::int32_t>(3 * f + k)});
    }
  return link_rings(std::move(keys));
}

/// Number the sets of faces connected over edges, in the order of their first faces.
void find_components(SurfaceConnectivity& mesh) {
  mesh.component.assign(mesh.faces.size(), -1);
  std::vector<std::int32_t> pending;
  const auto push = [&](std::int32_t face) {
    std::int32_t& component = mesh.component[static_cast<std::size_t>(face)];
    if (component >= 0) return;
    component = mesh.components;
    pending.push_back(face);
  };
  const auto next = [&](std::int32_t h) {
    return mesh.next_around_edge[static_cast<std::size_t>(h)];
  };
  for (std::size_t start = 0; start < mesh.faces.size(); ++start) {
    if (mesh.component[start] >= 0) continue;
    push(static_cast<std::int32_t>(start));
    while (!pending.empty()) {
      const std::int32_t face = pending.back();
      pending.pop_back();
      for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h)
        for (std::int32_t g = next(h); g != h; g = next(g)) push(g / 3);
    }
    ++mesh.components;
  }
}

std::vector<std::int32_t> invert(std::span<const std::int32_t> order) {
  std::vector<std::int32_t> inverse(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    inverse[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
  return inverse;
}

// `order` lists the caller's indices of groups of `width` values, in the surface's own order.

template <typename T>
std::vector<T> gather(std::span<const T> values, std::span<const std::int32_t> order,
                      std::size_t width = 1) {
  std::vector<T> result;
  result.reserve(values.size());
  if (!values.empty())
    for (const std::int32_t group : order)
      for (std::size_t k = 0; k < width; ++k)
        result.push_back(values[width * static_cast<std::size_t>(group) + k]);
  return result;
}

double diagonal_of(std::span<const Vec3> vertices) {
  Vec3 low = vertices[0], high = vertices[0];
  for (const Vec3& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return (high - low).stableNorm();
}

/// Link the edges, those at the same place too where `weld` asks for it.
void link(std::span<const Vec3> vertices, std::optional<double> weld, SurfaceConnectivity& mesh) {
  mesh.weld = weld;
  mesh.next_around_edge = link_edges(mesh.faces);
  mesh.welded_vertex.resize(vertices.size());
  std::iota(mesh.welded_vertex.begin(), mesh.welded_vertex.end(), 0);
  const double tolerance = weld ? *weld * diagonal_of(vertices) : 0.0;
  if (weld && std::isfinite(tolerance))  // if not, the area is not finite either
    mesh.welded_vertex = weld_borders(gather(vertices, mesh.original_vertex), tolerance, mesh);
}

/// Link the edges that the caller knows to be one.
void link(const Joints& joints, SurfaceConnectivity& mesh) {
  std::vector<HalfEdgeKey> keys;
  for (std::size_t h = 0; h < joints.edges.size(); ++h) {
    const auto face = static_cast<std::size_t>(mesh.original_face[h / 3]);
    const std::int32_t edge = joints.edges[3 * face + h % 3];
    keys.push_back({edge, edge, static_cast<std::int32_t>(h)});
  }
  mesh.next_around_edge = link_rings(std::move(keys));
  const std::vector<std::int32_t> places = gather(joints.places, mesh.original_vertex);
  std::unordered_map<std::int32_t, std::int32_t> lowest;
  for (std::size_t v = 0; v < places.size(); ++v)
    mesh.welded_vertex.push_back(
        lowest.try_emplace(places[v], static_cast<std::int32_t>(v)).first->second);
}

void check_joints(const Joints& joints, std::size_t vertices, std::size_t faces) {
  if (joints.edges.size() != 3 * faces || joints.places.size() != vertices)
    throw SurfaceError("joints has " + std::to_string(joints.edges.size()) + " edges and " +
                       std::to_string(joints.places.size()) + " places for " +
                       std::to_string(faces) + " faces and " + std::to_string(vertices) +
                       " vertices: three per face and one per vertex are needed");
}

/// \param link_faces called with the ordered faces
template <typename Link>
std::shared_ptr<const SurfaceConnectivity> connect(std::span<const Vec3> vertices,
                                                   std::span<const Face> faces,
                                                   const Link& link_faces) {
  auto result = std::make_shared<SurfaceConnectivity>();
  result->original_vertex = morton_order(vertices);
  const std::vector<std::int32_t> ordered_vertex = invert(result->original_vertex);
  std::vector<Vec3> centroids(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return vertices[static_cast<std::size_t>(faces[f][k])];
    };
    centroids[f] = (corner(0) + corner(1) + corner(2)) / 3.0;
  }
  result->original_face = morton_order(centroids);
  result->ordered_face = invert(result->original_face);
  result->faces.reserve(faces.size());
  for (const std::int32_t f : result->original_face) {
    const Face& face = faces[static_cast<std::size_t>(f)];
    const auto ordered = [&](std::size_t k) {
      return ordered_vertex[static_cast<std::size_t>(face[k])];
    };
    result->faces.push_back({ordered(0), ordered(1), ordered(2)});
  }
  link_faces(*result);
  find_components(*result);
  return result;
}

template <typename T>
std::vector<T> scatter(std::span<const T> values, std::span<const std::int32_t> order,
                       std::size_t width = 1) {
  std::vector<T> result(values.size());
  for (std::size_t k = 0; k < values.size(); ++k)
    result[width * static_cast<std::size_t>(order[k / width]) + k % width] = values[k];
  return result;
}

const std::vector<std::int32_t>& density_order(const SurfaceConnectivity& mesh, DensityAt at) {
  return at == DensityAt::kVertices ? mesh.original_vertex : mesh.original_face;
}

std::size_t density_width(DensityAt at) { return at == DensityAt::kCorners ? 3 : 1; }

std::shared_ptr<const SurfaceDensity> ordered(const SurfaceConnectivity& mesh,
                                              const Density& density) {
  return std::make_shared<SurfaceDensity>(SurfaceDensity{
      density.at,
      gather(density.values, density_order(mesh, density.at), density_width(density.at))});
}

std::shared_ptr<const std::vector<Vec3>> ordered(const SurfaceConnectivity& mesh,
                                                 std::span<const Vec3> vertices) {
  return std::make_shared<const std::vector<Vec3>>(gather(vertices, mesh.original_vertex));
}

/// Geometry of the triangle x with the density f at its corners.
FaceGeometry measure_face(const std::array<Vec3, 3>& x, const Vec3& f, bool uniform) {
  FaceGeometry face;
  face.centroid = (x[0] + x[1] + x[2]) / 3.0;
  const Vec3 cross = (x[1] - x[0]).cross(x[2] - x[0]);
  const double longest = std::max(
      {(x[1] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm(), (x[0] - x[2]).squaredNorm()});
  const double twice_area = cross.norm();
  if (std::isfinite(longest) && !(twice_area > kDegenerate * longest)) return face;
  face.normal = cross / twice_area;
  const std::array<Vec3, 3> y = {x[0] - face.centroid, x[1] - face.centroid, x[2] - face.centroid};
  if (uniform) {
    add_uniform_triangle(face.moments, 0.5 * twice_area, y[0], y[1], y[2]);
    finish_uniform(face.moments);
    return face;
  }
  add_linear_triangle(face.moments, 0.5 * twice_area, y[0], y[1], y[2], f[0], f[1], f[2]);
  for (std::size_t k = 0; k < 3;
       ++k)  // the gradient of a hat function is normal x opposite edge / (2 area)
    face.density_gradient += f[static_cast<Eigen::Index>(k)] / twice_area *
                             face.normal.cross(x[(k + 2) % 3] - x[(k + 1) % 3]);
  return face;
}

void check_total(const SurfaceGeometry& geometry) {
  if (!std::isfinite(geometry.area)) throw SurfaceError("vertices span an area that is not finite");
  if (!(geometry.area > 0.0))
    throw SurfaceError("faces have no area: all triangles are degenerate");
  if (!(geometry.mass > 0.0))
    throw SurfaceError("density is 0 wherever the faces have area: nothing can be placed");
}

double angle_at(const Vec3& apex, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - apex;
  const Vec3 v = b - apex;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 std::span<const double> density)
    : Surface(vertices, faces, Density{DensityAt::kVertices, density}) {}

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 const Density& density, const SurfaceOptions& options) {
  check_mesh(vertices, faces, density);
  if (options.weld) check_at_least<SurfaceError>("weld", *options.weld, 0.0);
  connectivity_ = connect(vertices, faces,
                          [&](SurfaceConnectivity& mesh) { link(vertices, options.weld, mesh); });
  vertices_ = ordered(*connectivity_, vertices);
  density_ = ordered(*connectivity_, density);
  measure();
}

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 const Density& density, const Joints& joints) {
  check_mesh(vertices, faces, density);
  check_joints(joints, vertices.size(), faces.size());
  connectivity_ = connect(vertices, faces, [&](SurfaceConnectivity& mesh) { link(joints, mesh); });
  vertices_ = ordered(*connectivity_, vertices);
  density_ = ordered(*connectivity_, density);
  measure();
}

Surface Surface::deformed(std::span<const Vec3> vertices) const {
  if (vertices.size() != vertex_count())
    throw SurfaceError("vertices has " + std::to_string(vertices.size()) +
                       " rows; the surface has " + std::to_string(vertex_count()) +
                       " vertices, and deforming keeps their number");
  check_finite<SurfaceError>("vertices", vertices);
  Surface result = *this;
  result.vertices_ = ordered(*connectivity_, vertices);
  result.measure();
  return result;
}

Surface Surface::with_density(const Density& density) const {
  check_density(density, vertex_count(), face_count());
  Surface result = *this;
  result.density_ = ordered(*connectivity_, density);
  result.measure();
  return result;
}

void Surface::measure() {
  auto result = std::make_shared<SurfaceGeometry>();
  const double unit = result->density_unit = find_density_unit();
  result->faces.resize(face_count());
  parallel_chunks(result->faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const auto face = static_cast<std::int32_t>(f);
      const auto [a, b, c] = corners(face);
      result->faces[f] =
          measure_face({vertex(a), vertex(b), vertex(c)}, unit * densities(face), uniform());
    }
  });
  for (const FaceGeometry& face : result->faces) {
    result->area += face.moments.area;
    result->mass += face.moments.capacity;
  }
  check_total(*result);
  result->mass /= unit;
  geometry_ = std::move(result);
}

double Surface::find_density_unit() const {
  if (uniform()) return 1.0;
  const double most = *std::max_element(density_->values.begin(), density_->values.end());
  if (dapple::density_unit(most, 1.0) == 1.0) return 1.0;
  double area = 0.0, sum = 0.0;  // the largest value may lie where there is no area
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(face_count()); ++f) {
    const auto [a, b, c] = corners(f);
    const double twice = (vertex(b) - vertex(a)).cross(vertex(c) - vertex(a)).norm();
    area += twice;
    sum += twice * (densities(f) / most).mean();
  }
  return dapple::density_unit(most, sum / area);
}

Vec3 Surface::densities(std::int32_t ordered) const {
  const std::vector<double>& values = density_->values;
  if (values.empty()) return Vec3::Ones();
  const auto f = static_cast<std::size_t>(ordered);
  if (density_->at == DensityAt::kFaces) return Vec3::Constant(values[f]);
  if (density_->at == DensityAt::kCorners)
    return {values[3 * f], values[3 * f + 1], values[3 * f + 2]};
  const auto value = [&](std::int32_t v) { return values[static_cast<std::size_t>(v)]; };
  const auto [a, b, c] = corners(ordered);
  return {value(a), value(b), value(c)};
}

std::vector<Vec3> Surface::vertices() const {
  return scatter<Vec3>(*vertices_, connectivity_->original_vertex);
}

std::vector<double> Surface::density() const {
  return scatter<double>(density_->values, density_order(*connectivity_, density_->at),
                         density_width(density_->at));
}

template <typename Corners>
std::vector<Face> Surface::original_faces(const Corners& corners_of) const {
  std::vector<Face> result(face_count());
  for (std::size_t f = 0; f < face_count(); ++f) {
    const Face corners = corners_of(static_cast<std::int32_t>(f));
    for (std::size_t k = 0; k < 3; ++k)
      result[static_cast<std::size_t>(connectivity_->original_face[f])][k] =
          connectivity_->original_vertex[static_cast<std::size_t>(corners[k])];
  }
  return result;
}

std::vector<Face> Surface::faces() const {
  return original_faces([this](std::int32_t f) { return corners(f); });
}

std::vector<Face> Surface::welded_faces() const {
  return original_faces([this](std::int32_t f) { return welded_corners(f); });
}

std::vector<std::int32_t> Surface::distinct_vertices() const {
  std::vector<bool> stands_for_itself(vertex_count(), false);  // by the caller's indices
  for (std::size_t v = 0; v < vertex_count(); ++v)
    if (const auto k = static_cast<std::int32_t>(v); welded(k) == k)
      stands_for_itself[static_cast<std::size_t>(connectivity_->original_vertex[v])] = true;
  std::vector<std::int32_t> result;
  for (std::size_t v = 0; v < stands_for_itself.size(); ++v)
    if (stands_for_itself[v]) result.push_back(static_cast<std::int32_t>(v));
  return result;
}

Vec3 Surface::point(std::int32_t face, const Vec3& weights) const {
  const auto [a, b, c] = corners(ordered_face(face));
  return weights[0] * vertex(a) + weights[1] * vertex(b) + weights[2] * vertex(c);
}

/// The angle at each corner that is a vertex of one of the faces (caller's indices); 0 elsewhere.
std::vector<double> Surface::corner_angles(std::span<const std::int32_t> of) const {
  std::vector<bool> wanted(vertex_count(), false);
  for (const std::int32_t face : of)
    for (const std::int32_t v : corners(ordered_face(face)))
      wanted[static_cast<std::size_t>(v)] = true;
  std::vector<double> angles(3 * face_count(), 0.0);
  parallel_chunks(angles.size(), 3 * kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Face& v = connectivity_->faces[c / 3];
      if (wanted[static_cast<std::size_t>(v[c % 3])])
        angles[c] = angle_at(vertex(v[c % 3]), vertex(v[(c + 1) % 3]), vertex(v[(c + 2) % 3]));
    }
  });
  return angles;
}

std::vector<Vec3> Surface::normals(std::span<const std::int32_t> faces,
                                   std::span<const Vec3> weights) const {
  check_same_length("weights", weights.size(), "faces", faces.size());
  check_face_indices("faces", faces, *this);
  const std::vector<double> angles = corner_angles(faces);
  std::vector<Vec3> at_vertices(vertex_count(), Vec3::Zero());
  for (std::size_t c = 0; c < angles.size(); ++c)
    at_vertices[static_cast<std::size_t>(connectivity_->faces[c / 3][c % 3])] +=
        angles[c] * geometry_->faces[c / 3].normal;
  for (Vec3& normal : at_vertices) normal.stableNormalize();
  std::vector<Vec3> result(faces.size());
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const std::int32_t f = ordered_face(faces[k]);
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c)
      sum += weights[k][static_cast<Eigen::Index>(c)] *
             at_vertices[static_cast<std::size_t>(corners(f)[c])];
    // Where the vertex normals cancel (a sheet folded flat) the face's own is the best there is.
    result[k] = sum.norm() > 1e-6 ? sum.normalized() : geometry(f).normal;
  }
  return result;
}

double Surface::spacing(std::size_t count) const {
  return hexagonal_spacing(area() / static_cast<double>(std::max<std::size_t>(count, 1)));
}

}  // namespace dapple
