// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/anchoring.hpp"

#include <utility>

namespace dapple {

Anchoring::Anchoring(const RestrictedVoronoi& start, Vectors anchors, double scale,
                     const Hold& hold)
    : anchors_(std::move(anchors)), starts_(anchors_.size() + 1, 0) {
  for (const Moments& cell : start.cells) {
    held_.push_back(hold.stickiness * scale * cell.mass);
    tied_.push_back(hold.smoothing * scale * cell.mass);
  }
  if (!(hold.smoothing > 0.0)) return;
  for (std::size_t k = 0; k < anchors_.size(); ++k) {
    for (const CellBoundary& side : start.boundary(k)) neighbors_.push_back(side.neighbor);
    starts_[k + 1] = neighbors_.size();
  }
}

std::span<const std::int32_t> Anchoring::neighbors(std::size_t k) const {
  return std::span(neighbors_).subspan(starts_[k], starts_[k + 1] - starts_[k]);
}

double Anchoring::energy(const Vectors& positions, std::size_t k) const {
  const Vec3 own = slide(positions, k);
  double sum = held_[k] * own.squaredNorm();
  for (const std::int32_t neighbor : neighbors(k)) {
    const auto j = static_cast<std::size_t>(neighbor);
    sum += 0.5 * stiffness(k, j) * (own - slide(positions, j)).squaredNorm();
  }
  return sum;
}

Vec3 Anchoring::gradient(const Vectors& positions, std::size_t k) const {
  const Vec3 own = slide(positions, k);
  Vec3 sum = held_[k] * own;
  for (const std::int32_t neighbor : neighbors(k)) {
    const auto j = static_cast<std::size_t>(neighbor);
    sum += stiffness(k, j) * (own - slide(positions, j));
  }
  return 2.0 * sum;
}

double Anchoring::stiffness(std::size_t k) const {
  double sum = held_[k];
  for (const std::int32_t j : neighbors(k)) sum += stiffness(k, static_cast<std::size_t>(j));
  return sum;
}

}  // namespace dapple
