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
  /// \param members the sites of the cells, as in Term; must outlive this
  /// \param bases   of the tangent planes, per site
  /// \param factor  of all entries
  void update(const RestrictedVoronoi& diagram, std::span<const std::int32_t> members,
              const std::vector<TangentBasis>& bases, double factor);
  /// Of no boundaries.
  void clear() { starts_.clear(); }
  [[nodiscard]] bool empty() const { return starts_.empty(); }

  [[nodiscard]] std::size_t cells() const { return empty() ? 0 : starts_.size() - 1; }
  /// The site of a cell.
  [[nodiscard]] std::size_t site(std::size_t cell) const {
    return members_.empty() ? cell : static_cast<std::size_t>(members_[cell]);
  }

  /// The product share * B v at the site of a cell; v holds all sites.
  [[nodiscard]] Tangent product(const TangentVectors& v, std::size_t cell, double share) const;

  /// The diagonal block of B at the site of a cell.
  [[nodiscard]] TangentBlock block(std::size_t cell) const;

 private:
  /// A boundary as its first two moments, seen from one of its sites: its middle, and its direction
  /// by the root of its inertia.
  struct Side {
    std::int32_t other;             // site
    Tangent middle, others_middle;  // from the site and from the other, in their planes
    Tangent along, others_along;
  };

  [[nodiscard]] Side side(const RestrictedVoronoi& diagram, std::size_t cell,
                          const CellBoundary& boundary, const std::vector<TangentBasis>& bases,
                          double factor) const;
  [[nodiscard]] std::span<const Side> sides(std::size_t cell) const {
    return std::span(sides_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
  }

  std::span<const std::int32_t> members_;
  std::vector<std::size_t> starts_;  // rows of sides_, one more than cells
  std::vector<Side> sides_;
};

}  // namespace dapple
