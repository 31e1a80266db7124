// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/tracker_options.hpp>

namespace dapple {

struct WindowOptions {
  TrackerOptions tracker = {
      .optimizer = {.max_evaluations = 6, .max_slide = 0.45, .stickiness = 1.0}};
  int sweeps = 2;
  bool closed = false;
};

inline constexpr std::tuple kWindowOptions = {
    Option{"closed",
           &WindowOptions::closed,
           {},
           "",
           Level::kExpert,
           "The last frame leads back to the first: the loop closes."},
    Option{"sweeps",
           &WindowOptions::sweeps,
           {},
           "",
           Level::kExpert,
           "Passes forwards and backwards over all frames, after the first."},
    Group{&WindowOptions::tracker}};

constexpr const auto& options_of(const WindowOptions&) { return kWindowOptions; }

}  // namespace dapple
