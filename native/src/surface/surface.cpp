// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <dapple/surface.hpp>
#include <numeric>
#include <string>

#include "base/hexagonal.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/reorder.hpp"
#include "base/validate.hpp"
#include "base/vectors.hpp"
#include "surface/corner_normals.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// The largest density on faces that have an area.
double largest_density(const OrderedSurface& surface) {
  double largest = 0.0;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const auto face = static_cast<OrderedFace>(f);
    if (!surface.geometry(face).normal.isZero(0.0))
      largest = std::max(largest, surface.densities(face).maxCoeff());
  }
  return largest;
}

constexpr double kConnected = 0.85;  // share of the progress before the faces are measured

void check_sizes(std::size_t vertices, std::size_t faces) {
  if (faces > kMostSurfaceFaces)
    throw SurfaceError("faces has " + std::to_string(faces) + " rows: at most " +
                       std::to_string(kMostSurfaceFaces) + " are possible");
  if (vertices > kMostVertices)
    throw SurfaceError("vertices has " + std::to_string(vertices) + " rows: at most " +
                       std::to_string(kMostVertices) + " are possible");
}

/// The number of values of a density, and its description in messages.
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
  if (!joints.bodies.empty() && joints.bodies.size() != faces)
    throw SurfaceError("joints has " + std::to_string(joints.bodies.size()) + " bodies for " +
                       std::to_string(faces) + " faces: one per face, or none, is needed");
}

void check_sharp_angle(double degrees) {
  if (!(degrees >= 0.0 && degrees <= 180.0))
    throw SurfaceError("sharp_angle is " + number(degrees) + ": it must be in 0..180 degrees");
}

void check_normals(std::span<const Vec3> corners, std::size_t face_count) {
  if (corners.size() != 3 * face_count)
    throw SurfaceError("normals has " + std::to_string(corners.size()) + " rows for " +
                       std::to_string(3 * face_count) + " corners: three per face are needed");
  check_finite<SurfaceError>("normals", corners);
}

std::shared_ptr<const OrderedSurface> shaded_by_angle(const OrderedSurface& plain, double degrees) {
  return std::make_shared<const OrderedSurface>(plain.shaded(shading_by_angle(plain, degrees)));
}

/// Normalizes vectors; zero vectors are unchanged.
std::vector<Vec3> unit_normals(std::span<const Vec3> corners) {
  std::vector<Vec3> result(corners.begin(), corners.end());
  for_each_vector(result.size(), [&](std::size_t k) { result[k].stableNormalize(); });
  return result;
}

std::shared_ptr<const OrderedSurface> shaded_by_normals(const OrderedSurface& plain, double degrees,
                                                        std::span<const Vec3> corners) {
  return std::make_shared<const OrderedSurface>(
      plain.shaded(shading_of_normals(plain, degrees, unit_normals(corners))));
}

/// Ordered faces of ordered vertices, converted to the caller's order of both.
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

}  // namespace

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 std::span<const double> density)
    : Surface(vertices, faces, Density{DensityAt::kVertices, density}) {}

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 const Density& density, const SurfaceOptions& options, Context* context) {
  check_mesh(vertices, faces, density);
  if (options.weld) check_at_least<SurfaceError>("weld", *options.weld, 0.0);
  check_sharp_angle(options.sharp_angle);
  Stretch connecting(context, 0.0, kConnected), measuring(context, kConnected, 1.0);
  const OrderedSurface plain(
      vertices, connect(vertices, faces, options.weld, options.merge_doubled, connecting.context()),
      density, measuring.context());
  ordered_ = shaded_by_angle(plain, options.sharp_angle);
  if (context) context->advance(1.0);
}

Surface::Surface(std::span<const Vec3> vertices, std::span<const Face> faces,
                 const Density& density, const Joints& joints, double sharp_angle,
                 bool merge_doubled, Context* context, std::span<const Vec3> normals) {
  check_mesh(vertices, faces, density);
  check_joints(joints, vertices.size(), faces.size());
  check_sharp_angle(sharp_angle);
  if (!normals.empty()) check_normals(normals, faces.size());
  Stretch connecting(context, 0.0, kConnected), measuring(context, kConnected, 1.0);
  const OrderedSurface plain(vertices,
                             connect(vertices, faces, joints, merge_doubled, connecting.context()),
                             density, measuring.context());
  ordered_ = normals.empty() ? shaded_by_angle(plain, sharp_angle)
                             : shaded_by_normals(plain, sharp_angle, normals);
  if (context) context->advance(1.0);
}

