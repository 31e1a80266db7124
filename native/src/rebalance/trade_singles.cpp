// SPDX-License-Identifier: GPL-3.0-or-later
#include "rebalance/trade_singles.hpp"

#include <cmath>
#include <numeric>
#include <utility>

namespace dapple {
namespace {

constexpr double kLevel = 0.5;       // of the variation: cells of a place are off by more
constexpr double kGain = 0.05;       // of the squared deviations, which a trade lowers by more
constexpr double kFewest = 2.0;      // sites that a place keeps
constexpr std::size_t kNowhere = 0;  // the place of sites whose cells are even

/// Sites whose cells are all larger or all smaller than the mean.
struct Place {
  double sites = 0.0;
  double lacks = 0.0;  // sites; negative where it has too many

  /// The sum of the squared deviations of its cells after a change of its number, if they are
  /// alike.
  [[nodiscard]] double squares(double change) const {
    return (lacks - change) * (lacks - change) / (sites + change);
  }

  /// By how much a change lowers that sum.
  [[nodiscard]] double gain(double change) const {
    return sites + change < kFewest ? -1.0 : squares(0.0) - squares(change);
  }

  void add(double change) {
    sites += change;
    lacks -= change;
  }
};

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// Per cell, by how much it is larger than the mean, relative.
std::vector<double> deviations(const std::vector<Moments>& cells) {
  double sum = 0.0;
  for (const Moments& cell : cells) sum += cell.capacity;
  const double mean = sum / static_cast<double>(cells.size());
  std::vector<double> result;
  result.reserve(cells.size());
  for (const Moments& cell : cells) result.push_back(cell.capacity / mean - 1.0);
  return result;
}

/// The means over each cell and its neighbors, because single cells deviate anywhere.
std::vector<double> smoothed(const RestrictedVoronoi& diagram, const std::vector<double>& values) {
  std::vector<double> result;
  result.reserve(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    double sum = values[k];
    for (const CellBoundary& side : diagram.boundary(k))
      sum += values[static_cast<std::size_t>(side.neighbor)];
    result.push_back(sum / static_cast<double>(diagram.boundary(k).size() + 1));
  }
  return result;
}

class Trading {
 public:
  explicit Trading(const RestrictedVoronoi& diagram)
      : diagram_(diagram),
        deviations_(deviations(diagram.cells)),
        levels_(smoothed(diagram, deviations_)),
        squares_(sum_of_squares(deviations_)),
        least_(kLevel * std::sqrt(squares_ / static_cast<double>(diagram.cells.size()))),
        places_(1) {
    found_.of_sites.assign(diagram.cells.size(), kNowhere);
  }

  Exchange run() {
    for (std::size_t k = 0; k < levels_.size(); ++k)
      if (found_.of_sites[k] == kNowhere && side(k) != 0) gather(k);
    found_.changes.assign(places_.size(), 0);
    while (trade()) {
    }
    return std::move(found_);
  }

 private:
  /// 1 among large cells, -1 among small ones.
  [[nodiscard]] int side(std::size_t site) const {
    if (!(std::abs(levels_[site]) > least_)) return 0;
    return levels_[site] > 0.0 ? 1 : -1;
  }

  /// Make a place of the sites that are connected to the first one on its side.
  void gather(std::size_t first) {
    Place place;
    std::vector<std::size_t> waiting = {first};
    found_.of_sites[first] = places_.size();
    while (!waiting.empty()) {
      const std::size_t site = waiting.back();
      waiting.pop_back();
      place.sites += 1.0;
      place.lacks += deviations_[site];
      for (const CellBoundary& boundary : diagram_.boundary(site)) {
        const auto other = static_cast<std::size_t>(boundary.neighbor);
        if (found_.of_sites[other] != kNowhere || side(other) != side(first)) continue;
        found_.of_sites[other] = places_.size();
        waiting.push_back(other);
      }
    }
    places_.push_back(place);
  }

  /// The place that gains most by a change, without those that have changed the other way.
  [[nodiscard]] std::size_t best(int change) const {
    std::size_t result = kNowhere;
    for (std::size_t k = 1; k < places_.size(); ++k) {
      if (change * found_.changes[k] < 0) continue;
      if (result == kNowhere || places_[k].gain(change) > places_[result].gain(change)) result = k;
    }
    return result;
  }

  /// Trade one site, unless the capacities would hardly vary less.
  bool trade() {
    const std::size_t to = best(1), from = best(-1);
    if (to == from || to == kNowhere || from == kNowhere) return false;
    if (!(places_[to].gain(1.0) + places_[from].gain(-1.0) > kGain * squares_)) return false;
    change(to, 1);
    change(from, -1);
    return true;
  }

  void change(std::size_t place, int by) {
    places_[place].add(by);
    found_.changes[place] += by;
  }

  const RestrictedVoronoi& diagram_;
  std::vector<double> deviations_, levels_;
  double squares_, least_;
  std::vector<Place> places_;  // the first one stays empty
  Exchange found_;
};

}  // namespace

Exchange find_trades(const RestrictedVoronoi& diagram) { return Trading(diagram).run(); }

}  // namespace dapple
