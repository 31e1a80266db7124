// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sample/class_problem.hpp"

namespace dapple {

/// The classes as a problem over a surface.
/// \param sides the same for all classes; where they are not known, those of all sites together
/// \throw ArgumentError naming the first class whose surface is not of the same faces; if there is
/// no class
[[nodiscard]] ClassProblem surface_classes(const Surface& surface,
                                           std::span<const SampleClass> classes, Cells cells,
                                           KnownSides sides = std::nullopt);

}  // namespace dapple
