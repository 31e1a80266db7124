// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/projector.hpp>
#include <limits>

#include "base/parallel.hpp"
#include "base/triangle.hpp"
#include "base/validate.hpp"
#include "surface/embree_scene.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

constexpr double kFirst = 2.0 * kEmbreeMargin;  // where rays begin

float search_radius(double distance, double scale) {
  return static_cast<float>(distance / scale * (1.0 + kEmbreeMargin) + kEmbreeMargin);
}

/// The best candidate so far for one query point.
struct Query {
  const Surface* surface;
  const std::vector<OrderedFace>* faces;
  double scale;
  double factor;
  Vec3 point;
  double squared_distance = std::numeric_limits<double>::infinity();  // scaled
  std::int32_t face = -1;                                             // the caller's index
  Vec3 barycentric = Vec3::Zero();

  void consider(OrderedFace ordered) {
    const auto [a, b, c] = surface->ordered().corners(ordered);
    const Vec3 weights = closest_barycentric(factor * point, factor * surface->ordered().vertex(a),
                                             factor * surface->ordered().vertex(b),
                                             factor * surface->ordered().vertex(c));
    const std::int32_t candidate = surface->ordered().original_face(ordered);
    const double squared = (factor * (surface->point(candidate, weights) - point)).squaredNorm();
    if (squared > squared_distance || (squared == squared_distance && candidate >= face)) return;
    squared_distance = squared;
    face = candidate;
    barycentric = weights;
  }

  /// Whether the bounding box of a face is within Embree's radius, for faces that Embree has not
  /// tested on its own.
  [[nodiscard]] bool has_box_within(float radius, OrderedFace ordered) const {
    const auto [a, b, c] = surface->ordered().corners(ordered);
    const Vec3& first = surface->ordered().vertex(a);
    const Vec3& second = surface->ordered().vertex(b);
    const Vec3& third = surface->ordered().vertex(c);
    const Vec3 low = first.cwiseMin(second).cwiseMin(third) - point;
    const Vec3 high = point - first.cwiseMax(second).cwiseMax(third);
    const double reach = double(radius) * scale * factor;
    return (factor * low.cwiseMax(high).cwiseMax(0.0)).squaredNorm() <= reach * reach;
  }

  /// Radius within which Embree must still search.
  [[nodiscard]] float radius() const { return search_radius(distance(), scale); }
  [[nodiscard]] double distance() const { return std::sqrt(squared_distance) / factor; }
};

bool visit(RTCPointQueryFunctionArguments* arguments) noexcept {
  Query& query = *static_cast<Query*>(arguments->userPtr);
  const OrderedFace face = (*query.faces)[arguments->primID];
  if (!query.has_box_within(arguments->query->radius, face)) return false;
  query.consider(face);
  const float radius = query.radius();
  if (!(radius < arguments->query->radius)) return false;
  arguments->query->radius = radius;
  return true;
}

/// The faces that are nearer to a point than a radius.
struct Gathering {
  const Surface* surface;
  const std::vector<OrderedFace>* faces;
  Vec3 point;
  bool far;  // so far away that all faces have equal distance
  double radius;
  std::vector<std::int32_t> found;  // the caller's indices
  std::exception_ptr error = nullptr;
};

void gather_face(Gathering& query, OrderedFace ordered) {
  const auto [a, b, c] = query.surface->ordered().corners(ordered);
  const Vec3 weights = query.far
                           ? Vec3(Vec3::UnitX())
                           : closest_barycentric(query.point, query.surface->ordered().vertex(a),
                                                 query.surface->ordered().vertex(b),
                                                 query.surface->ordered().vertex(c));
  const std::int32_t face = query.surface->ordered().original_face(ordered);
  if ((query.surface->point(face, weights) - query.point).stableNorm() < query.radius)
    query.found.push_back(face);
}

/// Exceptions must not pass through Embree, which has a C interface.
bool gather(RTCPointQueryFunctionArguments* arguments) noexcept {
  Gathering& query = *static_cast<Gathering*>(arguments->userPtr);
  try {
    gather_face(query, (*query.faces)[arguments->primID]);
  } catch (...) {
    query.error = std::current_exception();
  }
  return false;
}

}  // namespace

Projector::Projector(const Surface& surface, bool support_only, const Context* context)
    : scene_(std::make_unique<Scene>(surface, support_only, context)) {}
Projector::~Projector() = default;
Projector::Projector(Projector&&) noexcept = default;
Projector& Projector::operator=(Projector&&) noexcept = default;

namespace {

/// Search for a nearer face in one part.
template <typename Part>
void look_in(const Part& part, Query& query) {
  query.faces = &part.faces;
  query.scale = part.scale;
  const Vec3 unit = part.to_unit(query.point);
  RTCPointQuery embree{float(unit.x()), float(unit.y()), float(unit.z()), 0.0f, query.radius()};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(part.handle.get(), &embree, &context, visit, &query);
}

/// Searches the part with the nearest bounding box first, then others that may contain nearer
/// faces.
template <typename Parts>
void look_everywhere(const Parts& parts, Query& query) {
  const auto nearer = [&](const auto& a, const auto& b) {
    return a->squared_distance(query.point, query.factor) <
           b->squared_distance(query.point, query.factor);
  };
  const auto first =
      parts.size() == 1 ? parts.begin() : std::min_element(parts.begin(), parts.end(), nearer);
  look_in(**first, query);
  for (auto part = parts.begin(); part != parts.end(); ++part)
    if (part != first && (*part)->squared_distance(query.point, query.factor) <=
                             query.squared_distance * (1.0 + kEmbreeMargin))
      look_in(**part, query);
}

/// The search may begin with any face in Embree's scene.
template <typename Scene>
OrderedFace first_guess(const Scene& scene, std::span<const std::int32_t> hints, std::size_t k) {
  if (hints.empty()) return scene.faces[0];
  const OrderedFace face = scene.surface.ordered().ordered_face(hints[k]);
  return std::binary_search(scene.faces.begin(), scene.faces.end(), face) ? face : scene.faces[0];
}

}  // namespace

