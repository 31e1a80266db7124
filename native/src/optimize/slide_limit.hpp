// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimize/objective.hpp"

namespace dapple {

/// Projects moved sites so that none ends farther from its start than max_slide spacings, its own
/// and the surface's.
class SlideLimit {
 public:
  /// \param max_slide in spacings; infinite: no limit
  SlideLimit(const Objective& objective, double max_slide)
      : objective_(&objective), max_slide_(max_slide) {}

  void set_home(Sites home) { home_ = std::move(home); }
  [[nodiscard]] const Sites& home() const { return home_; }

  /// Whether a site is beyond the limit.
  [[nodiscard]] bool exceeded(const Evaluation& state) const;

  /// The projections of moved sites. A projection can carry a site that was held back farther again
  /// (around a bend, to another sheet): it is pulled toward its start until it does not.
  /// \param state whose sites are moved
  /// \param hints faces near the points
  /// \throw Cancelled
  [[nodiscard]] Sites project(const Evaluation& state, Vectors moved,
                              std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const;

 private:
  [[nodiscard]] double reach(const Evaluation& state, std::size_t k) const;
  bool pull_back(const Evaluation& state, Sites& sites, Vectors& moved, double part,
                 const Context* context) const;

  const Objective* objective_;
  double max_slide_;
  Sites home_;
};

}  // namespace dapple
