// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/reinsertion.hpp"

#include <cmath>
#include <dapple/neighbors.hpp>
#include <numbers>
#include <set>

#include "base/tangent_basis.hpp"

namespace dapple {
namespace {

constexpr double kEmpty = 1e-6;  // of the mean capacity: such cells may result from rounding

/// The capacity of the smallest cell that does not count as empty, for a nonempty term.
double least_capacity(const Objective& objective, std::size_t term, std::size_t sites) {
  return kEmpty * objective.terms[term].mean_capacity(sites);
}

class Reinserter {
 public:
  Reinserter(const Objective& objective, const Evaluation& state)
      : objective_(objective), state_(state) {}

  Reinsertion run() {
    find_empty();
    if (empty_.empty()) return {};
    find_held();
    if (held_.empty()) return {};
    const Neighbors tree(held_positions_);
    std::vector<Neighbor> found;
    Reinsertion result;
    for (const std::size_t site : empty_) {
      tree.nearest(state_.sites.positions[site], 1, found);
      const std::size_t host = roomiest(held_[static_cast<std::size_t>(found[0].index)]);
      taken_.insert(host);
      result.sites.push_back(static_cast<std::int32_t>(site));
      result.positions.push_back(open_place(host));
      result.faces.push_back(state_.sites.faces[host]);
    }
    return result;
  }

 private:
  [[nodiscard]] const Moments& cell(std::size_t site) const { return state_.diagram().cells[site]; }

  [[nodiscard]] bool is_held(std::size_t site, double least) const {
    return cell(site).capacity > least;
  }

  void find_empty() {
    const double least = least_capacity(objective_, 0, state_.sites.size());
    for (std::size_t k = 0; k < state_.sites.size(); ++k)
      if (!is_held(k, least) && (objective_.locked.empty() || !objective_.locked[k]))
        empty_.push_back(k);
  }

  void find_held() {
    const double least = least_capacity(objective_, 0, state_.sites.size());
    for (std::size_t k = 0; k < state_.sites.size(); ++k) {
      if (!is_held(k, least)) continue;
      held_.push_back(k);
      held_positions_.push_back(state_.sites.positions[k]);
    }
  }

  /// The largest of a cell and its neighbors to which no site has been moved yet.
  [[nodiscard]] std::size_t roomiest(std::size_t start) const {
    std::size_t best = start;
    for (const CellBoundary& side : state_.diagram().boundary(start)) {
      const auto j = static_cast<std::size_t>(side.neighbor);
      const bool free = !taken_.contains(j);
      if (free && (taken_.contains(best) || cell(j).capacity > cell(best).capacity)) best = j;
    }
    return best;
  }

  [[nodiscard]] Vec3 open_place(std::size_t host) const {
    const Vec3& x = state_.sites.positions[host];
    const CellBoundary* farthest = nullptr;
    for (const CellBoundary& side : state_.diagram().boundary(host))
      if (!farthest || side.offset.squaredNorm() > farthest->offset.squaredNorm()) farthest = &side;
    if (farthest) return x + 0.5 * farthest->offset;
    const Vec3 aside = tangent_basis(state_.normals[host]).col(0);  // defined even without a normal
    return x + std::sqrt(cell(host).area / std::numbers::pi) * aside;
  }

  const Objective& objective_;
  const Evaluation& state_;
  std::vector<std::size_t> empty_;
  std::vector<std::size_t> held_;  // sites that have a cell
  Vectors held_positions_;
  std::set<std::size_t> taken_;
};

}  // namespace

Reinsertion find_reinsertion(const Objective& objective, const Evaluation& state) {
  return Reinserter(objective, state).run();
}

bool has_empty_cell(const Objective& objective, const Evaluation& state) {
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const std::vector<Moments>& cells = state.parts[t].energy.diagram.cells;
    const std::vector<std::int32_t>& members = objective.terms[t].members;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::size_t site = members.empty() ? k : static_cast<std::size_t>(members[k]);
      const bool locked = !objective.locked.empty() && objective.locked[site];
      if (!locked && !(cells[k].capacity > least_capacity(objective, t, cells.size()))) return true;
    }
  }
  return false;
}

}  // namespace dapple
