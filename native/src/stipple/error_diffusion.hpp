// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/types.hpp>
#include <span>

namespace dapple {

/// Dots of several classes in a picture, [0, columns] x [0, rows].
struct Diffused {
  std::vector<Vec2> positions;
  std::vector<std::int32_t> classes;
};

/// Exactly counts[c] dots of each class c, their number per area in proportion to densities[c], by
/// error diffusion (Floyd and Steinberg 1976, rows in alternating directions): each block of pixels
/// gets the nearest whole number of dots to its share, from the classes that lack most, and passes
/// its error on to the blocks not yet visited. A dot's place in its block is random. Blocks are so
/// large that there is one dot for every four of them; a pixel is never divided.
/// \pre densities are of one shape, >= 0, each with a sum > 0 where counts[c] > 0
/// \throw Cancelled
[[nodiscard]] Diffused diffuse_errors(std::span<const Image> densities,
                                      std::span<const std::size_t> counts, std::uint64_t seed,
                                      const Context* context = nullptr);

}  // namespace dapple
