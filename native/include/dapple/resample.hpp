// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/sampler.hpp>

namespace dapple {

struct ResampleOptions {
  /// Random seed. Quality does not depend on it.
  std::uint64_t seed = 0;           // basic, >= 0
  OptimizerOptions optimizer = {};  // options
  /// Owner of a part of the surface: the nearest site that it is connected to along the surface, or
  /// the nearest site in space as in the paper.
  Cells cells = Cells::kConnected;  // expert
  /// Number of threads; 0 uses all processors. The result has the same bytes for any number.
  int threads = 0;  // expert, 0..kMostThreads, same result
  /// Indices of samples that do not move. New samples may appear between them.
  std::vector<std::int32_t> locked = {};
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const ResampleOptions& options);

/// Change the number or the density of existing samples, most of which stay close to where they
/// are. Each neighborhood first gets the number of samples that its share of the density asks for:
/// samples are removed far from each other, those with the smallest cells first, or inserted into
/// the widest gaps. All are then optimized until they are as even as before
/// (`samples.report.energy`; to the tolerance if that is 0). Samples that stay come first, in their
/// order and with their ids; new ids follow the largest. The report tells how far they slid, in
/// spacings.
/// \param surface of the same faces; its density and vertices may differ
/// \param samples of one class, which new ones get too; samples of several classes all become those
///                of class 0, since relax() is for them
/// \param count   at least as many as are locked
/// \throw ArgumentError if the samples do not lie on the surface, for options out of range, naming
///        the first locked index out of range, or for a count below the number of locked samples;
///        Cancelled
[[nodiscard]] Samples resample(const Surface& surface, const Samples& samples, std::size_t count,
                               const ResampleOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
