// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <deque>

#include "base/vectors.hpp"

namespace dapple {

/// The last few steps and the changes of the gradient along them (Nocedal 1980).
class LbfgsHistory {
 public:
  explicit LbfgsHistory(int size) : size_(static_cast<std::size_t>(size)) {}

  void forget() { pairs_.clear(); }
  [[nodiscard]] bool empty() const { return pairs_.empty(); }

  /// Keep a pair if it has positive curvature.
  void remember(Vectors step, Vectors change) {
    const double curvature = dot(step, change);
    if (curvature <= 1e-12 * std::sqrt(dot(step, step) * dot(change, change))) return;
    pairs_.push_back({std::move(step), std::move(change), curvature});
    if (pairs_.size() > size_) pairs_.pop_front();
  }

  /// step . change / change . change of the last pair: the plain method's guess of the inverse
  /// Hessian.
  [[nodiscard]] double scale() const {
    return pairs_.back().curvature / dot(pairs_.back().change, pairs_.back().change);
  }

  /// Minus the inverse Hessian times the gradient by the two-loop recursion, around `inverse(v)`,
  /// which stands for the inverse of the first guess. Old pairs leave today's tangent planes, so
  /// `restrict(v)` puts all back onto them.
  template <typename Restrict, typename Inverse>
  [[nodiscard]] Vectors direction(const Vectors& gradient, const Restrict& restrict,
                                  const Inverse& inverse) const {
    Vectors q = gradient;
    std::vector<double> alphas;
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
      alphas.push_back(dot(pair->step, q) / pair->curvature);
      add_scaled(q, -alphas.back(), pair->change);
    }
    restrict(q);
    q = inverse(q);
    auto alpha = alphas.rbegin();
    for (auto pair = pairs_.begin(); pair != pairs_.end(); ++pair, ++alpha)
      add_scaled(q, *alpha - dot(pair->change, q) / pair->curvature, pair->step);
    for (Vec3& v : q) v = -v;
    restrict(q);
    return q;
  }

 private:
  struct Pair {
    Vectors step;
    Vectors change;
    double curvature;  // step . change
  };

  std::size_t size_;
  std::deque<Pair> pairs_;
};

}  // namespace dapple
