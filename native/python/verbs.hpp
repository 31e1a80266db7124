// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <dapple/mosaic.hpp>
#include <dapple/population.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/relax_options.hpp>
#include <dapple/stipple.hpp>
#include <dapple/window.hpp>
#include <string_view>
#include <tuple>

namespace dapple::python {

/// A function of the package, or a class that is made with options: those of a struct.
template <class Struct>
struct Verb {
  using Names = std::array<std::string_view, 3>;

  const char* name;
  Names without = {};  ///< options of the struct that mean nothing to it
  Names only = {};     ///< not empty: it takes no others

  [[nodiscard]] constexpr bool takes(std::string_view option, Level level) const {
    const auto is_in = [&](const Names& names) {
      return std::find(names.begin(), names.end(), option) != names.end();
    };
    return level != Level::kInternal && !is_in(without) && (only[0].empty() || is_in(only));
  }
};

// Samples at rest have no start to stay at; resample() starts from what there is.
inline constexpr Verb<SampleOptions> kSample = {"sample", {"max_slide", "stickiness"}};
inline constexpr Verb<SampleOptions> kSamplePlanar = {"sample_planar", kSample.without};
inline constexpr Verb<SampleOptions> kResample = {"resample", {"max_slide", "stickiness", "start"}};
inline constexpr Verb<RelaxOptions> kRelax = {"relax", kSample.without};
inline constexpr Verb<ClassOptions> kSampleClasses = {"sample_classes", kSample.without};
inline constexpr Verb<ClassOptions> kSamplePlanarClasses = {"sample_planar_classes",
                                                            kSample.without};
inline constexpr Verb<SampleOptions> kEnergy = {"energy", {}, {"capacity_weight", "cells"}};
inline constexpr Verb<SampleOptions> kEnergyPlanar = {"energy_planar", {}, kEnergy.only};
inline constexpr Verb<SampleOptions> kAnalyze = {"analyze", {}, kEnergy.only};
inline constexpr Verb<TrackerOptions> kTracker = {"Tracker"};
inline constexpr Verb<PopulationOptions> kPopulation = {"Population"};
inline constexpr Verb<WindowOptions> kTrackWindow = {"track_window"};
inline constexpr Verb<WindowOptions> kWindowTracker = {"WindowTracker"};
inline constexpr Verb<StippleOptions> kStippleInks = {"stipple_inks",
                                                      {"max_slide", "stickiness", "method"}};
inline constexpr Verb<MosaicOptions> kMosaic = {"mosaic"};
inline constexpr Verb<ImageOptions> kRefineImage = {"refine_image"};

inline constexpr std::tuple kVerbs = {
    kSample,        kSamplePlanar, kResample, kRelax,      kSampleClasses, kSamplePlanarClasses,
    kEnergy,        kEnergyPlanar, kAnalyze,  kTracker,    kPopulation,    kTrackWindow,
    kWindowTracker, kStippleInks,  kMosaic,   kRefineImage};

}  // namespace dapple::python
