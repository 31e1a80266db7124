// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/projector.hpp>

#if DAPPLE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel.hpp"
#include "triangle.hpp"
#include "validate.hpp"

namespace dapple {
namespace {

// Embree sees the surface in single precision, in [-1, 1]: a coordinate is off by at most 2^-24, a
// distance by a few times that. Everything within this much of the best distance is compared in
// double precision.
constexpr double kMargin = 2e-6;

struct Device {
  RTCDevice handle = rtcNewDevice(nullptr);
  Device() {
    if (!handle) throw std::runtime_error("Embree could not create a device");
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() { rtcReleaseDevice(handle); }
};

}  // namespace

struct Projector::Scene {
  Scene(const Surface& s, bool support_only);
  ~Scene() { rtcReleaseScene(handle); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  [[nodiscard]] Vec3 to_unit(const Vec3& p) const { return (p - centre) / scale; }
  void attach_triangles();

  Surface surface;
  std::vector<std::int32_t> faces;  // ordered faces that Embree knows, by its index
  Device device;
  RTCScene handle;
  Vec3 centre;
  double scale;
};

namespace {

float search_radius(double distance, double scale) {
  return static_cast<float>(distance / scale * (1.0 + kMargin) + kMargin);
}

/// The best candidate so far for one query point.
struct Query {
  const Surface* surface;
  const std::vector<std::int32_t>* faces;
  double scale;
  Vec3 point;
  double squared_distance = std::numeric_limits<double>::infinity();
  std::int32_t face = -1;  // the caller's index
  Vec3 barycentric = Vec3::Zero();

  void consider(std::int32_t ordered) {
    const auto [a, b, c] = surface->corners(ordered);
    const Vec3 weights =
        closest_barycentric(point, surface->vertex(a), surface->vertex(b), surface->vertex(c));
    const std::int32_t candidate = surface->original_face(ordered);
    const double squared = (surface->point(candidate, weights) - point).squaredNorm();
    if (squared > squared_distance || (squared == squared_distance && candidate >= face)) return;
    squared_distance = squared;
    face = candidate;
    barycentric = weights;
  }

