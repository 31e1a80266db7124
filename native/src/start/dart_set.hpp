// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <span>
#include <vector>

#include "start/dart_grid.hpp"

namespace dapple {

/// Darts at a minimal distance from each other: min(r, s) for radii r and s. They are stored by
/// octaves of their radius, so that steep densities stay fast.
class DartSet {
 public:
  /// \param period as for DartGrid
  explicit DartSet(double period) : period_(period) {}

  /// Whether a dart on the same side is too close.
  [[nodiscard]] bool refuses(const Dart& dart, double radius) const;
  /// The same for many, each with its radius as the most that it asks for; see DartGrid::refuse().
  void refuse(std::span<DartGrid::Asked> asked) const;
  void insert(const Dart& dart, double radius);
  /// Remove all darts and keep their memory.
  void clear();
  /// Scale all radii.
  void scale(double factor);

 private:
  struct Entry {
    Dart dart;
    double radius;
  };
  void place(const Entry& entry);

  double period_;
  std::vector<Entry> entries_;
  std::map<int, DartGrid> grids_;
};

}  // namespace dapple
