// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/sample_options.hpp>
#include <dapple/samples.hpp>

namespace dapple {

/// Exactly `count` samples of a surface, evenly spaced and unpatterned, following its density.
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] Samples sample(const Surface& surface, std::size_t count,
                             const SampleOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
