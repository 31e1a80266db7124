// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/decals.hpp>
#include <dapple/neighbors.hpp>
#include <numbers>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/validate_samples.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;      // texels per chunk
constexpr double kAlongTheNormal = 1e-9;  // relative length of the tangential part of a tangent
constexpr double kCorner = std::numbers::sqrt2;  // distance of a square decal's corner, in radii

/// The local frames of the samples that orient their decals.
class Decals {
 public:
  Decals(const Samples& samples, std::span<const double> radii, std::span<const Vec3> tangents)
      : samples_(samples), radii_(radii), index_(samples.positions) {
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Vec3& normal = samples.normals[k];
      const Vec3 along = tangents[k] - tangents[k].dot(normal) * normal;
      if (!(along.norm() > kAlongTheNormal * tangents[k].norm()))
        throw ArgumentError(entry("tangents", k) + " is parallel to the normal: it must not be");
      tangents_.push_back(along.normalized());
      largest_ = std::max(largest_, radii[k]);
    }
  }

  struct Hit {
    std::int32_t sample = -1;
    Vec2 place = Vec2::Zero();
  };

  /// The decal at a point of the surface with that normal.
  [[nodiscard]] Hit at(const Vec3& point, const Vec3& normal, std::vector<Neighbor>& found) const {
    Hit best;
    double least = std::numeric_limits<double>::infinity();
    index_.within(point, kCorner * largest_, found);
    for (const Neighbor& near : found) {
      const auto k = static_cast<std::size_t>(near.index);
      const double distance = std::sqrt(near.squared_distance) / radii_[k];
      if (!(distance < least) || samples_.normals[k].dot(normal) <= 0.0) continue;
      Vec2 place;
      if (!reaches(k, point, distance, place)) continue;
      least = distance;
      best = {near.index, place};
    }
    return best;
  }

 private:
  /// Whether a point is on decal k, and its coordinates there.
  /// \param distance the distance from the decal's center, relative to its radius
  [[nodiscard]] bool reaches(std::size_t k, const Vec3& point, double distance, Vec2& place) const {
    const Vec3& normal = samples_.normals[k];
    const Vec3 way = (point - samples_.positions[k]) / radii_[k];
    if (std::abs(way.dot(normal)) > 1.0) return false;
    const Vec2 flat(way.dot(tangents_[k]), way.dot(normal.cross(tangents_[k])));
    place = flat.norm() > 0.0 ? Vec2(flat * (distance / flat.norm())) : flat;
    return place.cwiseAbs().maxCoeff() <= 1.0;
  }

  const Samples& samples_;
  std::span<const double> radii_;
  Neighbors index_;
  std::vector<Vec3> tangents_;
  double largest_ = 0.0;
};

void check(const Surface& surface, const Samples& samples, std::span<const double> radii,
           std::span<const Vec3> tangents, const Texels& texels) {
  check_samples(surface, samples);
  check_same_length("radii", radii.size(), "samples", samples.size());
  check_same_length("tangents", tangents.size(), "samples", samples.size());
  for (std::size_t k = 0; k < radii.size(); ++k)
    check_at_least(entry("radii", k).c_str(), radii[k], 0.0);
  check_finite("tangents", tangents);
  check_same_length("texels.barycentric", texels.barycentric.size(), "texels.faces",
                    texels.faces.size());
  for (const std::int32_t face : texels.faces)
    if (face >= static_cast<std::int32_t>(surface.face_count()))
      throw ArgumentError("texels.faces contains " + std::to_string(face) + ": the surface has " +
                          std::to_string(surface.face_count()) + " faces");
}

}  // namespace

DecalCover decal_cover(const Surface& surface, const Samples& samples,
                       std::span<const double> radii, std::span<const Vec3> tangents,
                       const Texels& texels, Context* context) {
  check(surface, samples, radii, tangents, texels);
  if (context) context->check();
  DecalCover result{std::vector<std::int32_t>(texels.size(), -1),
                    std::vector<Vec2>(texels.size(), Vec2::Zero())};
  if (samples.size() == 0) {
    if (context) context->advance(1.0);
    return result;
  }
  const Decals decals(samples, radii, tangents);
  Tally tally(context, texels.size());
  parallel_chunks(texels.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    tally.check();
    std::vector<Neighbor> found;
    for (std::size_t k = begin; k < end; ++k) {
      if (texels.faces[k] < 0) continue;
      const auto hit = decals.at(
          surface.point(texels.faces[k], texels.barycentric[k]),
          surface.ordered().geometry(surface.ordered().ordered_face(texels.faces[k])).normal,
          found);
      result.samples[k] = hit.sample;
      result.places[k] = hit.place;
    }
    tally.add(end - begin);
  });
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
