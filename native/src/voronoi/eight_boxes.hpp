// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/types.hpp>

#include "voronoi/half_spaces.hpp"

namespace dapple {

/// A box in space; a point is a box too.
struct Box {
  Vec3 low, high;
};

/// Coordinates of eight points or corners of boxes, by axis.
using Eight = std::array<std::array<double, 8>, 3>;

/// Compares eight boxes with another one at once, by the instructions of the machine: a bit
/// for each whose squared distance is below a limit, the lowest for the first. Every instruction
/// set gives the same bits.
using CompareBoxes = unsigned (*)(const Eight& low, const Eight& high, const Box& query,
                                  double limit);
[[nodiscard]] CompareBoxes compare_boxes(InstructionSet set = instruction_sets().back());

/// The squared distances themselves.
[[nodiscard]] std::array<double, 8> squared_distances(const Eight& low, const Eight& high,
                                                      const Box& query);

}  // namespace dapple
