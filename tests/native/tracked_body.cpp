// SPDX-License-Identifier: GPL-3.0-or-later
#include "tracked_body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <dapple/sampler.hpp>
#include <numbers>

#include "invariants.hpp"

namespace dapple::test {

Shape body() {
  return with_density(blob(4), [](const Vec3& p) { return 1.3 + 0.5 * p.z(); });
}

Tracker tracker_of(const Shape& shape, std::size_t count, TrackerOptions options) {
  const Surface surface = shape.surface();
  return Tracker(surface, sample(surface, count), options);
}

void expect_untouched(const Tracker& tracker, const Samples& before,
                      const std::vector<Vec3>& vertices) {
  EXPECT_TRUE(same_bytes(tracker.samples(), before));
  EXPECT_TRUE(same_bytes(tracker.surface().vertices(), vertices));
}

std::vector<Vec3> pull(const Shape& shape, int frame, int period) {
  const double share = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * frame / period);
  return mapped(shape,
                [share](const Vec3& p) {
                  return Vec3(p.x() + share * std::tanh(2.0 * p.x()), p.y(), p.z());
                })
      .vertices;
}

}  // namespace dapple::test
