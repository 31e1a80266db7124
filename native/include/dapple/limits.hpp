// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace dapple {

// The largest numbers that are taken; more is refused before memory is asked for.

/// Samples: around a torus there are nine images of each, whose numbers must fit into 32 bits.
inline constexpr std::size_t kMostSamples = 100'000'000;

/// Faces of a surface: three half-edges of each have numbers of 32 bits.
inline constexpr std::size_t kMostSurfaceFaces = 715'827'882;

/// Faces that a refinement makes: their corners and edges must fit into 32 bits.
inline constexpr std::size_t kMostRefinedFaces = 200'000'000;

/// Vertices of a surface, and pixels of a picture: they have numbers of 32 bits.
inline constexpr std::size_t kMostVertices = 2'147'483'647;
inline constexpr std::size_t kMostPixels = 2'147'483'647;

/// Threads: more than any machine has.
inline constexpr int kMostThreads = 4096;

}  // namespace dapple
