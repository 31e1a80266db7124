// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/remesh.hpp>

namespace dapple {

/// Write angles, valences and topology of the mesh into its report.
void measure_mesh(const Surface& surface, RemeshResult& mesh);

}  // namespace dapple
