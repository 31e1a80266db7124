// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/discs.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <map>
#include <memory>
#include <utility>

#include "optimize/contacts.hpp"

namespace dapple {
namespace {

constexpr double kNearly = 1e-4;      // of R: the overlap that may remain
constexpr double kMargin = 3e-4;      // of R: the distance kept beyond R
constexpr double kCoincident = 1e-9;  // of R: assumed distance between coincident sites
constexpr double kSameSide = -0.5;    // cosine between normals: 120 degrees

/// Discs of one radius, with their periodic images on a torus.
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
  int images_;  // periodic images in each direction
  double period_;
  std::vector<Vec3> points_;
  std::unique_ptr<Neighbors> tree_;
};

/// An offset that is not zero. Coincident sites overlap too and must move apart in some tangential
/// direction, or in any direction on a face without area, which has no normal.
Vec3 never_zero(const Vec3& offset, const Vec3& normal, double apart) {
  if (offset.squaredNorm() > 0.0) return offset;
  const Vec3 along = normal.squaredNorm() > 0.0 ? normal.unitOrthogonal() : Vec3(Vec3::UnitX());
  return kCoincident * apart * along;
}

/// Call visit(i, j, offset from j to i, R) once for every two discs on the same side that are
/// nearer than R + beyond, unless both are points.
template <typename Visit>
void for_each_pair(const Discs& discs, double beyond, const Visit& visit) {
  std::map<double, std::vector<std::int32_t>> by_radius;
  for (std::size_t k = 0; k < discs.radii.size(); ++k)
    by_radius[discs.radii[k]].push_back(static_cast<std::int32_t>(k));
  std::map<double, Crowd> crowds;
  for (auto& [radius, members] : by_radius)
    crowds.try_emplace(radius, discs.sites, std::move(members), discs.period);
  std::vector<Neighbor> found;
  for (const auto& [large, from] : crowds) {
    if (large == 0.0) continue;
    for (const auto& [small, to] : crowds) {
      if (small > large) break;
      for (const std::int32_t member : from.members()) {
        const auto i = static_cast<std::size_t>(member);
        const double apart = large + small;
        to.for_each_within(discs.sites.positions[i], apart + beyond, found,
                           [&, same = small == large](std::int32_t other, const Vec3& d) {
                             const auto j = static_cast<std::size_t>(other);
                             if (j == i || (same && j < i)) return;
                             if (discs.normals[i].dot(discs.normals[j]) > kSameSide)
                               visit(i, j, never_zero(d, discs.normals[i], apart), apart);
                           });
      }
    }
  }
}

double longest(const Vectors& moves) {
  double most = 0.0;
  for (const Vec3& move : moves) most = std::max(most, move.squaredNorm());
  return std::sqrt(most);
}

std::vector<Contact> contacts_of(const Discs& discs, const std::vector<bool>& locked,
                                 double beyond) {
  std::vector<Contact> found;
  const Planes planes{discs.normals, locked};
  for_each_pair(discs, beyond, [&](std::size_t i, std::size_t j, const Vec3& d, double apart) {
    add_contact(planes, i, j, d, (1.0 + kMargin) * apart, kNearly * apart, found);
  });
  return found;
}

double largest_excess(const std::vector<Contact>& contacts, const Vectors& moves) {
  double most = 0.0;
  for (const Contact& contact : contacts) most = std::max(most, contact.excess(moves));
  return most;
}

}  // namespace

Repulsion evaluate_disc_repulsion(const Discs& discs, double weight) {
  Repulsion repulsion;
  repulsion.gradient.assign(discs.sites.size(), Vec3::Zero());
  for_each_pair(discs, 0.0, [&](std::size_t i, std::size_t j, const Vec3& d, double apart) {
    if (const auto push = push_between(i, j, d, apart, weight)) add(repulsion, *push);
  });
  return repulsion;
}

std::vector<Contact> discs_brought_together(const Discs& discs, const std::vector<bool>& locked,
                                            const Vectors& moves) {
  std::vector<Contact> contacts = contacts_of(discs, locked, 2.0 * longest(moves));
  std::erase_if(contacts, [&](const Contact& contact) { return !(contact.excess(moves) > 0.0); });
  return contacts;
}

void keep_discs_apart(const Discs& discs, const std::vector<bool>& locked, Vectors& moves) {
  const double reach = 2.0 * longest(moves);
  const std::vector<Contact> contacts = contacts_of(discs, locked, reach);
  const double push = largest_excess(contacts, moves);
  if (!(push > 0.0)) return;
  separate(contacts_of(discs, locked, reach + 2.0 * push), moves);  // pushed discs may meet others
}

}  // namespace dapple
