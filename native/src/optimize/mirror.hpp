// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>

#include "base/vectors.hpp"

namespace dapple {

/// The plane of symmetry, and the sites that are each other's images. Moves and sites restricted by
/// it stay symmetric.
struct Mirror {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();              ///< unit
  double farthest = 0.0;                    ///< images may be so far from the surface
  std::vector<std::int32_t> partners = {};  ///< per site; the site itself if it is on the plane

  [[nodiscard]] double height(const Vec3& p) const { return normal.dot(p - point); }
  [[nodiscard]] Vec3 reflected(const Vec3& p) const { return p - 2.0 * height(p) * normal; }
  /// Of a direction.
  [[nodiscard]] Vec3 turned(const Vec3& v) const { return v - 2.0 * normal.dot(v) * normal; }

  /// Replace the moves of a pair by their mean; sites on the plane move along it.
  /// \param normals of the surface, per site
  void restrict(Vectors& moves, const Vectors& normals) const;

  /// The nearest sites of the domain that are symmetric.
  /// \param hints faces near the points
  /// \throw Cancelled
  [[nodiscard]] Sites project(const Domain& domain, const Vectors& points,
                              std::span<const std::int32_t> hints, const Context* context) const;

  /// The domain's points nearest to the images of sites.
  [[nodiscard]] Sites images(const Domain& domain, const Sites& sites,
                             std::span<const std::int32_t> hints, const Context* context) const;
};

/// Lead sites along the domain to the mirror's plane by a few steps of Newton's method. Some do not
/// arrive, such as on the sides of a sheet that is parallel to the plane.
[[nodiscard]] Sites led_to_plane(const Domain& domain, const Mirror& mirror, Sites sites, int steps,
                                 const Context* context);

}  // namespace dapple