Surface Surface::deformed(std::span<const Vec3> vertices, Context* context) const {
  if (vertices.size() != vertex_count())
    throw SurfaceError("vertices has " + std::to_string(vertices.size()) +
                       " rows; the surface has " + std::to_string(vertex_count()) +
                       " vertices, and deforming keeps their number");
  check_finite<SurfaceError>("vertices", vertices);
  if (context) context->check();
  Surface result = *this;
  if (!ordered_->has_vertices(vertices))
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

Surface Surface::with_normals(std::span<const Vec3> corners) const {
  check_normals(corners, face_count());
  Surface result = *this;
  result.ordered_ = shaded_by_normals(*ordered_, sharp_angle(), corners);
  return result;
}

std::size_t Surface::vertex_count() const { return ordered_->vertex_count(); }
std::size_t Surface::face_count() const { return ordered_->face_count(); }
std::size_t Surface::doubled_faces() const { return ordered_->connectivity().doubled.size(); }
bool Surface::merge_doubled() const { return ordered_->connectivity().merge_doubled; }
double Surface::area() const { return ordered_->area(); }
double Surface::capacity() const { return ordered_->capacity(); }
std::optional<double> Surface::weld() const { return ordered_->connectivity().weld; }
double Surface::sharp_angle() const { return ordered_->shading().sharp_angle; }
bool Surface::has_normals() const { return !ordered_->shading().given.empty(); }
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
  for (std::size_t f = 0; f < face_count(); ++f)
    for (const std::int32_t v : ordered_->corners(nth_face(f))) {
      if (!ordered_->counts(nth_face(f))) break;
      const auto k = static_cast<std::size_t>(ordered_->welded(v));
      stands_for_itself[static_cast<std::size_t>(original[k])] = true;
    }
  std::vector<std::int32_t> result;
  for (std::size_t v = 0; v < stands_for_itself.size(); ++v)
    if (stands_for_itself[v]) result.push_back(static_cast<std::int32_t>(v));
  return result;
}

void Surface::move_to_counted(std::span<std::int32_t> faces, std::span<Vec3> weights) const {
  if (doubled_faces() == 0) return;
  for_each_vector(faces.size(), [&](std::size_t k) {
    const DoubledFace* doubled = ordered_->doubled_face(ordered_->ordered_face(faces[k]));
    if (!doubled) return;
    faces[k] = ordered_->original_face(doubled->counted);
    const Vec3 own = weights[k];
    for (std::size_t c = 0; c < 3; ++c)
      weights[k][doubled->corners[c]] = own[static_cast<Eigen::Index>(c)];
  });
}

Vec3 Surface::point(std::int32_t face, const Vec3& weights) const {
  return ordered_->point(ordered_->ordered_face(face), weights);
}

std::vector<Vec3> Surface::normals(std::span<const std::int32_t> faces,
                                   std::span<const Vec3> weights) const {
  check_same_length("weights", weights.size(), "faces", faces.size());
  check_face_indices("faces", faces, face_count());
  if (doubled_faces() > 0) {
    std::vector<std::int32_t> counted(faces.begin(), faces.end());
    std::vector<Vec3> there(weights.begin(), weights.end());
    move_to_counted(counted, there);
    return counted_normals(counted, there);
  }
  return counted_normals(faces, weights);
}

std::vector<Vec3> Surface::counted_normals(std::span<const std::int32_t> faces,
                                           std::span<const Vec3> weights) const {
  const CornerNormals at_corners(*ordered_, faces);
  std::vector<Vec3> result(faces.size());
  for_each_vector(faces.size(), [&](std::size_t k) {
    result[k] = at_corners.between(ordered_->ordered_face(faces[k]), weights[k]);
  });
  return result;
}

std::vector<Vec3> Surface::corner_normals() const {
  std::vector<std::int32_t> all(face_count());
  std::iota(all.begin(), all.end(), 0);
  const CornerNormals at_corners(*ordered_, all);
  std::vector<Vec3> result(3 * all.size());
  for_each_vector(result.size(), [&](std::size_t k) {
    OrderedFace f = ordered_->ordered_face(static_cast<std::int32_t>(k / 3));
    std::size_t corner = k % 3;
    if (const DoubledFace* doubled = ordered_->doubled_face(f)) {
      f = doubled->counted;
      corner = doubled->corners[corner];
    }
    result[k] = at_corners.direction_at(f, static_cast<std::int32_t>(corner));
  });
  return result;
}

double Surface::spacing(std::size_t count) const {
  return hexagonal_spacing(area() / static_cast<double>(std::max<std::size_t>(count, 1)));
}

std::size_t Surface::count(double spacing) const {
  check_positive("spacing", spacing);
  const double area = capacity() / largest_density(*ordered_);
  const double samples = std::round(2.0 * area / (std::numbers::sqrt3 * spacing * spacing));
  if (!(samples <= static_cast<double>(kMostSamples)))
    throw ArgumentError("spacing is " + number(spacing) + ": the surface would have " +
                        number(samples) + " samples, at most " + std::to_string(kMostSamples) +
                        " are possible");
  return std::max<std::size_t>(static_cast<std::size_t>(samples), 1);
}

}  // namespace dapple