Projection Projector::project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context) const {
  check_hints(scene_->surface, points, hints);
  const std::size_t count = points.size();
  Projection result{std::vector<Vec3>(count), std::vector<std::int32_t>(count),
                    std::vector<Vec3>(count), std::vector<double>(count)};
  parallel_chunks(count, 64, [&](std::size_t begin, std::size_t end) {
    if (context) context->check();
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 point = scene_->within_reach(points[k]);
      Query query{&scene_->surface, &scene_->faces, scene_->scale, scene_->factor, point};
      query.consider(first_guess(*scene_, hints, k));
      look_everywhere(scene_->parts, query);
      result.faces[k] = query.face;
      result.barycentric[k] = query.barycentric;
      result.positions[k] = scene_->surface.point(query.face, query.barycentric);
      result.distances[k] =
          point == points[k] ? query.distance() : (result.positions[k] - points[k]).stableNorm();
    }
  });
  return result;
}

namespace {

template <typename Part>
void gather_in(const Part& part, Gathering& query) {
  query.faces = &part.faces;
  const Vec3 unit = part.to_unit(query.point).cwiseMax(-kEmbreeFar).cwiseMin(kEmbreeFar);
  RTCPointQuery embree{float(unit.x()), float(unit.y()), float(unit.z()), 0.0f,
                       search_radius(query.radius, part.scale)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(part.handle.get(), &embree, &context, gather, &query);
}

}  // namespace

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
      Gathering query{&scene_->surface, &scene_->faces,
                      points[k],        scene_->within_reach(points[k]) != points[k],
                      radii[k],         {}};
      for (const auto& part : scene_->parts) gather_in(*part, query);
      if (query.error) std::rethrow_exception(query.error);
      std::sort(query.found.begin(), query.found.end());
      result[k] = std::move(query.found);
    }
  });
  return result;
}

namespace {

void intersect(RTCScene scene, RTCRayHit& ray) {
#if DAPPLE_EMBREE_MAJOR >= 4
  rtcIntersect1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
#endif
}

bool is_occluded(RTCScene scene, RTCRay& ray) {
#if DAPPLE_EMBREE_MAJOR >= 4
  rtcOccluded1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
#endif
  return ray.tfar < 0.0f;
}

struct Hit {
  double length;
  OrderedFace face;
};

/// Whether a ray hits the bounding box of a part, within a margin.
template <typename Part>
bool meets_box(const Part& part, const Ray& ray, double length) {
  double first = 0.0, last = length;
  const double slack = 2.0 * kEmbreeMargin * part.scale;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double low = part.low[axis] - slack - ray.origin[axis];
    const double high = part.high[axis] + slack - ray.origin[axis];
    const double way = ray.direction[axis];
    if (way == 0.0) {
      if (low > 0.0 || high < 0.0) return false;
      continue;
    }
    first = std::max(first, std::min(low / way, high / way));
    last = std::min(last, std::max(low / way, high / way));
  }
  return first <= last;
}

/// A ray in the unit of a part.
template <typename Part>
RTCRay embree_ray(const Part& part, const Ray& ray, double length) {
  const Vec3 from = part.to_unit(ray.origin);
  return {.org_x = float(from.x()),
          .org_y = float(from.y()),
          .org_z = float(from.z()),
          .tnear = float(kFirst),
          .dir_x = float(ray.direction.x()),
          .dir_y = float(ray.direction.y()),
          .dir_z = float(ray.direction.z()),
          .time = 0.0f,
          .tfar = float(length / part.scale),
          .mask = ~0u,
          .id = 0,
          .flags = 0};
}

/// Whether a part has a nearer hit.
template <typename Part>
bool hit_in(const Part& part, const Ray& ray, Hit& nearest) {
  RTCRayHit hit{};
  hit.ray = embree_ray(part, ray, nearest.length);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect(part.handle.get(), hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  nearest = {double(hit.ray.tfar) * part.scale, part.faces[hit.hit.primID]};
  return true;
}

}  // namespace

std::vector<std::int32_t> Projector::first_hits(std::span<const Ray> rays) const {
  std::vector<std::int32_t> result(rays.size(), -1);
  parallel_chunks(rays.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Hit nearest{rays[k].length, {}};
      bool any = false;
      for (const auto& part : scene_->parts)
        if (meets_box(*part, rays[k], nearest.length)) any = hit_in(*part, rays[k], nearest) || any;
      if (any) result[k] = scene_->surface.ordered().original_face(nearest.face);
    }
  });
  return result;
}

bool Projector::is_blocked(const Ray& ray) const {
  return std::any_of(scene_->parts.begin(), scene_->parts.end(), [&](const auto& part) {
    if (!meets_box(*part, ray, ray.length)) return false;
    RTCRay embree = embree_ray(*part, ray, ray.length);
    return is_occluded(part->handle.get(), embree);
  });
}

double Projector::resolution() const { return kFirst * scene_->scale; }

}  // namespace dapple
