// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <numeric>

namespace dapple {

/// What the time of a piece of work goes to. Of stages within each other the innermost counts:
/// cells that the start asks for are cells.
enum class Stage {
  kStart,       ///< where the optimization begins
  kNeighbors,   ///< which sites are near each: boxes around them, searches, bisectors; on flat
                ///< domains also whose cells touch
  kCells,       ///< Voronoi cells: clipping, integrals, faces that no flood reached
  kSolver,      ///< energy and gradient from the cells, model Hessian, line search, vectors
  kProjection,  ///< of moved sites back onto the domain
  kReporting,   ///< normals, evenness, bond order
  kOther        ///< checks, densities of classes, deformed surfaces, threads
};

inline constexpr std::array<const char*, 7> kStageNames = {
    "start", "neighbors", "cells", "solver", "projection", "reporting", "other"};

/// Wall time by stage.
struct Profile {
  std::array<double, kStageNames.size()> seconds = {};

  [[nodiscard]] double& operator[](Stage stage) { return seconds[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] double operator[](Stage stage) const {
    return seconds[static_cast<std::size_t>(stage)];
  }
  [[nodiscard]] double total() const {
    return std::accumulate(seconds.begin(), seconds.end(), 0.0);
  }
};

}  // namespace dapple
