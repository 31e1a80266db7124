// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <span>
#include <vector>

#include "start/dart_grid.hpp"

namespace dapple {

/// Darts that keep apart from each other: two of radius r and s by min(r, s). They are kept by
/// octaves of their radius, so that a steep density stays quick.
class DartSet {
 public:
  /// \param period as for DartGrid
  explicit DartSet(double period) : period_(period) {}

  /// Whether another that it sees lies too near.
  [[nodiscard]] bool refuses(const Dart& dart, double radius) const;
  /// The same for many, each with its radius as the most that it asks for; see DartGrid::refuse().
  void refuse(std::span<DartGrid::Asked> asked) const;
  void insert(const Dart& dart, double radius);
  /// Forget all darts, but not the memory that they had.
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