  /// Radius within which Embree must still look.
  [[nodiscard]] float radius() const { return search_radius(std::sqrt(squared_distance), scale); }
};

bool visit(RTCPointQueryFunctionArguments* arguments) {
  Query& query = *static_cast<Query*>(arguments->userPtr);
  query.consider((*query.faces)[arguments->primID]);
  const float radius = query.radius();
  if (!(radius < arguments->query->radius)) return false;
  arguments->query->radius = radius;
  return true;
}

/// The faces nearer than a radius to one point.
struct Gathering {
  const Surface* surface;
  const std::vector<std::int32_t>* faces;
  Vec3 point;
  double squared_radius;
  std::vector<std::int32_t> found;  // the caller's indices
};

bool gather(RTCPointQueryFunctionArguments* arguments) {
  Gathering& query = *static_cast<Gathering*>(arguments->userPtr);
  const std::int32_t ordered = (*query.faces)[arguments->primID];
  const auto [a, b, c] = query.surface->corners(ordered);
  const Vec3 weights = closest_barycentric(query.point, query.surface->vertex(a),
                                           query.surface->vertex(b), query.surface->vertex(c));
  const std::int32_t face = query.surface->original_face(ordered);
  if ((query.surface->point(face, weights) - query.point).squaredNorm() < query.squared_radius)
    query.found.push_back(face);
  return false;
}

}  // namespace

Projector::Scene::Scene(const Surface& s, bool support_only)
    : surface(s), handle(rtcNewScene(device.handle)) {
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(surface.face_count()); ++f)
    if (!support_only || surface.geometry(f).moments.capacity > 0.0) faces.push_back(f);
  Vec3 low = surface.vertex(0);
  Vec3 high = low;
  for (std::size_t k = 0; k < surface.vertex_count(); ++k) {
    low = low.cwiseMin(surface.vertex(static_cast<std::int32_t>(k)));
    high = high.cwiseMax(surface.vertex(static_cast<std::int32_t>(k)));
  }
  centre = 0.5 * (low + high);
  scale = 0.5 * (high - low).maxCoeff();  // > 0: a surface has area
  attach_triangles();
  rtcCommitScene(handle);
}

void Projector::Scene::attach_triangles() {
  RTCGeometry triangles = rtcNewGeometry(device.handle, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* x = static_cast<float*>(rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0,
                                                        RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                        surface.vertex_count()));
  for (std::size_t k = 0; k < surface.vertex_count(); ++k) {
    const Vec3 unit = to_unit(surface.vertex(static_cast<std::int32_t>(k)));
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      x[3 * k + static_cast<std::size_t>(axis)] = float(unit[axis]);
  }
  auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      index[3 * f + k] = static_cast<unsigned>(surface.corners(faces[f])[k]);
  rtcCommitGeometry(triangles);
  rtcAttachGeometry(handle, triangles);
  rtcReleaseGeometry(triangles);
}

Projector::Projector(const Surface& surface, bool support_only)
    : scene_(std::make_unique<Scene>(surface, support_only)) {}
Projector::~Projector() = default;
Projector::Projector(Projector&&) noexcept = default;
Projector& Projector::operator=(Projector&&) noexcept = default;

namespace {

/// Any face will do to begin with, as long as Embree knows it.
template <typename Scene>
std::int32_t first_guess(const Scene& scene, std::span<const std::int32_t> hints, std::size_t k) {
  if (hints.empty()) return scene.faces[0];
  const std::int32_t face = scene.surface.ordered_face(hints[k]);
  return std::binary_search(scene.faces.begin(), scene.faces.end(), face) ? face : scene.faces[0];
}

}  // namespace

Projection Projector::project(std::span<const Vec3> points,
                              std::span<const std::int32_t> hints) const {
  check_finite("points", points);
  if (!hints.empty()) {
    check_same_length("hints", hints.size(), "points", points.size());
    check_face_indices("hints", hints, scene_->surface);
  }
  const std::size_t count = points.size();
  Projection result{std::vector<Vec3>(count), std::vector<std::int32_t>(count),
                    std::vector<Vec3>(count), std::vector<double>(count)};
  parallel_chunks(count, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Query query{&scene_->surface, &scene_->faces, scene_->scale, points[k]};
      query.consider(first_guess(*scene_, hints, k));
      const Vec3 unit = scene_->to_unit(points[k]);
      RTCPointQuery embree{float(unit.x()), float(unit.y()), float(unit.z()), 0.0f, query.radius()};
      RTCPointQueryContext context;
      rtcInitPointQueryContext(&context);
      rtcPointQuery(scene_->handle, &embree, &context, visit, &query);
      result.faces[k] = query.face;
      result.barycentric[k] = query.barycentric;
      result.positions[k] = scene_->surface.point(query.face, query.barycentric);
      result.distances[k] = std::sqrt(query.squared_distance);
    }
  });
  return result;
}

std::vector<std::vector<std::int32_t>> Projector::faces_within(
    std::span<const Vec3> points, std::span<const double> radii) const {
  check_finite("points", points);
  check_same_length("radii", radii.size(), "points", points.size());
  for (std::size_t k = 0; k < radii.size(); ++k)
    if (!std::isfinite(radii[k]) || radii[k] <= 0.0)
      throw ArgumentError(entry("radii", k) + " is " + number(radii[k]) +
                          ": it must be finite and > 0");
  std::vector<std::vector<std::int32_t>> result(points.size());
  parallel_chunks(points.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Gathering query{&scene_->surface, &scene_->faces, points[k], radii[k] * radii[k], {}};
      const Vec3 unit = scene_->to_unit(points[k]);
      RTCPointQuery embree{float(unit.x()), float(unit.y()), float(unit.z()), 0.0f,
                           search_radius(radii[k], scene_->scale)};
      RTCPointQueryContext context;
      rtcInitPointQueryContext(&context);
      rtcPointQuery(scene_->handle, &embree, &context, gather, &query);
      std::sort(query.found.begin(), query.found.end());
      result[k] = std::move(query.found);
    }
  });
  return result;
}

}  // namespace dapple
