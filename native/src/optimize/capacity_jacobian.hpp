// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/tangent_vectors.hpp"
#include "voronoi/site_graph.hpp"

namespace dapple {

/// The Jacobian J of the capacities of one term's cells, on the tangent planes: with a_ij the
/// boundary fluxes (paper, Theorem 2), J_ii = sum_j a_ij and J_ji = -a_ij. A row lies together in
/// memory with its column, so that products with J and with its transpose run in parallel without
/// scattering.
class CapacityJacobian {
 public:
  /// \param members the sites of the cells, as in Term; must outlive the Jacobian
  /// \param bases   of the tangent planes, per site
  /// \param factor  all entries are multiplied with it
  CapacityJacobian(const RestrictedVoronoi& diagram, const std::vector<std::int32_t>& members,
                   const std::vector<TangentBasis>& bases, double factor);

  /// Add J^T J v to `result`; both hold all sites.
  /// \param change a buffer
  void add_product(const TangentVectors& v, std::vector<double>& change,
                   TangentVectors& result) const;

  /// Add the diagonal blocks of J^T J.
  void add_blocks(std::vector<TangentBlock>& blocks) const;

 private:
  struct Entry {
    std::int32_t other;  // cell j
    Tangent out;         // a_ij, in the plane of i
    Tangent in;          // a_ji, in the plane of j
  };

  [[nodiscard]] std::size_t site(std::size_t cell) const {
    return members_.empty() ? cell : static_cast<std::size_t>(members_[cell]);
  }
  [[nodiscard]] std::span<const Entry> row(std::size_t cell) const {
    return std::span(entries_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
  }

  const std::vector<std::int32_t>& members_;
  std::vector<Tangent> own_;         // J_ii
  std::vector<std::size_t> starts_;  // rows of entries_, one more than cells
  std::vector<Entry> entries_;
};

}  // namespace dapple
