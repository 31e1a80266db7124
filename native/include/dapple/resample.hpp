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
/// \param surface of the same faces; its density and vertices may be others
/// \param options `start` and `locked` are not used
/// \throw ArgumentError if the samples are not of the surface, or for options out of range;
///        Cancelled
[[nodiscard]] Samples resample(const Surface& surface, const Samples& samples, std::size_t count,
                               const SampleOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
