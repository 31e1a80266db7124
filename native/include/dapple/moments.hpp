// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>

namespace dapple {

/// Integrals over a region of the surface, relative to a reference point o; phi is the density.
/// Lengths are in the unit of the vertices; phi has no unit.
struct Moments {
  double area = 0.0;
  double capacity = 0.0;      ///< integral of phi
  double mass = 0.0;          ///< integral of phi^2
  Vec3 first = Vec3::Zero();  ///< integral of phi^2 (x - o)
  double second = 0.0;        ///< integral of phi^2 |x - o|^2
};

}  // namespace dapple
