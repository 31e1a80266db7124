// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shapes.hpp"

namespace dapple::test {

/// Where a field is 0, on a lattice of so many cubes along each edge of the box [-1, 1]^3: each
/// cube in six tetrahedra, outside where the field is above 0.
[[nodiscard]] Shape isosurface(const std::function<double(const Vec3&)>& field, int cells);

/// Two balls of radius 0.4 that are drawn together where they are near; in frame 0 and 24 they are
/// apart, in frame 12 they are one body.
[[nodiscard]] Shape metaballs(int frame, int cells);

/// A bumpy ellipsoid, the same in each frame, of other triangles in each.
[[nodiscard]] Shape remeshed(int frame);

/// A waving cloth that tears from frame 4 on, row by row, along its middle.
[[nodiscard]] Shape torn_cloth(int frame, int cells);

}  // namespace dapple::test
