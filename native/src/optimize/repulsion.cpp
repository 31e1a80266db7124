// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/repulsion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <map>
#include <optional>

namespace dapple {
namespace {

// Of the repulsion radius: a step may end this near. Nearer, the smallest distance of the next
// state is what the step made of it; at 1 the steps lose too much (0.95 to 0.98 measured alike,
// 0.98 best).
constexpr double kNear = 0.98;

/// A pair and what drives its two sites apart.
struct Push {
  ClosePair pair;
  Vec3 force;
};

/// None if the two are not near enough to repel each other.
/// \param d from j to i
std::optional<Push> push_between(std::size_t i, std::size_t j, const Vec3& d, double radius,
                                 double weight) {
  const double distance = d.norm();
  if (distance >= radius || distance <= 0.0) return std::nullopt;
  const double overlap = 1.0 - distance / radius;
  const Vec3 direction = d / distance;
  return Push{{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), overlap,
               weight * overlap * overlap, 2.0 * weight / (radius * radius), direction},
              2.0 * weight * overlap / radius * direction};
}

void add(Repulsion& repulsion, const Push& push) {
  repulsion.energy += push.pair.energy;
  repulsion.gradient[static_cast<std::size_t>(push.pair.i)] -= push.force;
  repulsion.gradient[static_cast<std::size_t>(push.pair.j)] += push.force;
  repulsion.pairs.push_back(push.pair);
}

/// Call visit(i, j, offset from j to i, out) for every pair of sites whose cells touch, in
/// parallel, and return what it has put into `out`, in the order of the sites.
template <typename Found, typename Visit>
std::vector<Found> of_touching_pairs(const RestrictedVoronoi& diagram, const Visit& visit) {
  const std::size_t count = diagram.cells.size();
  std::vector<std::vector<Found>> found((count + kVectorGrain - 1) / kVectorGrain);
  parallel_chunks(count, kVectorGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const CellBoundary& side : diagram.boundary(i)) {
        const auto j = static_cast<std::size_t>(side.neighbor);
        // Each pair once: rounding aside, both cells list their common boundary.
        if (j >= i) visit(i, j, -side.offset, found[begin / kVectorGrain]);
      }
  });
  std::vector<Found> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Things of one radius, with their images around the torus.
class Crowd {
 public:
  Crowd(const Sites& sites, std::vector<std::int32_t> members, double period)
      : members_(std::move(members)), images_(period > 0.0 ? 1 : 0), period_(period) {
    for (const std::int32_t k : members_)
      for (int dx = -images_; dx <= images_; ++dx)
        for (int dy = -images_; dy <= images_; ++dy)
          points_.push_back(canonical(sites.positions[static_cast<std::size_t>(k)]) +
                            period_ * Vec3(dx, dy, 0.0));
    tree_ = std::make_unique<Neighbors>(points_);
  }

  /// Call visit(site, offset from it to the point) for all within the distance.
  template <typename Visit>
  void for_each_within(const Vec3& point, double distance, std::vector<Neighbor>& found,
                       const Visit& visit) const {
    const Vec3 from = canonical(point);
    tree_->within(from, distance, found);
    const int along = 2 * images_ + 1;
    const std::size_t copies = static_cast<std::size_t>(along) * static_cast<std::size_t>(along);
    for (const Neighbor& n : found) {
      const auto k = static_cast<std::size_t>(n.index);
      visit(members_[k / copies], from - points_[k]);
    }
  }

  [[nodiscard]] const std::vector<std::int32_t>& members() const { return members_; }

 private:
  [[nodiscard]] Vec3 canonical(const Vec3& p) const {
    if (period_ == 0.0) return p;
    return {p.x() - period_ * std::floor(p.x() / period_),
            p.y() - period_ * std::floor(p.y() / period_), p.z()};
  }

  std::vector<std::int32_t> members_;
  int images_;  // to each side
  double period_;
  std::vector<Vec3> points_;
  std::unique_ptr<Neighbors> tree_;
};

}  // namespace

void update_repulsion(Repulsion& repulsion, const RestrictedVoronoi& diagram,
                      const std::vector<double>& radii, double weight) {
  repulsion.energy = 0.0;
  repulsion.pairs.clear();
  repulsion.gradient.resize(diagram.cells.size());
  for_each_vector(diagram.cells.size(), [&](std::size_t k) { repulsion.gradient[k].setZero(); });
  if (weight == 0.0 || radii.empty()) return;
  const auto pushes = of_touching_pairs<Push>(
      diagram, [&](std::size_t i, std::size_t j, const Vec3& d, std::vector<Push>& out) {
        if (const auto push = push_between(i, j, d, 0.5 * (radii[i] + radii[j]), weight))
          out.push_back(*push);
      });
  for (const Push& push : pushes) add(repulsion, push);
}

std::size_t shorten_approaches(const RestrictedVoronoi& diagram, const std::vector<double>& radii,
                               Vectors& moves) {
  if (radii.empty()) return 0;
  using Pair = std::array<std::size_t, 2>;
  const auto near = of_touching_pairs<Pair>(
      diagram, [&](std::size_t i, std::size_t j, const Vec3& d, std::vector<Pair>& out) {
        const double least = std::min(kNear * 0.5 * (radii[i] + radii[j]), d.norm());
        if ((d + moves[i] - moves[j]).norm() < least) out.push_back({i, j});
      });
  std::vector<bool> shortened(radii.size(), false);
  for (const auto& [i, j] : near) shortened[i] = shortened[j] = true;
  for (std::size_t k = 0; k < radii.size(); ++k)
    if (shortened[k]) moves[k] *= 0.5;
  return static_cast<std::size_t>(std::count(shortened.begin(), shortened.end(), true));
}

Repulsion evaluate_disc_repulsion(const Sites& sites, const Vectors& normals,
                                  const std::vector<double>& radii, double period, double weight) {
  Repulsion repulsion;
  repulsion.gradient.assign(sites.size(), Vec3::Zero());
  std::map<double, std::vector<std::int32_t>> by_radius;
  for (std::size_t k = 0; k < radii.size(); ++k)
    if (radii[k] > 0.0) by_radius[radii[k]].push_back(static_cast<std::int32_t>(k));
  std::map<double, Crowd> crowds;
  for (auto& [radius, members] : by_radius)
    crowds.try_emplace(radius, sites, std::move(members), period);
  std::vector<Neighbor> found;
  for (const auto& [large, from] : crowds)
    for (const auto& [small, to] : crowds) {
      if (small > large) break;
      for (const std::int32_t member : from.members()) {
        const auto i = static_cast<std::size_t>(member);
        to.for_each_within(
            sites.positions[i], large + small, found,
            [&, r = large + small, same = small == large](std::int32_t other, const Vec3& d) {
              const auto j = static_cast<std::size_t>(other);
              if (j == i || (same && j < i)) return;
              if (normals[i].dot(normals[j]) <= -0.5) return;
              if (const auto push = push_between(i, j, d, r, weight)) add(repulsion, *push);
            });
      }
    }
  return repulsion;
}

const ClosePair* worst_pair(const Repulsion& repulsion) {
  const auto worst = std::max_element(
      repulsion.pairs.begin(), repulsion.pairs.end(),
      [](const ClosePair& a, const ClosePair& b) { return a.overlap < b.overlap; });
  return worst == repulsion.pairs.end() ? nullptr : &*worst;
}

}  // namespace dapple
