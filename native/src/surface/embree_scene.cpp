// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/embree_scene.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <limits>

#include "base/hand_over.hpp"
#include "base/progress.hpp"
#include "base/sort_unique.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 65536;  // faces or vertices between two checks
// A surface whose faces are smaller than this number of margins is split at gaps, because Embree
// could not distinguish faces of one part.
constexpr double kFine = 50.0;
constexpr double kGap = 0.25;     // of the length along which it is split
constexpr std::size_t kFew = 64;  // faces: up to this number, all are tested one by one

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

void check_embree(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_CANCELLED) throw Cancelled();
  // If one of Embree's threads throws, the others report an unknown error.
  if (error == RTC_ERROR_OUT_OF_MEMORY || error == RTC_ERROR_UNKNOWN) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree could not take the surface");
}

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
  return kFine * kEmbreeMargin * factor * length <= factor * std::sqrt(area);
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
  check_embree(scene.device.get());
}

/// Replaces a point that is too far away for single precision by a nearer one in the same
/// direction.
Vec3 Projector::Scene::within_reach(const Vec3& p) const {
  const Vec3 way = p - center;
  const double most = way.cwiseAbs().maxCoeff();
  return most <= kEmbreeFar * scale ? p : Vec3(center + kEmbreeFar * scale * (way / most));
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
  const EmbreeHandle<RTCGeometry, rtcReleaseGeometry> geometry{
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

}  // namespace dapple
