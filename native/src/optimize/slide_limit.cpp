// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/slide_limit.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {
namespace {

constexpr int kPulls = 8;      // attempts to pull a site beyond the limit back toward the start
constexpr double kPull = 0.8;  // share of the distance left after each attempt; 0 after the last

/// The projection can move even a site without a step, because of rounding or to a face with
/// density. Locked sites keep their exact positions.
Sites project_unlocked(const Objective& objective, const Sites& before, const Vectors& moved,
                       std::span<const std::int32_t> hints, const Context* context) {
  Sites sites = objective.project(moved, hints, {}, context);
  for (std::size_t k = 0; k < objective.locked.size(); ++k) {
    if (!objective.locked[k]) continue;
    sites.positions[k] = before.positions[k];
    sites.faces[k] = before.faces[k];
    sites.barycentric[k] = before.barycentric[k];
  }
  return sites;
}

}  // namespace

double SlideLimit::reach(const Evaluation& state, std::size_t k) const {
  return max_slide_ * std::min(local_spacing(*objective_, state, 0, k),
                               objective_->domain().spacing(state.sites.size()));
}

bool SlideLimit::exceeded(const Evaluation& state) const {
  for (std::size_t k = 0; k < home_.size(); ++k)
    if ((state.sites.positions[k] - home_.positions[k]).norm() > reach(state, k)) return true;
  return false;
}

Sites SlideLimit::project(const Evaluation& state, Vectors moved,
                          std::span<const std::int32_t> hints, const Context* context) const {
  if (std::isinf(max_slide_))
    return project_unlocked(*objective_, state.sites, moved, hints, context);
  for_each_vector(moved.size(), [&](std::size_t k) {
    const Vec3 slide = moved[k] - home_.positions[k];
    const double excess = slide.norm() / reach(state, k);
    if (excess > 1.0) moved[k] = home_.positions[k] + slide / excess;
  });
  Sites sites = project_unlocked(*objective_, state.sites, moved, hints, context);
  for (int pull = 0; pull < kPulls; ++pull)
    if (!pull_back(state, sites, moved, pull + 1 < kPulls ? kPull : 0.0, context)) break;
  return sites;
}

/// Project sites beyond the limit again, with `part` of their distance from the start.
/// \return whether any site was beyond the limit
bool SlideLimit::pull_back(const Evaluation& state, Sites& sites, Vectors& moved, double part,
                           const Context* context) const {
  std::vector<std::int32_t> far;
  Sites pulled;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    if ((sites.positions[k] - home_.positions[k]).norm() <= reach(state, k)) continue;
    moved[k] = home_.positions[k] + part * (moved[k] - home_.positions[k]);
    far.push_back(static_cast<std::int32_t>(k));
    pulled.positions.push_back(moved[k]);
    pulled.faces.push_back(home_.faces[k]);
    pulled.barycentric.push_back(home_.barycentric[k]);
  }
  if (far.empty()) return false;
  if (part > 0.0) pulled = objective_->project(pulled.positions, pulled.faces, far, context);
  put(sites, far, pulled);
  return true;
}

}  // namespace dapple
