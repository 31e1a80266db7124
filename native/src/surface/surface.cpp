// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <dapple/surface.hpp>
#include <string>

#include "base/elementary.hpp"
#include "base/hexagonal.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/reorder.hpp"
#include "base/validate.hpp"
#include "base/vectors.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;  // faces a chunk
constexpr double kConnected = 0.85;   // of the progress: only the faces are left to be measured

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

void check_joints(const Joints& joints, std::size_t vertices, std::size_t faces) {
  if (joints.edges.size() != 3 * faces || joints.places.size() != vertices)
    throw SurfaceError("joints has " + std::to_string(joints.edges.size()) + " edges and " +
                       std::to_string(joints.places.size()) + " places for " +
                       std::to_string(faces) + " faces and " + std::to_string(vertices) +
                       " vertices: three per face and one per vertex are needed");
}

double angle_at(const Vec3& apex, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - apex;
  const Vec3 v = b - apex;
  return angle_of(u.cross(v).norm(), u.dot(v));
}

/// Ordered faces of ordered vertices, in the caller's order of both.
template <typename Corners>
std::vector<Face> original_faces(const Connectivity& mesh, const Corners& corners_of) {
  std::vector<Face> result(mesh.faces.size());
  for (std::size_t f = 0; f < result.size(); ++f) {
    const Face corners = corners_of(nth_face(f));
    for (std::size_t k = 0; k < 3; ++k)
      result[static_cast<std::size_t>(mesh.original_face[f])][k] =
          mesh.original_vertex[static_cast<std::size_t>(corners[k])];
  }
  return result;
}

/// Whether each vertex is one of the faces' (caller's indices).
std::vector<bool> vertices_of(const OrderedSurface& mesh, std::span<const std::int32_t> faces) {
  std::vector<bool> result(mesh.vertex_count(), false);
  for (const std::int32_t face : faces)
    for (const std::int32_t v : mesh.corners(mesh.ordered_face(face)))
      result[static_cast<std::size_t>(v)] = true;
  return result;
}

/// The normal of a face, weighted by its angle at a vertex of it.
struct WeightedNormal {
  std::int32_t vertex;
  Vec3 normal;
};

/// Those around the wanted vertices, chunk by chunk of the faces.
std::vector<std::vector<WeightedNormal>> weighted_normals(const OrderedSurface& mesh,
                                                          const std::vector<bool>& wanted) {
  std::vector<std::vector<WeightedNormal>> result((mesh.face_count() + kGrain - 1) / kGrain);
  parallel_chunks(mesh.face_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Face& v = mesh.corners(nth_face(f));
      for (std::size_t k = 0; k < 3; ++k) {
        if (!wanted[static_cast<std::size_t>(v[k])]) continue;
        const double angle =
            angle_at(mesh.vertex(v[k]), mesh.vertex(v[(k + 1) % 3]), mesh.vertex(v[(k + 2) % 3]));
        result[begin / kGrain].push_back({v[k], angle * mesh.geometry(nth_face(f)).normal});
      }
    }
  });
  return result;
}

/// Unit normals at the vertices, weighted by the angles of the faces; 0 where nobody asks.
std::vector<Vec3> vertex_normals(const OrderedSurface& mesh, std::span<const std::int32_t> of) {
  std::vector<Vec3> result(mesh.vertex_count(), Vec3::Zero());
  for (const auto& chunk : weighted_normals(mesh, vertices_of(mesh, of)))
    for (const WeightedNormal& part : chunk)
      result[static_cast<std::size_t>(part.vertex)] += part.normal;
  for_each_vector(result.size(), [&](std::size_t v) { result[v].stableNormalize(); });
  return result;
}

}  // namespace

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 std::span<const double> density)
    : Surface(vertices, faces, Density{DensityAt::kVertices, density}) {}

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 const Density& density, const SurfaceOptions& options, Context* context) {
  check_mesh(vertices, faces, density);
  if (options.weld) check_at_least<SurfaceError>("weld", *options.weld, 0.0);
  Stretch connecting(context, 0.0, kConnected), measuring(context, kConnected, 1.0);
  ordered_ = std::make_shared<const OrderedSurface>(
      vertices, connect(vertices, faces, options.weld, connecting.context()), density,
      measuring.context());
  if (context) context->advance(1.0);
}

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 const Density& density, const Joints& joints, Context* context) {
  check_mesh(vertices, faces, density);
  check_joints(joints, vertices.size(), faces.size());
  Stretch connecting(context, 0.0, kConnected), measuring(context, kConnected, 1.0);
  ordered_ = std::make_shared<const OrderedSurface>(
      vertices, connect(vertices, faces, joints.edges, joints.places, connecting.context()),
      density, measuring.context());
  if (context) context->advance(1.0);
}

