// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/tangent_vectors.hpp"
#include "voronoi/site_graph.hpp"

namespace dapple {

/// The part B of the second derivatives of E_cvt that moving boundaries cause (Liu et al. 2009,
/// section 3), on the tangent planes: the Hessian is 2 diag(m) - B, with
///
///     v^T B v = sum over the boundaries V_ij of
///               2 / |x_j - x_i| integral of phi^2 (v_i . (x - x_i) - v_j . (x - x_j))^2 ds.
///
/// B is positive semidefinite. Long waves, which carry sites to where a lattice needs them, cost
/// next to nothing in the Hessian, but as much as any other move in 2 diag(m). A boundary is taken
/// as a straight segment of one density, perpendicular to x_j - x_i, so that its flux and length
/// say all about it.
class BoundaryCurvature {
 public:
  /// \param bases  of the tangent planes, per site
  /// \param factor of all entries
  void update(const RestrictedVoronoi& diagram, const std::vector<TangentBasis>& bases,
              double factor);
  /// Of no boundaries.
  void clear() { starts_.clear(); }
  [[nodiscard]] bool empty() const { return starts_.empty(); }

  /// The product share * B v at a site.
  [[nodiscard]] Tangent product(const TangentVectors& v, std::size_t site, double share) const;

  /// The diagonal block of share * B at a site.
  [[nodiscard]] TangentBlock block(std::size_t site, double share) const;

 private:
  /// A boundary as its first two moments, seen from one of its sites: its middle, and its direction
  /// by the root of its inertia.
  struct Side {
    std::int32_t other;
    Tangent middle, others_middle;  // from the site and from the other, in their planes
    Tangent along, others_along;
  };

  [[nodiscard]] static Side side(const RestrictedVoronoi& diagram, std::size_t site,
                                 const CellBoundary& boundary,
                                 const std::vector<TangentBasis>& bases, double factor);
  [[nodiscard]] std::span<const Side> sides(std::size_t site) const {
    return std::span(sides_).subspan(starts_[site], starts_[site + 1] - starts_[site]);
  }

  std::vector<std::size_t> starts_;  // rows of sides_, one more than sites
  std::vector<Side> sides_;
};

}  // namespace dapple
