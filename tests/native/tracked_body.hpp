// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/tracker.hpp>
#include <vector>

#include "shapes.hpp"

namespace dapple::test {

constexpr std::size_t kCount = 400;  ///< of samples

/// A body whose density is uneven.
[[nodiscard]] Shape body();

/// A tracker of samples that are even on a shape.
[[nodiscard]] Tracker tracker_of(const Shape& shape, std::size_t count = kCount,
                                 TrackerOptions options = {});

/// Compare everything except times.
void expect_untouched(const Tracker& tracker, const Samples& before,
                      const std::vector<Vec3>& vertices);

/// The vertices of a body whose middle is stretched to three times its length and back.
[[nodiscard]] std::vector<Vec3> pull(const Shape& shape, int frame, int period);

}  // namespace dapple::test
