// SPDX-License-Identifier: GPL-3.0-or-later
// Made by scripts/option_headers.py from the options structs: change those.

#pragma once

#include <dapple/line_samples.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/optimizer.hpp>
#include <dapple/option.hpp>
#include <dapple/population.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/relax.hpp>
#include <dapple/remesh.hpp>
#include <dapple/resample.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <dapple/stipple.hpp>
#include <dapple/symmetric_samples.hpp>
#include <dapple/tracker.hpp>
#include <dapple/window_tracker.hpp>

namespace dapple {

constexpr std::array<Choice<LineSpacing>, 2> choices_of(LineSpacing) {
  return {{{"even", LineSpacing::kEven}, {"natural", LineSpacing::kNatural}}};
}

constexpr std::array<Choice<Method>, 2> choices_of(Method) {
  return {{{"trust_region", Method::kTrustRegion}, {"line_search", Method::kLineSearch}}};
}

constexpr std::array<Choice<NonManifold>, 2> choices_of(NonManifold) {
  return {{{"kept", NonManifold::kKept}, {"cut", NonManifold::kCut}}};
}

constexpr std::array<Choice<Cells>, 2> choices_of(Cells) {
  return {{{"connected", Cells::kConnected}, {"euclidean", Cells::kEuclidean}}};
}

constexpr std::array<Choice<Start>, 2> choices_of(Start) {
  return {{{"poisson", Start::kPoisson}, {"random", Start::kRandom}}};
}

inline constexpr std::tuple kLineOptions = {
    Option{"seed",
           &LineOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Random seed. Quality does not depend on it."},
    Option{"feature_angle",
           &LineOptions::feature_angle,
           {0, 180},
           "degrees",
           Level::kBasic,
           "Edges whose faces' normals differ by more than this are creases, which stay, and so do "
           "their corners; 180 keeps none."},
    Option{"line_spacing",
           &LineOptions::line_spacing,
           {},
           "",
           Level::kExpert,
           "Samples follow each other at equal distances, or at distances from a half to one and a "
           "half of that."},
    Option{"borders",
           &LineOptions::borders,
           {},
           "",
           Level::kExpert,
           "Whether borders are lines, and edges with three or more faces."},
    Option{"corners",
           &LineOptions::corners,
           {},
           "",
           Level::kExpert,
           "Whether there is a sample at each corner: where lines end, meet or turn by more than "
           "45 degrees. Otherwise lines begin and end with half a distance."}};

constexpr const auto& options_of(const LineOptions&) { return kLineOptions; }

inline constexpr std::tuple kMosaicOptions = {
    Option{"grout",
           &MosaicOptions::grout,
           {0, kFinite},
           "units of the surface",
           Level::kExpert,
           "Width of the gap between neighboring tiles, measured across the bisector of their "
           "sites; there is no gap at borders of the surface."},
    Option{"thickness",
           &MosaicOptions::thickness,
           {0, kFinite},
           "units of the surface",
           Level::kExpert,
           "Thickness of tiles along their normals, as closed bodies; 0 leaves them flat in the "
           "surface."},
    Option{"shortest_edge",
           &MosaicOptions::shortest_edge,
           {0, kFinite},
           "spacings",
           Level::kExpert,
           "Shorter edges of a tile are removed."},
    Option{"merge",
           &MosaicOptions::merge,
           {},
           "",
           Level::kExpert,
           "Merge the polygons of a tile that lie in one plane."},
    Option{"cells",
           &MosaicOptions::cells,
           {},
           "",
           Level::kExpert,
           "Owner of a part of the surface: the nearest site that it is connected to along the "
           "surface, or the nearest site in space as in the paper."},
    Option{
        "threads",
        &MosaicOptions::threads,
        {0, kMostThreads},
        "",
        Level::kExpert,
        "Number of threads; 0 uses all processors. The result has the same bytes for any number.",
        false}};

constexpr const auto& options_of(const MosaicOptions&) { return kMosaicOptions; }

inline constexpr std::tuple kOptimizerOptions = {
    Option{"capacity_weight",
           &OptimizerOptions::capacity_weight,
           {0, kFinite},
           "",
           Level::kBasic,
           "Lambda, the weight of equal capacities: larger values look less like a lattice. 20 to "
           "100 are useful for samples, less than 1 for the vertices of meshes."},
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
           "Relative decrease of the energy at which to stop: smaller values are more regular and "
           "slower."},
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
           "Maximum number of evaluations of the energy; for motions, in each frame or part of a "
           "frame."},
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
    Option{
        "max_slide",
        &OptimizerOptions::max_slide,
        {0, kInfinite},
        "local spacings",
        Level::kExpert,
        "Largest distance that a sample may slide from the position to which the surface carries "
        "it in a frame; after a violent frame, evenness is restored over the next ones."},
    Option{"stickiness",
           &OptimizerOptions::stickiness,
           {0, kFinite},
           "",
           Level::kBasic,
           "Gamma, the weight that holds a sample where the surface carries it: larger values "
           "slide less and are less even; 1 is the weight of E_cvt."},
    Option{"slide_smoothing",
           &OptimizerOptions::slide_smoothing,
           {0, kFinite},
           "",
           Level::kExpert,
           "Sigma, the weight that lets neighbors slide alike: larger values are calmer from frame "
           "to frame and less even; 1 is the weight of E_cvt."},
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
           "Method of finding a step: a trust region, or plain L-BFGS with a line search as in the "
           "paper."}};

