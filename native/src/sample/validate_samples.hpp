// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/samples.hpp>
#include <string>

namespace dapple {

/// Samples whose positions are where their barycentric coordinates say, all arrays of one length.
/// \throw ArgumentError as check_bound_sites()
void check_samples(const Surface& surface, const Samples& samples,
                   const std::string& owner = "samples");

/// \throw ArgumentError unless all arrays have one length
void check_lengths(const Samples& samples, const std::string& owner = "samples");

}  // namespace dapple
