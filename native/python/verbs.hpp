// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <dapple/option_tables.hpp>
#include <dapple/resample.hpp>
#include <string_view>
#include <tuple>

namespace dapple::python {

/// A function of the package, or a class, whose options are those of a struct.
template <class Struct>
struct Verb {
  using Names = std::array<std::string_view, 5>;

  const char* name;
  Names without = {};  ///< options of the struct that it does not have
  Names only = {};     ///< if not empty, its only options

  [[nodiscard]] constexpr bool takes(std::string_view option, Level level) const {
    const auto is_in = [&](const Names& names) {
      return std::find(names.begin(), names.end(), option) != names.end();
    };
    return level != Level::kInternal && !is_in(without) && (only[0].empty() || is_in(only));
  }
};

// What keeps samples near their previous positions is for trackers.
inline constexpr Verb<SampleOptions> kSample = {"sample",
                                                {"max_slide", "stickiness", "slide_smoothing"}};
inline constexpr Verb<ResampleOptions> kResample = {"resample", kSample.without};
inline constexpr Verb<RelaxOptions> kRelax = {"relax", kSample.without};
inline constexpr Verb<ClassOptions> kSampleClasses = {"sample_classes", kSample.without};
inline constexpr Verb<SampleOptions> kEvaluateEnergy = {
    "evaluate_energy", {}, {"capacity_weight", "cells"}};
inline constexpr Verb<SampleOptions> kAnalyze = {"analyze", {}, kEvaluateEnergy.only};
inline constexpr Verb<TrackerOptions> kTracker = {"Tracker"};
inline constexpr Verb<PopulationOptions> kPopulation = {"Population"};
inline constexpr Verb<WindowOptions> kTrackWindow = {"track_window"};
inline constexpr Verb<WindowOptions> kWindowTracker = {"WindowTracker"};
inline constexpr Verb<StippleOptions> kStippleInks = {
    "stipple_inks", {"max_slide", "stickiness", "slide_smoothing", "method"}};
inline constexpr Verb<MosaicOptions> kMosaic = {"mosaic"};
inline constexpr Verb<RemeshOptions> kRemesh = {"remesh", kSample.without};
inline constexpr Verb<RemeshOptions> kRemeshNext = {
    "remesh_next", {"max_slide", "stickiness", "slide_smoothing", "adaptive", "non_manifold"}};
inline constexpr Verb<SymmetryOptions> kSampleSymmetric = {"sample_symmetric", kSample.without};
inline constexpr Verb<LineOptions> kSampleLines = {"sample_lines"};
inline constexpr Verb<ImageOptions> kRefineImage = {"refine_image"};

inline constexpr std::tuple kVerbs = {
    kSample,  kResample,   kRelax,           kSampleClasses, kEvaluateEnergy, kAnalyze,
    kTracker, kPopulation, kTrackWindow,     kWindowTracker, kStippleInks,    kMosaic,
    kRemesh,  kRemeshNext, kSampleSymmetric, kSampleLines,   kRefineImage};

}  // namespace dapple::python
