// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shapes.hpp"

namespace dapple::test {

/// The surface on which a field is 0, from a lattice of `cells` cubes along each edge of the box
/// [-1, 1]^3. Each cube is divided into six tetrahedra; the outside is where the field is positive.
[[nodiscard]] Shape isosurface(const std::function<double(const Vec3&)>& field, int cells);

/// Two balls of radius 0.4 that merge when they are near each other: separate in frames 0 and 24,
/// one body in frame 12.
[[nodiscard]] Shape metaballs(int frame, int cells);

/// A bumpy ellipsoid, the same in each frame but with different triangles.
[[nodiscard]] Shape remeshed(int frame);

/// A waving cloth that tears along its middle, row by row, from frame 4 on.
[[nodiscard]] Shape torn_cloth(int frame, int cells);

}  // namespace dapple::test
