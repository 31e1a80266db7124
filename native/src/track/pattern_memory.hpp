// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>

#include "base/vectors.hpp"

namespace dapple {

/// Where sites are, on one frame of a surface.
struct Places {
  const Vectors& positions;
  const Vectors& normals;  ///< of their faces
};

/// Remembers which sites were neighbors on the first frame, and leads their pattern back to it.
///
/// Evening out frame after frame anneals blue noise: each small repair is for good, and a long
/// animation ends as a hexagonal lattice. What a deformation asks for is smooth over many sites, so
/// locally it maps the first pattern affinely; what is not affine is the annealing, and is undone.
class PatternMemory {
 public:
  PatternMemory() = default;
  explicit PatternMemory(const RestrictedVoronoi& first);
  /// From starts() and neighbors() of another one.
  PatternMemory(std::vector<std::size_t> starts, std::vector<std::int32_t> neighbors)
      : starts_(std::move(starts)), neighbors_(std::move(neighbors)) {}

  /// Moves toward the places that the first frame's neighbors give each site by the best affine
  /// map of their first places to their present ones. No move where the neighbors do not fit such
  /// a map: there the pattern has been rebuilt.
  /// \param first the sites of the first frame, carried by the surface to this one
  /// \param before the sites on the last frame
  /// \param now those, carried to this frame
  /// \param share of the way that is gone, at most, in 0..1
  /// \return moves, each at most the change of the distances to the neighbors since the last
  ///         frame: on a surface that does not deform, sites do not move
  [[nodiscard]] Vectors recall(const Places& first, const Vectors& before, const Places& now,
                               double share) const;

  /// For other sites.
  /// \param origin per site its index so far, or -1 for one that is new: it has no neighbors yet
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
