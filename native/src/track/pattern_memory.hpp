// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

#include "base/vectors.hpp"

namespace dapple {

/// Positions of sites on one frame of a surface.
struct Places {
  const Vectors& positions;
  const Vectors& normals;  ///< of their faces
};

/// Remembers which sites were neighbors on the first frame, and moves their pattern back toward it.
///
/// Optimizing frame after frame anneals blue noise: each small repair is permanent, and a long
/// animation ends as a hexagonal lattice. The motion that a deformation requires is smooth over
/// many sites, so locally it maps the first pattern affinely. The rest is annealing, and is undone.
class PatternMemory {
 public:
  PatternMemory() = default;
  explicit PatternMemory(const RestrictedVoronoi& first);
  /// Restored from starts() and neighbors() of another one.
  PatternMemory(std::vector<std::size_t> starts, std::vector<std::int32_t> neighbors)
      : starts_(std::move(starts)), neighbors_(std::move(neighbors)) {}

  /// Moves toward the place of each site under the best affine map from the first to the present
  /// places of its first neighbors. Zero where the neighbors do not fit an affine map, because the
  /// pattern was rebuilt there.
  /// \param first the sites of the first frame, carried by the surface to this one
  /// \param before the sites on the last frame
  /// \param now those, carried to this frame
  /// \param share largest share of the distance to go, in 0..1
  /// \return moves, each at most as long as the change in distance to the neighbors since the last
  ///         frame, so that sites do not move on a surface that does not deform
  [[nodiscard]] Vectors recall(const Places& first, const Vectors& before, const Places& now,
                               double share) const;

  /// For other sites.
  /// \param origin per site its previous index, or -1 for a new site, which has no neighbors yet
  [[nodiscard]] PatternMemory exchanged(std::span<const std::int32_t> origin) const;

  [[nodiscard]] const std::vector<std::size_t>& starts() const { return starts_; }
  [[nodiscard]] const std::vector<std::int32_t>& neighbors() const { return neighbors_; }

 private:
  [[nodiscard]] Vec3 recall_one(std::size_t site, const Places& first, const Vectors& before,
                                const Places& now, double share) const;
  [[nodiscard]] std::span<const std::int32_t> of(std::size_t site) const;

  std::vector<std::size_t> starts_ = {0};  // rows of neighbors_, one more than sites
  std::vector<std::int32_t> neighbors_;
};

}  // namespace dapple