Surface Surface::deformed(std::span<const Vec3> vertices, Context* context) const {
  if (vertices.size() != vertex_count())
    throw SurfaceError("vertices has " + std::to_string(vertices.size()) +
                       " rows; the surface has " + std::to_string(vertex_count()) +
                       " vertices, and deforming keeps their number");
  check_finite<SurfaceError>("vertices", vertices);
  Surface result = *this;
  result.ordered_ = std::make_shared<const OrderedSurface>(ordered_->deformed(vertices, context));
  if (context) context->advance(1.0);
  return result;
}

Surface Surface::with_density(const Density& density, Context* context) const {
  check_density(density, vertex_count(), face_count());
  Surface result = *this;
  result.ordered_ =
      std::make_shared<const OrderedSurface>(ordered_->with_density(density, context));
  if (context) context->advance(1.0);
  return result;
}

std::size_t Surface::vertex_count() const { return ordered_->vertex_count(); }
std::size_t Surface::face_count() const { return ordered_->face_count(); }
double Surface::area() const { return ordered_->area(); }
double Surface::mass() const { return ordered_->mass(); }
std::optional<double> Surface::weld() const { return ordered_->connectivity().weld; }
bool Surface::uniform() const { return ordered_->density().empty(); }
DensityAt Surface::density_at() const { return ordered_->density_at(); }

bool Surface::same_faces(const Surface& other) const {
  return &ordered_->connectivity() == &other.ordered_->connectivity();
}

std::vector<Vec3> Surface::vertices() const {
  return scatter<Vec3>(ordered_->vertices(), ordered_->connectivity().original_vertex);
}

std::vector<double> Surface::density() const {
  const auto [order, width] = density_layout(ordered_->connectivity(), density_at());
  return scatter<double>(ordered_->density(), order, width);
}

std::vector<Face> Surface::faces() const {
  return original_faces(ordered_->connectivity(),
                        [this](OrderedFace f) { return ordered_->corners(f); });
}

std::vector<Face> Surface::welded_faces() const {
  return original_faces(ordered_->connectivity(),
                        [this](OrderedFace f) { return ordered_->welded_corners(f); });
}

std::vector<std::int32_t> Surface::distinct_vertices() const {
  const std::vector<std::int32_t>& original = ordered_->connectivity().original_vertex;
  std::vector<bool> stands_for_itself(vertex_count(), false);  // by the caller's indices
  for (const Face& face : ordered_->connectivity().faces)
    for (const std::int32_t v : face) {
      const auto k = static_cast<std::size_t>(ordered_->welded(v));
      stands_for_itself[static_cast<std::size_t>(original[k])] = true;
    }
  std::vector<std::int32_t> result;
  for (std::size_t v = 0; v < stands_for_itself.size(); ++v)
    if (stands_for_itself[v]) result.push_back(static_cast<std::int32_t>(v));
  return result;
}

Vec3 Surface::point(std::int32_t face, const Vec3& weights) const {
  return ordered_->point(ordered_->ordered_face(face), weights);
}

std::vector<Vec3> Surface::normals(std::span<const std::int32_t> faces,
                                   std::span<const Vec3> weights) const {
  check_same_length("weights", weights.size(), "faces", faces.size());
  check_face_indices("faces", faces, face_count());
  const std::vector<Vec3> at_vertices = vertex_normals(*ordered_, faces);
  std::vector<Vec3> result(faces.size());
  for_each_vector(faces.size(), [&](std::size_t k) {
    const OrderedFace f = ordered_->ordered_face(faces[k]);
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c)
      sum += weights[k][static_cast<Eigen::Index>(c)] *
             at_vertices[static_cast<std::size_t>(ordered_->corners(f)[c])];
    // Where the vertex normals cancel (a sheet folded flat) the face's own is the best there is; a
    // face without area has none.
    const Vec3& normal = ordered_->geometry(f).normal;
    result[k] = sum.norm() > 1e-6 ? sum.normalized() : normal.isZero(0.0) ? Vec3(0, 0, 1) : normal;
  });
  return result;
}

double Surface::spacing(std::size_t count) const {
  return hexagonal_spacing(area() / static_cast<double>(std::max<std::size_t>(count, 1)));
}

}  // namespace dapple
