// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <dapple/projector.hpp>
#include <dapple/visibility.hpp>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"

namespace dapple {
namespace {

constexpr double kForever = 1e30;

void check_eye(const std::array<double, 4>& eye) {
  for (std::size_t k = 0; k < eye.size(); ++k)
    if (!std::isfinite(eye[k]))
      throw ArgumentError("eye[" + std::to_string(k) + "] is not finite: " + number(eye[k]));
  if (eye[3] != 0.0 && eye[3] != 1.0)
    throw ArgumentError("eye[3] is " + number(eye[3]) +
                        ": it must be 1 for a place, or 0 for a direction");
  if (eye[3] == 0.0 && eye[0] == 0.0 && eye[1] == 0.0 && eye[2] == 0.0)
    throw ArgumentError("eye is a direction without a length");
}

/// From a point to the eye.
Ray ray_to(const std::array<double, 4>& eye, const Vec3& point) {
  const Vec3 place(eye[0], eye[1], eye[2]);
  if (eye[3] == 0.0) return {point, place.stableNormalized(), kForever};
  const Vec3 way = place - point;
  const double length = way.stableNorm();
  if (!(length > 0.0)) return {point, Vec3::UnitX(), 0.0};
  return {point, way / length, length};
}

}  // namespace

std::vector<std::uint8_t> seen_from(const Surface& surface, const std::array<double, 4>& eye,
                                    std::span<const Vec3> points, Context* context) {
  check_eye(eye);
  check_finite("points", points);
  const Projector projector(surface, false, context);
  std::vector<std::uint8_t> result(points.size(), 0);
  Tally tally(context, points.size());
  parallel_chunks(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    tally.check();
    for (std::size_t k = begin; k < end; ++k) {
      const Ray ray = ray_to(eye, points[k]);
      result[k] = ray.length > 0.0 && projector.is_blocked(ray) ? 0 : 1;
    }
    tally.add(end - begin);
  });
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
