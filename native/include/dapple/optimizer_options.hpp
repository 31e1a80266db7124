// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/option.hpp>
#include <limits>
#include <tuple>

namespace dapple {

/// How a step is found.
enum class Method {
  kTrustRegion,  ///< L-BFGS preconditioned by the Gauss-Newton Hessian of the capacities, within a
                 ///< trust region
  kLineSearch,   ///< plain L-BFGS, as in the paper
};

constexpr std::array<Choice<Method>, 2> choices_of(Method) {
  return {{{"trust_region", Method::kTrustRegion}, {"line_search", Method::kLineSearch}}};
}

struct OptimizerOptions {
  Method method = Method::kTrustRegion;
  double capacity_weight = 30.0;
  double repulsion_weight = 3.0;
  double repulsion_radius = 0.72;
  double tolerance = 5e-5;
  int patience = 2;
  int max_evaluations = 200;
  int history = 7;
  double max_step = 0.5;
  double max_slide = kInfinite;
  double stickiness = 0.0;
  double target_energy = -kInfinite;
};

inline constexpr std::tuple kOptimizerOptions = {
    Option{"capacity_weight",
           &OptimizerOptions::capacity_weight,
           {},
           "",
           Level::kBasic,
           "Lambda, the weight of equal capacities: more of it is less like a lattice; 20 to 100 "
           "are useful."},
    Option{"repulsion_weight",
           &OptimizerOptions::repulsion_weight,
           {},
           "",
           Level::kBasic,
           "Kappa, the weight of the repulsion that keeps neighbors apart; 0 is the paper's plain "
           "energy."},
    Option{"repulsion_radius",
           &OptimizerOptions::repulsion_radius,
           {},
           "local spacings",
           Level::kInternal,
           "Distance below which sites repel each other."},
    Option{"tolerance",
           &OptimizerOptions::tolerance,
           {},
           "",
           Level::kBasic,
           "Relative decrease of the energy at which to stop: less is more regular, and slower."},
    Option{"patience",
           &OptimizerOptions::patience,
           {1.0},
           "",
           Level::kInternal,
           "Steps in a row that decrease the energy by no more than the tolerance before it stops: "
           "one small step alone is no convergence."},
    Option{"max_evaluations",
           &OptimizerOptions::max_evaluations,
           {1.0},
           "",
           Level::kBasic,
           "Most evaluations of the energy; of a motion for each frame, or part of one."},
    Option{"history",
           &OptimizerOptions::history,
           {},
           "",
           Level::kInternal,
           "Steps that L-BFGS remembers."},
    Option{"max_step",
           &OptimizerOptions::max_step,
           {},
           "local spacings",
           Level::kInternal,
           "Longest move of a site in one step."},
    // Farther than the local spacing of the surface none goes either.
    Option{"max_slide",
           &OptimizerOptions::max_slide,
           {0.0, kInfinite},
           "local spacings",
           Level::kExpert,
           "Farthest that a sample may slide from its start, which is where the surface carries it "
           "in a frame: after a violent frame evenness is caught up over the next ones."},
    // sum m_k |x_k - start_k|^2, where m_k is the cell's integral of phi^2 at the start
    Option{
        "stickiness",
        &OptimizerOptions::stickiness,
        {},
        "",
        Level::kBasic,
        "Gamma, the weight of staying at the start, which is where the surface carries a sample: "
        "more of it, less slide and less even; 1 is the weight of E_cvt."},
    Option{"target_energy",
           &OptimizerOptions::target_energy,
           {-kInfinite, kInfinite},
           "",
           Level::kInternal,
           "Stop once the normalized energy is not above it."},
    Option{"method",
           &OptimizerOptions::method,
           {},
           "",
           Level::kExpert,
           "How a step is found: within a trust region, or by plain L-BFGS with a line search, as "
           "in the paper."}};

constexpr const auto& options_of(const OptimizerOptions&) { return kOptimizerOptions; }

}  // namespace dapple