constexpr const auto& options_of(const OptimizerOptions&) { return kOptimizerOptions; }

inline constexpr std::tuple kTrackerOptions = {
    Option{
        "union_weight",
        &TrackerOptions::union_weight,
        {0, kFinite},
        "",
        Level::kExpert,
        "Mu, the weight of the evenness of all classes together, relative to that of each class."},
    Group{&TrackerOptions::optimizer},
    Option{"pattern_strength",
           &TrackerOptions::pattern_strength,
           {0, 1},
           "",
           Level::kExpert,
           "How strongly samples return to the pattern of the first frame after a deformation; 0 "
           "lets it drift."},
    Option{"longest_motion",
           &TrackerOptions::longest_motion,
           {0, kFinite},
           "sizes of the surface",
           Level::kExpert,
           "Largest motion of the surface's shape in one step, not counting rigid motion, scaling "
           "and mirroring: frames with larger motion are split; 0 never splits."},
    Option{"cells",
           &TrackerOptions::cells,
           {},
           "",
           Level::kExpert,
           "Owner of a part of the surface: the nearest site that it is connected to along the "
           "surface, or the nearest site in space as in the paper."},
    Option{
        "threads",
        &TrackerOptions::threads,
        {0, kMostThreads},
        "",
        Level::kExpert,
        "Number of threads; 0 uses all processors. The result has the same bytes for any number.",
        false}};

constexpr const auto& options_of(const TrackerOptions&) { return kTrackerOptions; }

inline constexpr std::tuple kPopulationOptions = {
    Option{"fade",
           &PopulationOptions::fade,
           {1, kFinite},
           "frames",
           Level::kExpert,
           "Duration in which a sample appears or vanishes."},
    Option{"reach",
           &PopulationOptions::reach,
           {0, kFinite},
           "local spacings",
           Level::kExpert,
           "Largest distance from a sample to its surface in a frame with other faces, unless that "
           "part of the surface moves farther as a whole; a sample without a surface vanishes."},
    Group{&PopulationOptions::tracker}};

constexpr const auto& options_of(const PopulationOptions&) { return kPopulationOptions; }

