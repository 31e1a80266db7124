// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/dart_set.hpp"

#include <algorithm>
#include <cmath>

namespace dapple {

bool DartSet::refuses(const Dart& dart, double radius) const {
  const auto reach = [&](const DartGrid::Member& other) {
    return see_each_other(dart, other) ? std::min(radius, other.radius) : 0.0;
  };
  return std::any_of(grids_.begin(), grids_.end(), [&](const auto& entry) {
    const double most = std::min(radius, std::ldexp(1.0, entry.first));
    return entry.second.refuses(dart, most, reach);
  });
}

void DartSet::refuse(std::span<DartGrid::Asked> asked) const {
  std::vector<double> radii;
  for (const DartGrid::Asked& one : asked) radii.push_back(one.most);
  for (const auto& [octave, grid] : grids_) {
    for (std::size_t k = 0; k < asked.size(); ++k)
      asked[k].most = std::min(radii[k], std::ldexp(1.0, octave));
    grid.refuse(asked, [&](const DartGrid::Asked& one, const DartGrid::Member& other) {
      const double radius = radii[static_cast<std::size_t>(&one - asked.data())];
      return see_each_other(*one.dart, other) ? std::min(radius, other.radius) : 0.0;
    });
  }
}

void DartSet::clear() {
  entries_.clear();
  for (auto& [octave, grid] : grids_) grid.clear();
}

void DartSet::insert(const Dart& dart, double radius) {
  entries_.push_back({dart, radius});
  place(entries_.back());
}

void DartSet::scale(double factor) {
  grids_.clear();
  for (Entry& entry : entries_) {
    entry.radius *= factor;
    place(entry);
  }
}

void DartSet::place(const Entry& entry) {
  const int octave = std::ilogb(entry.radius) + 1;
  grids_.try_emplace(octave, std::ldexp(1.0, octave), period_)
      .first->second.insert(entry.dart, entry.radius);
}

}  // namespace dapple
