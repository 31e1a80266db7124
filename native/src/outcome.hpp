// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/optimizer.hpp>
#include <dapple/samples.hpp>

namespace dapple {

/// Turn what the optimiser found into samples with a report.
[[nodiscard]] Samples to_samples(const Surface& surface, OptimizerResult&& found,
                                 std::span<const std::int32_t> ids = {},
                                 std::span<const std::int32_t> classes = {});

}  // namespace dapple
