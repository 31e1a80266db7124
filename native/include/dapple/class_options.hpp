// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/sample_options.hpp>
#include <dapple/surface.hpp>
#include <optional>

namespace dapple {

/// What one class of samples is to be.
struct SampleClass {
  std::size_t count = 0;  ///< locked ones included
  /// With the density of the class: Surface::with_density of the surface that is sampled. None: its
  /// own density.
  std::optional<Surface> surface = {};
  /// Of its discs, >= 0: pairs are kept apart by the sum of their radii. Samples of radius 0 stay
  /// outside the discs of others, and may be near each other.
  double radius = 0.0;
  Sites locked = {};  ///< as SampleOptions::locked
};

struct ClassOptions {
  // Classes and union pull at each other: it takes a stronger repulsion and more steps than one
  // class.
  SampleOptions sample = {.optimizer = {.repulsion_weight = 5.0, .tolerance = 1e-5}};
  double union_weight = 1.0;
  bool two_stages = false;
};

template <class Struct>
constexpr Option<Struct, double> union_weight_option(double Struct::*member) {
  return {"union_weight",
          member,
          {},
          "",
          Level::kExpert,
          "Mu, the weight of the evenness of all classes together against that of each."};
}

inline constexpr std::tuple kClassOptions = {
    union_weight_option(&ClassOptions::union_weight),
    Option{"two_stages",
           &ClassOptions::two_stages,
           {},
           "",
           Level::kExpert,
           "Every class alone first, then all together, as in the paper."},
    Group{&ClassOptions::sample}};

constexpr const auto& options_of(const ClassOptions&) { return kClassOptions; }

/// The paper's own way (Algorithm 3): two stages, and each as paper_options().
[[nodiscard]] ClassOptions paper_class_options();

}  // namespace dapple
