// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/refine.hpp>
#include <dapple/samples.hpp>

namespace dapple {

/// Samples of `refined.surface` as samples of `refined.original`; ids, classes, fades and the
/// report stay.
/// \throw ArgumentError naming the first face out of range
[[nodiscard]] Samples to_original(const Refined& refined, const Samples& samples);

/// Samples of `refined.original` as samples of `refined.surface`: each on the piece of its face
/// that it lies in.
/// \throw ArgumentError naming the first face out of range
[[nodiscard]] Samples from_original(const Refined& refined, const Samples& samples);

}  // namespace dapple
