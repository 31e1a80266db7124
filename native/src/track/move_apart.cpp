// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/move_apart.hpp"

#include <algorithm>
#include <dapple/neighbors.hpp>

#include "base/progress.hpp"
#include "optimize/chosen_sites.hpp"
#include "optimize/contacts.hpp"

namespace dapple {
namespace {

constexpr int kPushes = 8;            // pushing moves sites into others, which move in the next one
constexpr double kReach = 4.0;        // of a distance: so far from a crowd sites may have to move
constexpr double kBeyond = 1.5;       // of a distance: two sites farther apart do not meet
constexpr double kNearly = 0.02;      // of a distance: what may be missing
constexpr double kSameSide = -0.5;    // cosine between normals: 120 degrees
constexpr double kCoincident = 1e-6;  // of a distance: assumed between coincident sites

/// The sites of one push.
class Crowd {
 public:
  Crowd(const Domain& domain, const std::vector<double>& least, const Sites& sites)
      : least_(least), sites_(sites), tree_(sites.positions) {
    normals_.reserve(sites.size());
    for (const std::int32_t face : sites.faces) normals_.push_back(domain.normal(face));
    largest_ = least.empty() ? 0.0 : 2.0 * *std::max_element(least.begin(), least.end());
  }

  /// Moves that separate the sites that are too near; none if there are no such sites.
  [[nodiscard]] Vectors moves() const {
    std::vector<bool> around(sites_.size(), false);
    bool any = false;
    for (std::size_t k = 0; k < sites_.size(); ++k) {
      if (!is_crowded(k)) continue;
      any = true;
      tree_.within(sites_.positions[k], kReach * largest_, found_);
      for (const Neighbor& one : found_) around[static_cast<std::size_t>(one.index)] = true;
    }
    if (!any) return {};
    Vectors result(sites_.size(), Vec3::Zero());
    separate(contacts(around), result);
    return result;
  }

 private:
  [[nodiscard]] double apart(std::size_t i, std::size_t j) const { return least_[i] + least_[j]; }

  [[nodiscard]] bool is_same_side(std::size_t i, std::size_t j) const {
    return normals_[i].dot(normals_[j]) > kSameSide;
  }

  [[nodiscard]] bool is_crowded(std::size_t k) const {
    tree_.within(sites_.positions[k], largest_, found_);
    return std::any_of(found_.begin(), found_.end(), [&](const Neighbor& one) {
      const auto j = static_cast<std::size_t>(one.index);
      const double enough = (1.0 - kNearly) * apart(k, j);
      return j != k && one.squared_distance < enough * enough && is_same_side(k, j);
    });
  }

  [[nodiscard]] std::vector<Contact> contacts(const std::vector<bool>& around) const {
    static const std::vector<bool> kNoneLocked;
    const Planes planes{normals_, kNoneLocked};
    std::vector<Contact> result;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if (!around[i]) continue;
      tree_.within(sites_.positions[i], kBeyond * largest_, found_);
      for (const Neighbor& one : found_) {
        const auto j = static_cast<std::size_t>(one.index);
        if (j == i || (around[j] && j < i) || !is_same_side(i, j)) continue;
        const double enough = apart(i, j);
        if (enough > 0.0) add_contact(planes, i, j, offset(i, j), enough, kNearly * enough, result);
      }
    }
    return result;
  }

  /// From j to i; coincident sites move apart in some direction.
  [[nodiscard]] Vec3 offset(std::size_t i, std::size_t j) const {
    Vec3 d = sites_.positions[i] - sites_.positions[j];
    if (d.squaredNorm() > 0.0) return d;
    const bool flat = normals_[i].squaredNorm() > 0.0;
    return kCoincident * apart(i, j) * (flat ? normals_[i].unitOrthogonal() : Vec3(Vec3::UnitX()));
  }

  const std::vector<double>& least_;
  const Sites& sites_;
  Neighbors tree_;
  Vectors normals_;
  double largest_ = 0.0;
  mutable std::vector<Neighbor> found_;  // memory of the searches
};

}  // namespace

void move_apart(const Domain& domain, const std::vector<double>& least, Sites& sites,
                Context* context) {
  for (int push = 0; push < kPushes; ++push) {
    check_context(context);
    const Vectors moves = Crowd(domain, least, sites).moves();
    std::vector<std::int32_t> pushed;
    for (std::size_t k = 0; k < moves.size(); ++k)
      if (moves[k].squaredNorm() > 0.0) pushed.push_back(static_cast<std::int32_t>(k));
    if (pushed.empty()) return;
    Sites moved = select(sites, pushed);
    for (std::size_t k = 0; k < pushed.size(); ++k)
      moved.positions[k] += moves[static_cast<std::size_t>(pushed[k])];
    put(sites, pushed, domain.project(moved.positions, moved.faces, context));
  }
}

}  // namespace dapple
