// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>

namespace dapple {

/// Triangles as they stand in a file.
struct MeshArrays {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

}  // namespace dapple
