// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/refine.hpp>
#include <dapple/surface.hpp>
#include <span>
#include <vector>

namespace dapple {

/// Directions in which places look for the sky, evenly spread (Fibonacci lattice).
inline constexpr int kSkyDirections = 96;

/// How much of the sky places of a surface see: the share of the directions above the face in which
/// nothing of the surface is in the way, in 0..1. A convex body has 1 everywhere, what is inside
/// another part 0.
///
/// A face has two sides. If a patch of consistently oriented faces sees far more on one side, as
/// bodies do also where they are open, only that side counts, so what is hidden in front is not
/// seen through the hollow body behind it. Otherwise, as on leaves, the side that sees more counts.
/// The orientation of faces does not matter.
/// \param faces       the caller's index of the face of each place
/// \param barycentric where on its face each place is; >= 0, sum 1
/// \return one per place; 0 on faces without area and on all but the first of faces that lie on
///         each other
/// \throw ArgumentError naming the first face out of range; if the lengths differ; Cancelled
[[nodiscard]] std::vector<double> exposure(const Surface& surface,
                                           std::span<const std::int32_t> faces,
                                           std::span<const Vec3> barycentric,
                                           Context* context = nullptr);

/// The same at the centers of all faces.
[[nodiscard]] std::vector<double> exposure(const Surface& surface, Context* context = nullptr);

struct OutsideOptions {
  /// Least exposure of a place that counts as outside: 0..1; more leaves out crevices too. In a
  /// hollow part, such as a house without a floor, it must be up to four times as much, or 0.2.
  double openness = 0.05;
  /// Longest edge where faces are cut between places that see the sky and places that do not, in
  /// the surface's unit; > 0.
  double edge = 0.0;
  std::size_t max_faces = 1'000'000;  ///< 1..200000000; see refine()
  /// Other places of the surface's vertices while it moves: what is hidden in one of these poses
  /// counts as hidden.
  std::vector<std::vector<Vec3>> poses = {};
};

/// Remove the density where the surface is not seen from outside, such as on parts of a model that
/// are stuck into others.
///
/// Faces that pass through each other are cut along their common line and connected there. So
/// samples on different parts keep their distance across the visible joint, and the hidden sides
/// get none. Elsewhere faces are halved until the border of what is hidden is resolved; pieces with
/// a hidden corner lose their density. Faces are connected where they cross in the surface's own
/// pose.
/// \return `resolved` is false if max_faces was reached
/// \throw ArgumentError naming the first option out of range, the first pose with another number of
///        vertices or one that is not finite, or if nothing is seen; Cancelled
[[nodiscard]] Refined refine_outside(const Surface& surface, const OutsideOptions& options,
                                     Context* context = nullptr);

}  // namespace dapple
