// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numeric>

#include "optimize/boundary_curvature.hpp"
#include "optimize/capacity_jacobian.hpp"
#include "optimize/contacts.hpp"
#include "optimize/objective.hpp"

namespace dapple {

/// How much of the model a trust region believes.
struct Trust {
  double delta = 1.0;       ///< weight of diag(m): a larger one makes a shorter step
  double boundaries = 0.0;  ///< share of the boundaries' curvature, 0..1: a larger one makes a
                            ///< longer step
};

/// The model Hessian of an objective on the tangent planes, locked sites left out: the sum over the
/// terms of scale (2 delta diag(m) + 2 lambda J^T J + the repulsion's part), with J the Jacobian of
/// the capacities, and what holds sites back. Its first part is Lloyd's step scaled by delta, which
/// a trust region raises to shorten the step. Where a lattice is wanted, and with several classes,
/// a share of the boundaries' curvature is subtracted: with all of it the first part is the Hessian
/// of E_cvt.
class GaussNewton {
 public:
  /// Of nothing, until update().
  GaussNewton() = default;
  GaussNewton(const Objective& objective, const Evaluation& state, int steps,
              const Context* context = nullptr) {
    update(objective, state, steps, context);
  }

  /// At another state, in the same memory. All arguments must outlive the use of solve().
  /// \param steps of conjugate gradients, at most
  /// \param context checked for cancellation at each step, no more
  /// \throw Cancelled
  void update(const Objective& objective, const Evaluation& state, int steps,
              const Context* context);

  /// Keep a solution from bringing sites together: each contact becomes a spring that pulls its
  /// sites to their least distance. Until the next update().
  /// \param b receives the pulls; that of which solve() is asked next
  void hold(std::span<const Contact> contacts, Vectors& b);

  /// Solve H x = b approximately by conjugate gradients with a block-Jacobi preconditioner; b
  /// restricted.
  /// \throw Cancelled
  [[nodiscard]] Vectors solve(const Vectors& b, const Trust& trust);

  /// Whether the model has the boundaries' curvature.
  [[nodiscard]] bool has_boundaries() const { return !boundaries_.empty(); }
  /// Whether H was not positive definite when last used, so that the boundaries' share is too
  /// large.
  [[nodiscard]] bool is_indefinite() const { return indefinite_; }

 private:
  /// One side of a pair of close sites, scaled by the root of its stiffness.
  struct Side {
    std::int32_t other;
    Tangent own, others;  // the direction, in the planes of the two
  };
  /// Pairs, seen from both of their sites.
  struct Springs {
    std::vector<std::size_t> starts;  // rows of sides, one more than sites
    std::vector<Side> sides;
    /// Make room.
    /// \param visit_pairs calls what it is given with the two sites of each pair
    /// \return per site, where its next side goes
    template <typename VisitPairs>
    std::vector<std::size_t> lay_out(std::size_t sites, const VisitPairs& visit_pairs) {
      starts.assign(sites + 1, 0);
      visit_pairs([&](std::size_t i, std::size_t j) {
        ++starts[i + 1];
        ++starts[j + 1];
      });
      std::partial_sum(starts.begin(), starts.end(), starts.begin());
      sides.resize(starts.back());
      return {starts.begin(), starts.end() - 1};
    }
    [[nodiscard]] std::span<const Side> of(std::size_t site) const {
      if (sides.empty()) return {};
      return std::span(sides).subspan(starts[site], starts[site + 1] - starts[site]);
    }
  };

  /// From residual_ to x_.
  void iterate(const Trust& trust);
  void add_masses(const Objective& objective, const Evaluation& state);
  void add_pairs(const Objective& objective, const Evaluation& state);
  void add_boundaries(const Objective& objective, const Evaluation& state);
  void add_blocks();
  [[nodiscard]] bool subtracts_boundaries(const Trust& trust) const {
    return trust.boundaries > 0.0 && has_boundaries();
  }
  void apply(const TangentVectors& v, const Trust& trust, TangentVectors& result);
  /// Of the anchoring, toward the moves in_space_.
  [[nodiscard]] Tangent pull_of_neighbors(std::size_t k) const;
  void precondition(const Trust& trust);

  int steps_ = 0;
  const Context* context_ = nullptr;
  double unit_ = 1.0;  // all entries are divided by it
  std::vector<TangentBasis> bases_;
  std::vector<double> masses_;  // factors of delta on the diagonal
  const Anchoring* anchoring_ = nullptr;
  std::vector<double> held_;  // what it adds to the diagonal; empty: nothing
  std::vector<CapacityJacobian> terms_;
  std::vector<BoundaryCurvature> boundaries_;  // of each term; empty: not of the model
  std::vector<TangentBlock> boundary_blocks_;  // on their diagonal
  Springs pairs_, contacts_;
  std::vector<TangentBlock> blocks_;  // on the diagonal, without what trust multiplies
  std::vector<bool> locked_;
  // Of conjugate gradients.
  std::vector<TangentBlock> inverse_;  // of the diagonal blocks; nothing where a site is locked
  TangentVectors x_, residual_, preconditioned_, direction_, applied_;
  Vectors in_space_;            // the vectors that H is applied to; empty: no neighbors are tied
  std::vector<double> change_;  // of capacities
  bool indefinite_ = false;
};

}  // namespace dapple