inline constexpr std::tuple kImageOptions = {
    Option{"repeat",
           &ImageOptions::repeat,
           {},
           "",
           Level::kExpert,
           "Repeat the picture periodically; otherwise its border pixels continue."},
    Option{"max_error",
           &ImageOptions::max_error,
           {0, kFinite, true},
           "",
           Level::kExpert,
           "Largest error of the density at a point, relative to the picture's maximum; the "
           "relative error of a face's capacity is at most half of it."},
    Option{"texels",
           &ImageOptions::texels,
           {0, kFinite, true},
           "pixels",
           Level::kExpert,
           "Edges of this length or shorter are not cut."},
    Option{"shortest",
           &ImageOptions::shortest,
           {0, kFinite},
           "units of the surface",
           Level::kExpert,
           "Edges of this length or shorter on the surface are not cut: detail far finer than the "
           "spacing of samples costs time without effect."},
    Option{"max_faces",
           &ImageOptions::max_faces,
           {1, kMostRefinedFaces},
           "",
           Level::kExpert,
           "Maximum number of faces; beyond it the rest stays coarser, and resolved is False."}};

constexpr const auto& options_of(const ImageOptions&) { return kImageOptions; }

inline constexpr std::tuple kRelaxOptions = {
    Option{"seed",
           &RelaxOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Random seed. Quality does not depend on it."},
    Option{
        "union_weight",
        &RelaxOptions::union_weight,
        {0, kFinite},
        "",
        Level::kExpert,
        "Mu, the weight of the evenness of all classes together, relative to that of each class."},
    Option{"free_counts",
           &RelaxOptions::free_counts,
           {},
           "",
           Level::kExpert,
           "Counts of classes are free: new samples match their neighbors' capacity."},
    Group{&RelaxOptions::optimizer},
    Option{
        "threads",
        &RelaxOptions::threads,
        {0, kMostThreads},
        "",
        Level::kExpert,
        "Number of threads; 0 uses all processors. The result has the same bytes for any number.",
        false}};

constexpr const auto& options_of(const RelaxOptions&) { return kRelaxOptions; }

inline constexpr std::tuple kRemeshOptions = {
    Option{"seed",
           &RemeshOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Random seed. Quality does not depend on it."},
    Option{"feature_angle",
           &RemeshOptions::feature_angle,
           {0, 180},
           "degrees",
           Level::kBasic,
           "Edges whose faces' normals differ by more than this are creases, which stay, and so do "
           "their corners; 180 keeps none."},
    Option{"max_distance",
           &RemeshOptions::max_distance,
           {0, kFinite},
           "",
           Level::kBasic,
           "Largest distance of the new mesh from the surface, and of the surface from it: "
           "vertices are added until no vertex and no middle of an edge or face is farther away. 0 "
           "sets no limit."},
    Option{"adaptive",
           &RemeshOptions::adaptive,
           {},
           "",
           Level::kBasic,
           "Vertices are closer together where the mesh would be far from the surface: about half "
           "of the largest distance with as many vertices. It takes about five times as long."},
    Option{
        "non_manifold",
        &RemeshOptions::non_manifold,
        {},
        "",
        Level::kExpert,
        "Edges with three or more faces stay as they are, or the faces around them are cut apart."},
    Group{&RemeshOptions::optimizer},
    Option{"cells",
           &RemeshOptions::cells,
           {},
           "",
           Level::kExpert,
           "Owner of a part of the surface: the nearest site that it is connected to along the "
           "surface, or the nearest site in space as in the paper."},
    Option{
        "threads",
        &RemeshOptions::threads,
        {0, kMostThreads},
        "",
        Level::kExpert,
        "Number of threads; 0 uses all processors. The result has the same bytes for any number.",
        false}};

constexpr const auto& options_of(const RemeshOptions&) { return kRemeshOptions; }

inline constexpr std::tuple kResampleOptions = {
    Option{"seed",
           &ResampleOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Random seed. Quality does not depend on it."},
    Group{&ResampleOptions::optimizer},
    Option{"cells",
           &ResampleOptions::cells,
           {},
           "",
           Level::kExpert,
           "Owner of a part of the surface: the nearest site that it is connected to along the "
           "surface, or the nearest site in space as in the paper."},
    Option{
        "threads",
        &ResampleOptions::threads,
        {0, kMostThreads},
        "",
        Level::kExpert,
        "Number of threads; 0 uses all processors. The result has the same bytes for any number.",
        false}};

constexpr const auto& options_of(const ResampleOptions&) { return kResampleOptions; }

inline constexpr std::tuple kSampleOptions = {
    Option{"seed",
           &SampleOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Random seed. Quality does not depend on it."},
    Group{&SampleOptions::optimizer},
    Option{"start",
           &SampleOptions::start,
           {},
           "",
           Level::kExpert,
           "Initial positions: a Poisson-disk set, or white noise as in the paper."},
    Option{"cells",
           &SampleOptions::cells,
           {},
           "",
           Level::kExpert,
           "Owner of a part of the surface: the nearest site that it is connected to along the "
           "surface, or the nearest site in space as in the paper."},
    Option{
        "threads",
        &SampleOptions::threads,
        {0, kMostThreads},
        "",
        Level::kExpert,
        "Number of threads; 0 uses all processors. The result has the same bytes for any number.",
        false}};

constexpr const auto& options_of(const SampleOptions&) { return kSampleOptions; }

inline constexpr std::tuple kClassOptions = {
    Option{
        "union_weight",
        &ClassOptions::union_weight,
        {0, kFinite},
        "",
        Level::kExpert,
        "Mu, the weight of the evenness of all classes together, relative to that of each class."},
    Option{"two_stages",
           &ClassOptions::two_stages,
           {},
           "",
           Level::kExpert,
           "Optimize every class alone first, then all together, as in the paper."},
    Group{&ClassOptions::sample}};

constexpr const auto& options_of(const ClassOptions&) { return kClassOptions; }

inline constexpr std::tuple kStippleOptions = {
    Option{"radius",
           &StippleOptions::radius,
           {0, kFinite},
           "pixels",
           Level::kExpert,
           "Radius of every dot; with 0 all dots together have the area of ink in the picture."},
    Option{"seed",
           &StippleOptions::seed,
           {0, kFinite},
           "",
           Level::kBasic,
           "Random seed. Quality does not depend on it."},
    Option{
        "union_weight",
        &StippleOptions::union_weight,
        {0, kFinite},
        "",
        Level::kExpert,
        "Mu, the weight of the evenness of all classes together, relative to that of each class."},
    Group{&StippleOptions::optimizer},
    Option{
        "threads",
        &StippleOptions::threads,
        {0, kMostThreads},
        "",
        Level::kExpert,
        "Number of threads; 0 uses all processors. The result has the same bytes for any number.",
        false}};

constexpr const auto& options_of(const StippleOptions&) { return kStippleOptions; }

inline constexpr std::tuple kSymmetryOptions = {
    Group{&SymmetryOptions::sample},
    Option{"max_mirror_error",
           &SymmetryOptions::max_mirror_error,
           {0, kFinite},
           "",
           Level::kExpert,
           "Largest distance from the surface that the mirror image of a vertex may have, relative "
           "to the surface's size, the diagonal of its bounding box."}};

constexpr const auto& options_of(const SymmetryOptions&) { return kSymmetryOptions; }

inline constexpr std::tuple kWindowOptions = {
    Option{"closed",
           &WindowOptions::closed,
           {},
           "",
           Level::kExpert,
           "The last frame leads back to the first one, as a closed loop."},
    Option{"sweeps",
           &WindowOptions::sweeps,
           {0, kFinite},
           "",
           Level::kExpert,
           "Number of passes forward and backward over all frames, after the first one."},
    Group{&WindowOptions::tracker}};

constexpr const auto& options_of(const WindowOptions&) { return kWindowOptions; }

}  // namespace dapple
