// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/optimizer.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/samples.hpp>
#include <dapple/surface.hpp>
#include <optional>

namespace dapple {

/// Initial positions of an optimization.
enum class Start {
  kPoisson,  ///< a Poisson-disk set, which needs fewer iterations than white noise; for a capacity
             ///< weight below 10, which asks for a lattice, of few sites, which are then subdivided
  kRandom,   ///< white noise, as in the paper
};

struct SampleOptions {
  /// Random seed. Quality does not depend on it.
  std::uint64_t seed = 0;           // basic, >= 0
  OptimizerOptions optimizer = {};  // options
  /// Initial positions: a Poisson-disk set, or white noise as in the paper.
  Start start = Start::kPoisson;  // expert
  /// Owner of a part of the surface: the nearest site that it is connected to along the surface, or
  /// the nearest site in space as in the paper.
  Cells cells = Cells::kConnected;  // expert
  /// Number of threads; 0 uses all processors. The result has the same bytes for any number.
  int threads = 0;  // expert, 0..kMostThreads, same result
  /// Sites that do not move but take part, with barycentric coordinates; they come first, and the
  /// count includes them.
  Sites locked = {};
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const SampleOptions& options);

/// The settings of the paper: white noise, plain L-BFGS, no repulsion, Euclidean cells.
[[nodiscard]] SampleOptions paper_options();

/// Exactly `count` samples of a surface, evenly spaced and unpatterned, following its density.
/// \throw ArgumentError for options out of range; Cancelled
[[nodiscard]] Samples sample(const Surface& surface, std::size_t count,
                             const SampleOptions& options = {}, Context* context = nullptr);

/// One class of samples.
struct SampleClass {
  std::size_t count = 0;  ///< locked ones included
  /// On a surface: the same surface with the density of the class, from Surface::with_density().
  /// None: the surface's own density.
  std::optional<Surface> surface = {};
  /// In a flat domain: the density of the class. None: the domain's own.
  std::optional<Image> image = {};
  /// Radius of its discs, >= 0. Two samples are kept apart by the sum of their radii; samples of
  /// radius 0 stay outside the discs of others, and may be close to each other.
  double radius = 0.0;
  Sites locked = {};  ///< as SampleOptions::locked
};

struct ClassOptions {
  /// Mu, the weight of the evenness of all classes together, relative to that of each class.
  double union_weight = 1.0;  // expert, >= 0
  /// Optimize every class alone first, then all together, as in the paper.
  bool two_stages = false;  // expert
  // The terms of the classes and of their union compete, which takes a stronger repulsion and more
  // steps than one class.
  SampleOptions sample = {.optimizer = {.repulsion_weight = 5.0, .tolerance = 1e-5}};  // options
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const ClassOptions& options);

/// The settings of the paper (Algorithm 3): two stages, each as paper_options().
[[nodiscard]] ClassOptions paper_class_options();

/// Samples of several classes at once, with exact counts, each class even by itself and all
/// together: minimizes mu N E*(union) + sum over the classes of E*(class), where E* = n E /
/// |S|_phi^2 of each set's own number and density, N is the number of classes that are not empty,
/// and the density of the union is sum_c n_c phi_c / |S|_phi_c (paper, section 4.3, extended to
/// classes of different densities).
///
/// Samples come class by class; `Samples::classes` holds the class of each. Where classes have
/// radii, the report names the pair that overlaps most.
/// \throw ArgumentError naming an option or radius out of range, a surface of other faces, or radii
///        whose discs exceed the densest packing; Cancelled
[[nodiscard]] Samples sample_classes(const Surface& surface, std::span<const SampleClass> classes,
                                     const ClassOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
