// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/remesh.hpp>

#include "lines/feature_lines.hpp"

namespace dapple {

/// Write angles, valences and topology of the mesh into its report.
/// \param lines tell which faces of the surface are turned over in the mesh
void measure_mesh(const Surface& surface, const FeatureLines& lines, RemeshResult& mesh);

}  // namespace dapple
