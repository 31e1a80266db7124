// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// Connect border edges that lie at the same place, as if their vertices were one.
///
/// Files repeat vertices along hard edges and texture seams, and triangle soups along every edge;
/// what looks like a border there is none. Edges that already have a second face stay as they are,
/// unless a border edge lies on them. Faces that lie on each other are never connected, so that two
/// solids or sheets that merely touch stay apart.
/// \param vertices  in the order that `faces` refers to
/// \param tolerance distance up to which two vertices are at the same place, >= 0
/// \param left_out  per face, whether it is connected to nothing; empty: none is
/// \param next_around per half-edge the next one around its edge; changed where edges become one
/// \return per vertex the lowest one that it hangs together with
[[nodiscard]] std::vector<std::int32_t> weld_borders(std::span<const Vec3> vertices,
                                                     double tolerance, std::span<const Face> faces,
                                                     const std::vector<bool>& left_out,
                                                     std::vector<std::int32_t>& next_around,
                                                     Context* context = nullptr);

}  // namespace dapple
