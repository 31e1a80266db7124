// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/neighbors.hpp>
#include <dapple/projector.hpp>
#include <span>

namespace dapple {

/// Points and their places on another surface.
struct Transferred {
  std::vector<std::int32_t> which;  ///< their indices; sorted
  Sites sites;                      ///< and places
};

/// How far from their previous positions points may find the next frame's surface.
struct Reach {
  double density = 0.0;   ///< number of samples per capacity, > 0
  double spacings = 0.0;  ///< in local spacings of that many samples
};

/// Transfers points from a surface to the next frame's, whose faces may differ, so that
/// correspondences are unknown. Each point moves with its surroundings so that these come closest
/// to the new surface, then goes to the nearest point on the same side. A point without one within
/// reach has lost its surface.
///
/// A component that moves farther than the reach takes its points along, because the reach of its
/// points is at least twice the median distance.
class Transfer {
 public:
  /// \param samples sites of `before` from which the motion of its components is estimated
  /// \throw Cancelled
  Transfer(const Surface& before, const Surface& next, const Sites& samples, const Reach& reach,
           const Context* context);

  /// Of the samples.
  [[nodiscard]] const Transferred& samples() const { return samples_; }

  /// Of other sites of `before`.
  /// \throw Cancelled
  [[nodiscard]] Transferred find(const Sites& sites, const Context* context) const;

 private:
  struct Nearest;
  [[nodiscard]] Sites moved(const Sites& sites, const Nearest& near) const;
  [[nodiscard]] bool is_found(const Sites& sites, const Nearest& near, std::size_t k) const;
  [[nodiscard]] Vec3 common_way(const Sites& sites, const Nearest& near,
                                std::span<const Neighbor> which) const;
  [[nodiscard]] Nearest nearest(const Sites& sites, const Context* context) const;
  void measure_motion(const Sites& samples, const Nearest& near);
  [[nodiscard]] Transferred within_reach(const Sites& sites, const Nearest& near) const;
  void add_nearest(Transferred& found, std::size_t k, const Vec3& point, const Vec3& normal,
                   std::span<const std::int32_t> faces) const;
  [[nodiscard]] double reach_of(const Sites& sites, std::size_t k) const;
  [[nodiscard]] std::size_t component(std::int32_t face) const;
  [[nodiscard]] bool is_same_side(std::int32_t face, const Vec3& normal) const;

  Surface before_, next_;
  Projector projector_;
  Reach reach_;
  std::vector<double> motion_;  // per component of the surface before: so far its points may go
  Transferred samples_;
};

}  // namespace dapple
