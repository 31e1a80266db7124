// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/optimizer.hpp>
#include <vector>

namespace dapple {

/// Predicts the number of evaluations from the decreases of the energy. Nothing
/// but the progress depends on it.
class Forecast {
 public:
  /// \param tolerance decreases below which end the optimization
  /// \param restoring whether a deformed surface is only restored, which ends soon
  Forecast(const OptimizerOptions& options, double tolerance, bool restoring);

  /// After an iteration.
  /// \param evaluations so far
  /// \param decrease of the energy in it, relative
  void note(int evaluations, double decrease);

  [[nodiscard]] double evaluations() const;

  /// After so many evaluations; in [0, 1), and slower beyond those expected.
  [[nodiscard]] double progress(int evaluations) const;

 private:
  /// Decreases fall with a power of the number of evaluations: c / k^p of the energy at the k-th.
  struct Law {
    double power;
    double first;  // c, from a Poisson-disk start
  };
  static constexpr Law kTrustRegion{2.0, 4e-3}, kLineSearch{3.0, 1.0};

  Law law_;
  double tolerance_;
  double most_;
  std::vector<double> logs_;  // of c, at each iteration
};

/// The approximate number of evaluations of an optimization from a Poisson-disk start.
[[nodiscard]] double expected_evaluations(const OptimizerOptions& options);

}  // namespace dapple
