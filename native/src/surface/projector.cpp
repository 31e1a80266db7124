// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/errors.hpp>
#include <dapple/projector.hpp>

#include "surface/ordered_surface.hpp"

#if DAPPLE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hand_over.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "base/triangle.hpp"
#include "base/validate.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {
namespace {

// Embree stores the surface in single precision, scaled to [-1, 1]. The error of a coordinate is at
// most 2^-24, that of a distance a few times as much. All faces within this margin of the best
// distance are compared in double precision.
constexpr double kMargin = 2e-6;
constexpr double kFirst = 2.0 * kMargin;  // where rays begin
// Distance from the center, in sizes of the surface, beyond which only the direction of a point
// matters.
constexpr double kFar = 1e12;
constexpr std::size_t kGrain = 65536;  // faces or vertices between two checks
// A surface whose faces are smaller than this number of margins is split at gaps, because Embree
// could not distinguish faces of one part.
constexpr double kFine = 50.0;
constexpr double kGap = 0.25;     // of the length along which it is split
constexpr std::size_t kFew = 64;  // faces: up to this number, all are tested one by one

/// \param device null for errors in its creation
/// \throw Cancelled if Embree was stopped; std::bad_alloc, std::runtime_error for other failures
void check_error(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_CANCELLED) throw Cancelled();
  // If one of Embree's threads throws, the others report an unknown error.
  if (error == RTC_ERROR_OUT_OF_MEMORY || error == RTC_ERROR_UNKNOWN) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree could not take the surface");
}

/// Owns an object of Embree and releases it.
template <typename T, void (*Release)(T)>
class Handle {
 public:
  /// \param device the device that created it; null for a device itself
  explicit Handle(T handle, RTCDevice device = nullptr) : handle_(handle) {
    if (handle_) return;
    check_error(device);
    throw std::runtime_error("Embree could not be set up");
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { Release(handle_); }
  [[nodiscard]] T get() const { return handle_; }

 private:
  T handle_;
};

}  // namespace

struct Projector::Scene {
  /// A part of the faces, which Embree stores relative to the center of the part.
  struct Part {
    Part(const Scene& scene, std::vector<OrderedFace> faces, const Eigen::AlignedBox3d& box);

    [[nodiscard]] Vec3 to_unit(const Vec3& p) const { return (p - center) / scale; }
    [[nodiscard]] double squared_distance(const Vec3& p, double unit) const {
      return (unit * (low - p).cwiseMax(p - high).cwiseMax(0.0)).squaredNorm();
    }
    void attach_triangles(const Scene& scene, const Context* context);
    void build(const Scene& scene, const Context* context);

    std::vector<OrderedFace> faces;  // by Embree's index
    Handle<RTCScene, rtcReleaseScene> handle;
    Vec3 low, high, center;
    double scale = 0.0;
  };

  Scene(const Surface& s, bool support_only, const Context* context);

  [[nodiscard]] Vec3 within_reach(const Vec3& p) const;
  void find_faces(bool support_only, const Context* context);
  void find_size(const Context* context);
  void split(std::vector<OrderedFace> some, const Context* context);
  void split(std::vector<OrderedFace> some, const Eigen::AlignedBox3d& box, const Context* context);
  void add_part(std::vector<OrderedFace> some, const Eigen::AlignedBox3d& box,
                const Context* context);
  [[nodiscard]] double mean_area(std::span<const OrderedFace> some) const;
  [[nodiscard]] bool is_fine(double area, double length) const;

  Surface surface;
  std::vector<OrderedFace> faces;  // of all parts
  Handle<RTCDevice, rtcReleaseDevice> device{rtcNewDevice(nullptr)};
  std::vector<std::unique_ptr<Part>> parts;
  Eigen::AlignedBox3d box;
  Vec3 center;
  double scale;
  double factor;  // a power of two, about 1 / scale: squares of scaled lengths do not overflow
};

