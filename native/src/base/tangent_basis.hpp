// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/types.hpp>

namespace dapple {

/// Two unit vectors that span the plane of `normal` (Duff et al. 2017, without the branch on the
/// sign of zero).
inline Eigen::Matrix<double, 3, 2> tangent_basis(const Vec3& normal) {
  const double sign = normal.z() < 0.0 ? -1.0 : 1.0;
  const double a = -1.0 / (sign + normal.z());
  const double b = normal.x() * normal.y() * a;
  Eigen::Matrix<double, 3, 2> basis;
  basis << 1.0 + sign * normal.x() * normal.x() * a, b, sign * b,
      sign + normal.y() * normal.y() * a, -sign * normal.x(), -normal.y();
  return basis;
}

}  // namespace dapple
