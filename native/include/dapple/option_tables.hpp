// SPDX-License-Identifier: GPL-3.0-or-later
// Made by scripts/option_headers.py from the options structs: change those.

#pragma once

#include <dapple/mosaic.hpp>
#include <dapple/optimizer.hpp>
#include <dapple/option.hpp>
#include <dapple/population.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/relax.hpp>
#include <dapple/resample.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <dapple/stipple.hpp>
#include <dapple/tracker.hpp>
#include <dapple/window_tracker.hpp>

namespace dapple {

constexpr std::array<Choice<Method>, 2> choices_of(Method) {
  return {{{"trust_region", Method::kTrustRegion}, {"line_search", Method::kLineSearch}}};
}

constexpr std::array<Choice<Cells>, 2> choices_of(Cells) {
  return {{{"connected", Cells::kConnected}, {"euclidean", Cells::kEuclidean}}};
}

constexpr std::array<Choice<Start>, 2> choices_of(Start) {
  return {{{"poisson", Start::kPoisson}, {"random", Start::kRandom}}};
}

inline constexpr std::tuple kMosaicOptions = {
    Option{"grout",
           &MosaicOptions::grout,
           {0, kFinite},
           "units of the surface",
           Level::kExpert,
           "Width of the gap between neighboring tiles, measured in space across the plane "
           "half-way between their sites; there is none where the surface ends."},
    Option{"thickness",
           &MosaicOptions::thickness,
           {0, kFinite},
           "units of the surface",
           Level::kExpert,
           "How far tiles rise along their normals, as closed bodies; 0: they lie in the surface."},
    Option{"shortest_edge",
           &MosaicOptions::shortest_edge,
           {0, kFinite},
           "spacings",
           Level::kExpert,
           "Edges of a tile that are shorter are removed."},
    Option{"merge",
           &MosaicOptions::merge,
           {},
           "",
           Level::kExpert,
           "Polygons of a tile in one plane become one."},
    Option{"cells",
           &MosaicOptions::cells,
           {},
           "",
           Level::kExpert,
           "Which site a part of the surface belongs to: one that it is connected to along the "
           "surface, or the nearest in space, as in the paper."},
    Option{"threads",
           &MosaicOptions::threads,
           {0, kMostThreads},
           "",
           Level::kExpert,
           "How many work at once; 0 is as many as the machine has, and the result is the same "
           "bytes for any number.",
           false}};

constexpr const auto& options_of(const MosaicOptions&) { return kMosaicOptions; }

inline constexpr std::tuple kOptimizerOptions = {
    Option{"capacity_weight",
           &OptimizerOptions::capacity_weight,
           {0, kFinite},
           "",
           Level::kBasic,
           "Lambda, the weight of equal capacities: more of it is less like a lattice; 20 to 100 "
           "are useful."},
    Option{"repulsion_weight",
           &OptimizerOptions::repulsion_weight,
           {0, kFinite},
           "",
           Level::kBasic,
           "Kappa, the weight of the repulsion that keeps neighbors apart; 0 is the paper's plain "
           "energy."},
    Option{"repulsion_radius",
           &OptimizerOptions::repulsion_radius,
           {0, kFinite},
           "local spacings",
           Level::kInternal,
           "Distance below which sites repel each other."},
    Option{"tolerance",
           &OptimizerOptions::tolerance,
           {0, kFinite},
           "",
           Level::kBasic,
           "Relative decrease of the energy at which to stop: less is more regular, and slower."},
    Option{"patience",
           &OptimizerOptions::patience,
           {1, kFinite},
           "",
           Level::kInternal,
           "Steps in a row that decrease the energy by no more than the tolerance before it stops: "
           "one small step alone is no convergence."},
    Option{"max_evaluations",
           &OptimizerOptions::max_evaluations,
           {1, kFinite},
           "",
           Level::kBasic,
           "Most evaluations of the energy; of a motion for each frame, or part of one."},
    Option{"history",
           &OptimizerOptions::history,
           {0, kFinite},
           "",
           Level::kInternal,
           "Steps that L-BFGS remembers."},
    Option{"max_step",
           &OptimizerOptions::max_step,
           {0, kFinite},
           "local spacings",
           Level::kInternal,
           "Longest move of a site in one step."},
    Option{"max_slide",
           &OptimizerOptions::max_slide,
           {0, kInfinite},
           "local spacings",
           Level::kExpert,
           "Farthest that a sample may slide from its start, which is where the surface carries it "
           "in a frame: after a violent frame evenness is caught up over the next ones."},
    Option{"stickiness",
           &OptimizerOptions::stickiness,
           {0, kFinite},
           "",
           Level::kBasic,
           "Gamma, the weight of staying at the start, which is where the surface carries a "
           "sample: more of it, less slide and less even; 1 is the weight of E_cvt."},
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

inline constexpr std::tuple kTrackerOptions = {
    Option{"union_weight",
           &TrackerOptions::union_weight,
           {0, kFinite},
           "",
           Level::kExpert,
           "Mu, the weight of the evenness of all classes together against that of each."},
    Group{&TrackerOptions::optimizer},
    Option{"pattern_strength",
           &TrackerOptions::pattern_strength,
           {0, 1},
           "",
           Level::kExpert,
           "How strongly samples return to the first frame's pattern where a deformation has gone; "
           "0 lets it drift."},
    Option{"longest_motion",
           &TrackerOptions::longest_motion,
           {0, kFinite},
           "sizes of the surface",
           Level::kExpert,
           "Farthest that the surface's shape may move at once, apart from moving as a whole, "
           "scaling and mirroring: a frame on which it moves farther is split; 0 never splits."},
    Option{"cells",
           &TrackerOptions::cells,
           {},
           "",
           Level::kExpert,
           "Which site a part of the surface belongs to: one that it is connected to along the "
           "surface, or the nearest in space, as in the paper."},
    Option{"threads",
           &TrackerOptions::threads,
           {0, kMostThreads},
           "",
           Level::kExpert,
           "How many work at once; 0 is as many as the machine has, and the result is the same "
           "bytes for any number.",
           false}};

constexpr const auto& options_of(const TrackerOptions&) { return kTrackerOptions; }

inline constexpr std::tuple kPopulationOptions = {
    Option{"fade",
           &PopulationOptions::fade,
           {1, kFinite},
           "frames",
           Level::kExpert,
           "How long a sample takes to appear or to vanish."},
    Option{"reach",
           &PopulationOptions::reach,
           {0, kFinite},
           "local spacings",
           Level::kExpert,
           "How far from a sample its surface may be in a frame of other faces, unless that part "
           "of it moves farther as a whole; a sample without a surface vanishes."},
    Group{&PopulationOptions::tracker}};

constexpr const auto& options_of(const PopulationOptions&) { return kPopulationOptions; }

inline constexpr std::tuple kImageOptions = {
    Option{"repeat",
           &ImageOptions::repeat,
           {},
           "",
           Level::kExpert,
           "The picture goes on periodically; otherwise its border does."},
    Option{"max_error",
           &ImageOptions::max_error,
           {0, kFinite, true},
           "",
           Level::kExpert,
           "How far the density may be off at a point, relative to the picture's maximum, and "
           "twice how far the capacity of a face may be off, relative to itself."},
    Option{"texels",
           &ImageOptions::texels,
           {0, kFinite, true},
           "pixels",
           Level::kExpert,
           "Edges this short or shorter stay whole."},
    Option{"shortest",
           &ImageOptions::shortest,
           {0, kFinite},
           "",
           Level::kExpert,
           "The same on the surface, in the units of its vertices: detail far finer than the "
           "spacing of samples costs time and changes nothing."},
    Option{"max_faces",
           &ImageOptions::max_faces,
           {1, kMostRefinedFaces},
           "",
           Level::kExpert,
           "Most faces; what would take more stays coarser, and resolved is False."}};

constexpr const auto& options_of(const ImageOptions&) { return kImageOptions; }

inline constexpr std::tuple kRelaxOptions = {
    Option{"seed",
           &RelaxOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Of the random start: another number, another set just as even."},
    Option{"union_weight",
           &RelaxOptions::union_weight,
           {0, kFinite},
           "",
           Level::kExpert,
           "Mu, the weight of the evenness of all classes together against that of each."},
    Option{"free_counts",
           &RelaxOptions::free_counts,
           {},
           "",
           Level::kExpert,
           "Classes get as many samples as fit those around, not as many as they count."},
    Group{&RelaxOptions::optimizer},
    Option{"threads",
           &RelaxOptions::threads,
           {0, kMostThreads},
           "",
           Level::kExpert,
           "How many work at once; 0 is as many as the machine has, and the result is the same "
           "bytes for any number.",
           false}};

constexpr const auto& options_of(const RelaxOptions&) { return kRelaxOptions; }

inline constexpr std::tuple kResampleOptions = {
    Option{"seed",
           &ResampleOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Of the random start: another number, another set just as even."},
    Group{&ResampleOptions::optimizer},
    Option{"cells",
           &ResampleOptions::cells,
           {},
           "",
           Level::kExpert,
           "Which site a part of the surface belongs to: one that it is connected to along the "
           "surface, or the nearest in space, as in the paper."},
    Option{"threads",
           &ResampleOptions::threads,
           {0, kMostThreads},
           "",
           Level::kExpert,
           "How many work at once; 0 is as many as the machine has, and the result is the same "
           "bytes for any number.",
           false}};

constexpr const auto& options_of(const ResampleOptions&) { return kResampleOptions; }

inline constexpr std::tuple kSampleOptions = {
    Option{"seed",
           &SampleOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Of the random start: another number, another set just as even."},
    Group{&SampleOptions::optimizer},
    Option{"start",
           &SampleOptions::start,
           {},
           "",
           Level::kExpert,
           "Where the optimization begins: with a Poisson-disk set, or with white noise, as in the "
           "paper."},
    Option{"cells",
           &SampleOptions::cells,
           {},
           "",
           Level::kExpert,
           "Which site a part of the surface belongs to: one that it is connected to along the "
           "surface, or the nearest in space, as in the paper."},
    Option{"threads",
           &SampleOptions::threads,
           {0, kMostThreads},
           "",
           Level::kExpert,
           "How many work at once; 0 is as many as the machine has, and the result is the same "
           "bytes for any number.",
           false}};

constexpr const auto& options_of(const SampleOptions&) { return kSampleOptions; }

inline constexpr std::tuple kClassOptions = {
    Option{"union_weight",
           &ClassOptions::union_weight,
           {0, kFinite},
           "",
           Level::kExpert,
           "Mu, the weight of the evenness of all classes together against that of each."},
    Option{"two_stages",
           &ClassOptions::two_stages,
           {},
           "",
           Level::kExpert,
           "Every class alone first, then all together, as in the paper."},
    Group{&ClassOptions::sample}};

constexpr const auto& options_of(const ClassOptions&) { return kClassOptions; }

inline constexpr std::tuple kStippleOptions = {
    Option{"radius",
           &StippleOptions::radius,
           {0, kFinite},
           "pixels",
           Level::kExpert,
           "Of every dot; 0 is where all dots together have the area of the ink that the picture "
           "asks for."},
    Option{"seed",
           &StippleOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Of the random start: another number, another set just as even."},
    Option{"union_weight",
           &StippleOptions::union_weight,
           {0, kFinite},
           "",
           Level::kExpert,
           "Mu, the weight of the evenness of all classes together against that of each."},
    Group{&StippleOptions::optimizer},
    Option{"threads",
           &StippleOptions::threads,
           {0, kMostThreads},
           "",
           Level::kExpert,
           "How many work at once; 0 is as many as the machine has, and the result is the same "
           "bytes for any number.",
           false}};

constexpr const auto& options_of(const StippleOptions&) { return kStippleOptions; }

inline constexpr std::tuple kWindowOptions = {
    Option{"closed",
           &WindowOptions::closed,
           {},
           "",
           Level::kExpert,
           "The last frame leads back to the first: the loop closes."},
    Option{"sweeps",
           &WindowOptions::sweeps,
           {0, kFinite},
           "",
           Level::kExpert,
           "Passes forwards and backwards over all frames, after the first."},
    Group{&WindowOptions::tracker}};

constexpr const auto& options_of(const WindowOptions&) { return kWindowOptions; }

}  // namespace dapple