namespace {

float search_radius(double distance, double scale) {
  return static_cast<float>(distance / scale * (1.0 + kMargin) + kMargin);
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

/// Data for Embree's threads while they build its tree.
struct Watch {
  const Context* context;
  Poll* poll = Poll::current();
  HandOver all = {};
};

/// Checks for cancellation in any of Embree's threads. No exception may pass through Embree, not
/// even std::bad_alloc from the creation of the exception that reports the cancellation.
bool go_on(void* given, double) noexcept {
  Watch& watch = *static_cast<Watch*>(given);
  const HandOver::Part part(watch.all);
  const Poll::Share share(watch.poll);
  try {
    check_context(watch.context);
    return true;
  } catch (...) {
    return false;
  }
}

}  // namespace

Projector::Scene::Scene(const Surface& s, bool support_only, const Context* context) : surface(s) {
  find_faces(support_only, context);
  find_size(context);
  const double mean = surface.area() / static_cast<double>(surface.face_count());
  if (is_fine(mean, 2.0 * scale))
    add_part(faces, box, context);
  else
    split(faces, context);
}

void Projector::Scene::find_faces(bool support_only, const Context* context) {
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    check_at(context, f, kGrain);
    if (!surface.ordered().counts(nth_face(f))) continue;
    if (!support_only || surface.ordered().geometry(nth_face(f)).moments.capacity > 0.0)
      faces.push_back(nth_face(f));
  }
}

void Projector::Scene::find_size(const Context* context) {
  for (std::size_t k = 0; k < surface.vertex_count(); ++k) {
    check_at(context, k, kGrain);
    box.extend(surface.ordered().vertex(static_cast<std::int32_t>(k)));
  }
  center = 0.5 * (box.min() + box.max());
  scale = 0.5 * box.sizes().maxCoeff();  // positive, because a surface has area
  factor = std::ldexp(1.0, -std::ilogb(scale));
}

namespace {

Eigen::AlignedBox3d box_of(const Surface& surface, OrderedFace face) {
  Eigen::AlignedBox3d box;
  for (const std::int32_t v : surface.ordered().corners(face))
    box.extend(surface.ordered().vertex(v));
  return box;
}

/// The middle of the largest gap along an axis; NaN if no gap is large enough.
double gap_along(const Surface& surface, std::span<const OrderedFace> faces, Eigen::Index axis,
                 double least) {
  std::vector<std::pair<double, double>> spans;
  for (const OrderedFace face : faces) {
    const Eigen::AlignedBox3d box = box_of(surface, face);
    spans.emplace_back(box.min()[axis], box.max()[axis]);
  }
  std::sort(spans.begin(), spans.end());
  double place = std::numeric_limits<double>::quiet_NaN();
  double end = spans.front().second;
  for (const auto& [low, high] : spans) {
    if (low - end > least) {
      least = low - end;
      place = end + 0.5 * least;
    }
    end = std::max(end, high);
  }
  return place;
}

}  // namespace

/// Splits the surface at gaps into parts small enough for single precision.
void Projector::Scene::split(std::vector<OrderedFace> some, const Context* context) {
  check_context(context);
  Eigen::AlignedBox3d around;
  for (const OrderedFace face : some) around.extend(box_of(surface, face));
  split(std::move(some), around, context);
}

void Projector::Scene::split(std::vector<OrderedFace> some, const Eigen::AlignedBox3d& around,
                             const Context* context) {
  Eigen::Index axis = 0;
  const double length = around.sizes().maxCoeff(&axis);
  double place = std::numeric_limits<double>::quiet_NaN();
  if (some.size() > kFew && !is_fine(mean_area(some), length))
    place = gap_along(surface, some, axis, kGap * length);
  if (!std::isfinite(place)) return add_part(std::move(some), around, context);
  std::vector<OrderedFace> before, after;
  for (const OrderedFace face : some)
    (box_of(surface, face).min()[axis] < place ? before : after).push_back(face);
  split(std::move(before), context);
  split(std::move(after), context);
}

void Projector::Scene::add_part(std::vector<OrderedFace> some, const Eigen::AlignedBox3d& around,
                                const Context* context) {
  parts.push_back(std::make_unique<Part>(*this, std::move(some), around));
  parts.back()->attach_triangles(*this, context);
  parts.back()->build(*this, context);
}

