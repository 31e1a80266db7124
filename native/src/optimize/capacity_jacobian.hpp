// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "optimize/tangent_vectors.hpp"
#include "voronoi/site_graph.hpp"

namespace dapple {

/// The Jacobian J of the capacities of one term's cells, on the tangent planes: with a_ij the
/// boundary fluxes (paper, Theorem 2), J_ii = sum_j a_ij and J_ji = -a_ij. It is kept by rows and
/// by columns, so that products with J and with its transpose run in parallel without scattering,
/// and read no more than they need: memory is what bounds them.
class CapacityJacobian {
 public:
  /// \param members the sites of the cells, as in Term; must outlive the Jacobian
  /// \param bases   of the tangent planes, per site
  /// \param factor  all entries are multiplied with it
  CapacityJacobian(const RestrictedVoronoi& diagram, std::span<const std::int32_t> members,
                   const std::vector<TangentBasis>& bases, double factor) {
    update(diagram, members, bases, factor);
  }
  /// Of no cells, until update().
  CapacityJacobian() = default;

  /// Of other cells, in the same memory.
  void update(const RestrictedVoronoi& diagram, std::span<const std::int32_t> members,
              const std::vector<TangentBasis>& bases, double factor);

  /// Add J^T J v to `result`; both hold all sites.
  /// \param change a buffer
  void add_product(const TangentVectors& v, std::vector<double>& change,
                   TangentVectors& result) const;

  /// Add the diagonal blocks of J^T J.
  void add_blocks(std::vector<TangentBlock>& blocks) const;

 private:
  [[nodiscard]] std::size_t site(std::size_t cell) const {
    return members_.empty() ? cell : static_cast<std::size_t>(members_[cell]);
  }

  /// The entries of a cell; fewer than its boundaries if several have the same neighbor.
  struct Row {
    std::uint32_t first = 0, count = 0;
    [[nodiscard]] std::size_t end() const { return std::size_t{first} + count; }
  };
  /// An entry a_ji of a cell i that does not list its neighbor j.
  struct Unlisted {
    std::size_t cell, other;
    Tangent in;
  };
  static constexpr std::size_t kNone = ~std::size_t{0};

  void put_row(const RestrictedVoronoi& diagram, const std::vector<TangentBasis>& bases,
               double factor, std::size_t cell);
  void find_columns(const std::vector<TangentBasis>& bases, double factor);
  [[nodiscard]] std::size_t entry(std::size_t cell, std::size_t other) const;
  void prefetch_after(const std::vector<Tangent>& entries, std::size_t cell) const;

  std::span<const std::int32_t> members_;
  std::vector<Tangent> own_;          // J_ii
  std::vector<Row> rows_;             // of the entries of a cell i
  std::vector<std::int32_t> others_;  // per entry: cell j
  std::vector<Tangent> out_;          // per entry: a_ij, in the plane of i
  std::vector<Tangent> in_;           // per entry: a_ji, in the plane of j
  std::vector<Unlisted> unlisted_;    // sorted
};

}  // namespace dapple
