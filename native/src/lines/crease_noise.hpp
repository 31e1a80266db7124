// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <span>
#include <vector>

#include "lines/line_edges.hpp"

namespace dapple {

/// Drop creases that are noise of a scan at the scale of the rules; others and other lines stay.
/// \param signs per face, so that neighbors agree \param kinds per half-edge \throw Cancelled
void drop_noise(const OrderedSurface& mesh, std::span<const std::int8_t> signs,
                const LineRules& rules, const Context* context, std::vector<LineKind>& kinds);

/// Make an edge no line.
void drop_edge(const OrderedSurface& mesh, std::int32_t half_edge, std::vector<LineKind>& kinds);

}  // namespace dapple
