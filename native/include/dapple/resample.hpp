// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/sampler.hpp>

namespace dapple {

/// Another count or another density for samples that are there, most of which stay nearly where
/// they are. Each neighborhood first gets the number that its share of the density asks for:
/// samples are taken out far from each other, those with the smallest cells first, or put into the
/// widest gaps. Then all are made as even as they were (`samples.report.energy`; to the tolerance
/// if that is 0). Those that stay come first, in their order and with their ids; new ids follow the
/// largest. The report tells how far they slid, in spacings.
///
/// Locked samples stay where they are; new ones may come between them.
/// \param surface of the same faces; its density and vertices may be others
/// \param count   at least as many as are locked
/// \param options `start` and `locked` are not used
/// \param locked  indices of samples
/// \throw ArgumentError if the samples are not of the surface, for options out of range, naming the
///        first locked index out of range, or for a count below that of the locked ones; Cancelled
[[nodiscard]] Samples resample(const Surface& surface, const Samples& samples, std::size_t count,
                               const SampleOptions& options = {}, Context* context = nullptr,
                               std::span<const std::int32_t> locked = {});

}  // namespace dapple
