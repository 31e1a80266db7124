// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/moments.hpp>

#include "base/triple.hpp"

namespace dapple {

/// Sums of moments.
struct Integrals {
  double area = 0.0, capacity = 0.0, mass = 0.0, second = 0.0;
  Triple first = {0.0, 0.0, 0.0};
};

/// Add the integrals of a triangle (a, b, c relative to the reference point) with density 1, in
/// closed form.
inline void add_uniform_triangle(Integrals& sum, double area, const Triple& a, const Triple& b,
                                 const Triple& c) {
  sum.area += area;
  sum.first = sum.first + (area / 3.0) * (a + b + c);
  sum.second += (area / 6.0) * (a.dot(a) + b.dot(b) + c.dot(c) + a.dot(b) + b.dot(c) + c.dot(a));
}

/// With density 1 the capacity and the mass are the area.
inline void finish_uniform(Integrals& sum) { sum.capacity = sum.mass = sum.area; }

/// Add the integrals of a triangle whose density is linear, with the values fa, fb, fc at its
/// corners. The highest integrand, phi^2 |x|^2, has degree 4, for which the six-point rule is exact
/// (Dunavant 1985).
inline void add_linear_triangle(Integrals& sum, double area, const Triple& a, const Triple& b,
                                const Triple& c, double fa, double fb, double fc) {
  constexpr double kNear[2] = {0.44594849091596488632, 0.09157621350977074346};
  constexpr double kWeight[2] = {0.22338158967801146570, 0.10995174365532186764};
  sum.area += area;
  sum.capacity += area / 3.0 * (fa + fb + fc);
  for (int k = 0; k < 2; ++k) {
    const double u = kNear[k];
    const double v = 1.0 - 2.0 * u;
    const auto add = [&](double wa, double wb, double wc) {
      const double f = wa * fa + wb * fb + wc * fc;
      const Triple x = wa * a + wb * b + wc * c;
      const double w = kWeight[k] * area * f * f;
      sum.mass += w;
      sum.first = sum.first + w * x;
      sum.second += w * x.squared_norm();
    };
    add(v, u, u);
    add(u, v, u);
    add(u, u, v);
  }
}

inline void add_to(Vec3& sum, const Triple& part) { part.add_to(sum); }
inline void add_to(Triple& sum, const Triple& part) { sum = sum + part; }

/// Add a region's integrals, known relative to the same point.
/// \param sum Moments or Integrals
template <typename Sum>
void add_integrals(Sum& sum, const Integrals& part) {
  sum.area += part.area;
  sum.capacity += part.capacity;
  sum.mass += part.mass;
  add_to(sum.first, part.first);
  sum.second += part.second;
}

/// Add a region's integrals, known relative to a point at `offset` from the reference point.
/// \param sum, part Moments or Integrals
template <typename Sum, typename Part>
void add_shifted(Sum& sum, const Part& part, const Triple& offset) {
  const Triple first(part.first);
  sum.area += part.area;
  sum.capacity += part.capacity;
  sum.mass += part.mass;
  add_to(sum.first, first + part.mass * offset);
  sum.second += part.second + 2.0 * offset.dot(first) + part.mass * offset.squared_norm();
}

}  // namespace dapple
