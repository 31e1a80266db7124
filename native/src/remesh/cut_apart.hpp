// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/remesh.hpp>

namespace dapple {

/// Give each fan of triangles its own vertex, connected over edges with two triangles.
void cut_apart(RemeshResult& mesh);

}  // namespace dapple
