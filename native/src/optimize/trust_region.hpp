// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/gauss_newton.hpp"
#include "optimize/lbfgs.hpp"

namespace dapple {

/// Steps of the model Hessian (GaussNewton), or of L-BFGS around it where there are pairs. delta
/// stands for the trust region's radius: a larger one makes shorter steps.
class TrustRegion {
 public:
  /// \param max_step the radius, in local spacings
  /// \param exact whether the linear system is solved well, for the long waves of a deformation
  /// \param careful whether one move that is too long shortens all of them, and moves that bring
  ///                sites near each other are halved; otherwise moves that are too long are cut,
  ///                unless the last step failed
  TrustRegion(double max_step, bool exact, bool careful)
      : max_step_(max_step), exact_(exact), careful_(careful) {}

  /// Begin with a delta below which it never falls.
  void set_least_delta(double delta) { trust_.delta = least_delta_ = delta; }

  /// A descent direction within the trust region; the boundaries' share falls, delta grows, and
  /// pairs are forgotten, until there is one.
  /// \throw Cancelled
  [[nodiscard]] Vectors step(const Objective& objective, const Evaluation& state,
                             LbfgsHistory& history, const Context* context = nullptr);

  /// Whether the last step was that of the model, which nothing held back: nearly Newton's.
  [[nodiscard]] bool follows_model() const;

  /// \param found whether the step lowered the energy
  /// \param shortened factor of the step; 1: not shortened
  void update_radius(bool found, double shortened);

  /// The decrease that a full step of the model predicts.
  [[nodiscard]] double promised(const Objective& objective, const Evaluation& state,
                                const Context* context = nullptr);

 private:
  [[nodiscard]] bool is_careful() const { return careful_ || failed_; }
  void trust_boundaries_less();
  void hold_discs(const Objective& objective, const Evaluation& state, Vectors& direction);

  GaussNewton model_;  // of one step after another
  double max_step_;
  bool exact_, careful_;
  Trust trust_;
  double least_delta_ = 1.0;
  bool failed_ = false;    // whether the last step did
  bool separates_ = true;  // crowded sites, unless the last step failed or was shortened
};

}  // namespace dapple
