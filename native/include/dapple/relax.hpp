// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/sampler.hpp>
#include <dapple/samples.hpp>
#include <optional>
#include <vector>

namespace dapple {

struct RelaxOptions {
  /// Random seed. Quality does not depend on it.
  std::uint64_t seed = 0;  // basic, >= 0
  /// Mu, the weight of the evenness of all classes together, relative to that of each class.
  double union_weight = 1.0;  // expert, >= 0
  /// Counts of classes are free: new samples match their neighbors' capacity.
  bool free_counts = false;         // expert
  OptimizerOptions optimizer = {};  // options
  /// Number of threads; 0 uses all processors. The result has the same bytes for any number.
  int threads = 0;  // expert, 0..kMostThreads, same result
  /// Number of samples wanted; the difference is made up where something has changed, and
  /// everywhere if it is large. None: chosen so that new samples match their neighbors' capacity.
  std::optional<std::size_t> count = {};
  /// Indices of samples that do not move. New samples may appear between them.
  std::vector<std::int32_t> locked = {};
  /// The classes; `locked` says which samples stay. None: all samples are of one class.
  std::vector<SampleClass> classes = {};
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const RelaxOptions& options);

/// Optimize samples locally where something has changed: the density, some vertices, a blocked
/// area. Only samples whose cells overlap the changed faces, and two rings of neighbors around
/// them, may move, be removed or be joined by new ones; all others keep every byte. Where samples
/// at the border of that region end with too much or too little capacity, the region grows. Only
/// the cells of the region and of two rings around it are computed.
///
/// Samples where the density is 0 are moved or replaced as if something had changed there. With a
/// count, the region grows until the number of its samples changes by at most 1 %; if many samples
/// come or go, it grows to all of them.
///
/// Several classes are relaxed one after another, rare ones first: each is made even by itself and
/// together with classes that are as rare or rarer, its discs apart from theirs. More common
/// classes then make room where these have moved. A class within 10 % of its wanted number is left
/// alone.
///
/// Samples that stay come first, in their order and with their ids; new ids follow the largest. The
/// report measures the samples that were free to move and their neighbors; its count and spacing
/// are those of all samples, its slides those of the free ones that stay. With several classes it
/// measures each class by itself and not all together: the evenness, bond order and energy of the
/// whole are 0, and so are those of a class that was left alone.
/// \param samples of one class or of those in the options, on a surface of the same faces; where
///                vertices have moved, the samples move with their faces
/// \param changed the caller's indices of the changed faces, see changed_faces(). If there are
///                none, nothing moves unless the count differs; samples may then come and go
///                everywhere
/// \throw ArgumentError if the samples do not lie on the surface, or have a class that is not in
///        the options; naming the first face or locked index out of range; for options out of
///        range, a count below the number of locked samples, or a surface that has grown so much
///        that it would take more than kMostSamples; Cancelled
[[nodiscard]] Samples relax(const Surface& surface, const Samples& samples,
                            std::span<const std::int32_t> changed, const RelaxOptions& options = {},
                            Context* context = nullptr);

/// The faces whose corners or densities differ between two surfaces of the same faces, in
/// increasing order.
/// \throw ArgumentError unless one was made from the other by deformed() or with_density()
[[nodiscard]] std::vector<std::int32_t> changed_faces(const Surface& before, const Surface& after);

}  // namespace dapple
