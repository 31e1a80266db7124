// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/restricted_voronoi.hpp>
#include <span>
#include <vector>

#include "base/vectors.hpp"

namespace dapple {

/// How strongly the sites of a frame are held.
struct Hold {
  double stickiness = 0.0;  ///< gamma
  double smoothing = 0.0;   ///< sigma
};

/// What ties the sites of a frame to their anchors, where the surface carried them. With the slides
/// d_k = x_k - anchor_k and the masses m_k of the cells at the start it is
///   gamma sum_k m_k |d_k|^2 + sigma sum_ij (m_i + m_j) / 2 |d_i - d_j|^2,
/// over the pairs ij whose cells were adjacent at the start. The first part holds each site back,
/// the second only lets neighbors slide alike: it leaves the long waves that a stretch requires,
/// and takes away what each site would do by itself, which looks like noise from frame to frame.
class Anchoring {
 public:
  /// Of nothing.
  Anchoring() = default;
  /// \param scale factor of the whole
  Anchoring(const RestrictedVoronoi& start, Vectors anchors, double scale, const Hold& hold);

  [[nodiscard]] bool empty() const { return anchors_.empty(); }
  [[nodiscard]] bool ties_neighbors() const { return !neighbors_.empty(); }
  /// The part of a site, with half of each of its pairs.
  [[nodiscard]] double energy(const Vectors& positions, std::size_t k) const;
  [[nodiscard]] Vec3 gradient(const Vectors& positions, std::size_t k) const;

  /// The sites of its pairs.
  [[nodiscard]] std::span<const std::int32_t> neighbors(std::size_t k) const;
  /// Half the entry of the Hessian of a site with itself, times the identity.
  [[nodiscard]] double stiffness(std::size_t k) const;
  /// The same for a site and a neighbor, with the opposite sign.
  [[nodiscard]] double stiffness(std::size_t i, std::size_t j) const {
    return 0.5 * (tied_[i] + tied_[j]);
  }

 private:
  [[nodiscard]] Vec3 slide(const Vectors& positions, std::size_t k) const {
    return positions[k] - anchors_[k];
  }

  Vectors anchors_;
  std::vector<double> held_, tied_;  // gamma m_k and sigma m_k, times the scale
  std::vector<std::size_t> starts_;  // rows of neighbors_, one more than sites
  std::vector<std::int32_t> neighbors_;
};

}  // namespace dapple