double Projector::Scene::mean_area(std::span<const OrderedFace> some) const {
  double sum = 0.0;
  for (const OrderedFace face : some) sum += surface.ordered().geometry(face).moments.area;
  return sum / static_cast<double>(some.size());
}

/// Whether faces of that area are large enough to be distinguished in a part of that length.
bool Projector::Scene::is_fine(double area, double length) const {
  return kFine * kMargin * factor * length <= factor * std::sqrt(area);
}

Projector::Scene::Part::Part(const Scene& scene, std::vector<OrderedFace> some,
                             const Eigen::AlignedBox3d& box)
    : faces(std::move(some)),
      handle(rtcNewScene(scene.device.get()), scene.device.get()),
      low(box.min()),
      high(box.max()),
      center(0.5 * (low + high)),
      scale(0.5 * (high - low).maxCoeff()) {
  if (!(scale > 0.0)) scale = scene.scale;  // if all vertices coincide
}

void Projector::Scene::Part::build(const Scene& scene, const Context* context) {
  Watch watch{context};
  const bool asked = context || watch.poll;
  if (asked) rtcSetSceneProgressMonitorFunction(handle.get(), go_on, &watch);
  rtcCommitScene(handle.get());
  if (asked) {
    rtcSetSceneProgressMonitorFunction(handle.get(), nullptr, nullptr);
    check_context(context);
  }
  check_error(scene.device.get());
}

/// Replaces a point that is too far away for single precision by a nearer one in the same
/// direction.
Vec3 Projector::Scene::within_reach(const Vec3& p) const {
  const Vec3 way = p - center;
  const double most = way.cwiseAbs().maxCoeff();
  return most <= kFar * scale ? p : Vec3(center + kFar * scale * (way / most));
}

template <typename T>
T* buffer_of(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count) {
  void* memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, 3 * sizeof(T), count);
  if (!memory) throw std::bad_alloc();
  return static_cast<T*>(memory);
}

/// The vertices of some faces in order, without duplicates.
std::vector<std::int32_t> vertices_of(const Surface& surface, std::span<const OrderedFace> faces) {
  std::vector<std::int32_t> result;
  for (const OrderedFace face : faces)
    for (const std::int32_t v : surface.ordered().corners(face)) result.push_back(v);
  sort_unique(result);
  return result;
}

/// Attaches the triangles of a part. If it has all faces, the vertices are used unchanged.
void Projector::Scene::Part::attach_triangles(const Scene& scene, const Context* context) {
  const OrderedSurface& mesh = scene.surface.ordered();
  const bool whole = faces.size() == scene.faces.size();
  const Handle<RTCGeometry, rtcReleaseGeometry> geometry{
      rtcNewGeometry(scene.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE), scene.device.get()};
  const RTCGeometry triangles = geometry.get();
  const std::vector<std::int32_t> some =
      whole ? std::vector<std::int32_t>() : vertices_of(scene.surface, faces);
  const std::size_t count = whole ? scene.surface.vertex_count() : some.size();
  auto* x = buffer_of<float>(triangles, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, count);
  for (std::size_t k = 0; k < count; ++k) {
    check_at(context, k, kGrain);
    const Vec3 unit = to_unit(mesh.vertex(whole ? static_cast<std::int32_t>(k) : some[k]));
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      x[3 * k + static_cast<std::size_t>(axis)] = float(unit[axis]);
  }
  const auto number = [&](std::int32_t v) {
    return static_cast<unsigned>(
        whole ? v : std::lower_bound(some.begin(), some.end(), v) - some.begin());
  };
  auto* index =
      buffer_of<unsigned>(triangles, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_at(context, f, kGrain);
    for (std::size_t k = 0; k < 3; ++k) index[3 * f + k] = number(mesh.corners(faces[f])[k]);
  }
  rtcCommitGeometry(triangles);
  rtcAttachGeometry(handle.get(), triangles);
}

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
                             query.squared_distance * (1.0 + kMargin))
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
  const Vec3 unit = part.to_unit(query.point).cwiseMax(-kFar).cwiseMin(kFar);
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
  const double slack = 2.0 * kMargin * part.scale;
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
