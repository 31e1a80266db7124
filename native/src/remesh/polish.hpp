// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "remesh/dual.hpp"
#include "remesh/site_editor.hpp"

namespace dapple {

/// Make thin triangles of a mesh wider: vertices slide along their lines or over the surface, edges
/// flip, and vertices beside others on a line go, as those that were added for the topology of the
/// cells. Lines and corners stay, and so does the topology. \param count vertices that are to be
/// left where there are as many: others are added for those that go \throw Cancelled
void polish(const Surface& surface, const FeatureLines& lines, std::size_t count,
            RemeshSites& sites, Dual& dual, const Context* context = nullptr);

}  // namespace dapple
