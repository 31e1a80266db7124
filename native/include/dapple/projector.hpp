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

/// Where to look, and how far.
struct Ray {
  Vec3 origin;
  Vec3 direction;  ///< unit
  double length;
};

/// Finds the closest point of a surface for many points at once.
///
/// Embree culls in single precision, on a centered and scaled copy and with a margin; candidates
/// are compared in double precision and ties go to the lowest (caller's) face index, so the answer
/// does not depend on Embree's tree.
class Projector {
 public:
  /// \param support_only leave out faces without density (or area): nothing is to end there
  /// \param context      is asked whether to go on, no more
  /// \throw Cancelled
  explicit Projector(const Surface& surface, bool support_only = false,
                     const Context* context = nullptr);
  ~Projector();
  Projector(Projector&&) noexcept;
  Projector& operator=(Projector&&) noexcept;
  Projector(const Projector&) = delete;
  Projector& operator=(const Projector&) = delete;

  /// \param points finite positions
  /// \param hints  a face (caller's index) near each point to begin from, or empty; only the speed
  /// depends on it
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

  /// For each ray the first face (caller's index) that it meets, -1 if there is none. Faces within
  /// a few millionths of the surface's size of the origin are not met, and where two are equally
  /// far any may be the first.
  [[nodiscard]] std::vector<std::int32_t> first_hits(std::span<const Ray> rays) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace dapple
