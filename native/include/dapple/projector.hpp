// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// Closest points of a surface, one entry per query point.
struct Projection {
  std::vector<Vec3> positions;
  std::vector<std::int32_t> faces;  ///< the caller's indices
  std::vector<Vec3> barycentric;    ///< >= 0, sum 1
  std::vector<double> distances;    ///< from the query point
};

/// A ray of limited length.
struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< unit
  double length;
};

/// Finds the closest points of a surface, many at once.
///
/// Embree culls in single precision, with a margin, on a centered and scaled copy; candidates are
/// compared in double precision and ties go to the lowest (caller's) face index, so the result does
/// not depend on Embree's tree.
class Projector {
 public:
  /// \param support_only leave out faces without density or area, so that no point is projected
  /// onto them
  /// \param context      checked for cancellation only
  /// \throw Cancelled
  explicit Projector(const Surface& surface, bool support_only = false,
                     const Context* context = nullptr);
  ~Projector();
  Projector(Projector&&) noexcept;
  Projector& operator=(Projector&&) noexcept;
  Projector(const Projector&) = delete;
  Projector& operator=(const Projector&) = delete;

  /// \param points finite positions
  /// \param hints  a face (caller's index) near each point, or empty; affects only the speed
  /// \throw ArgumentError naming the first point that is not finite
  /// \throw Cancelled
  [[nodiscard]] Projection project(std::span<const Vec3> points,
                                   std::span<const std::int32_t> hints = {},
                                   const Context* context = nullptr) const;

  /// For each point the faces (caller's indices, ascending) nearer to it than its radius.
  /// \throw ArgumentError naming the first point that is not finite, radius that is not > 0; if
  /// the lengths differ
  [[nodiscard]] std::vector<std::vector<std::int32_t>> faces_within(
      std::span<const Vec3> points, std::span<const double> radii) const;

  /// For each ray the first face (caller's index) that it hits, -1 if there is none. Faces closer
  /// to the origin than a few millionths of the surface's size are not hit; of two faces at equal
  /// distance either may be returned.
  [[nodiscard]] std::vector<std::int32_t> first_hits(std::span<const Ray> rays) const;

  /// Whether a ray hits a face, as in first_hits().
  [[nodiscard]] bool is_blocked(const Ray& ray) const;

  /// A length within which single precision cannot tell points apart: no face is hit within it.
  [[nodiscard]] double resolution() const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace dapple
