// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/option.hpp>
#include <dapple/refine.hpp>
#include <dapple/types.hpp>

namespace dapple {

struct ImageOptions {
  /// Repeat the picture periodically; otherwise its border pixels continue.
  bool repeat = false;  // expert
  /// Largest error of the density at a point, relative to the picture's maximum; the relative error
  /// of a face's capacity is at most half of it.
  double max_error = 0.02;  // expert, > 0
  /// Edges of this length or shorter are not cut.
  double texels = 1.0;  // expert, > 0, pixels
  /// Edges of this length or shorter on the surface are not cut: detail far finer than the spacing
  /// of samples costs time without effect.
  double shortest = 0.0;  // expert, >= 0, units of the surface
  /// Maximum number of faces; beyond it the rest stays coarser, and resolved is False.
  std::size_t max_faces = 1'000'000;  // expert, 1..kMostRefinedFaces
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const ImageOptions& options);

/// Use an image as the density of the surface: texture coordinates (0, 0) are the outer corner of
/// its first pixel, (1, 1) that of its last, and between pixel centers the image is bilinear. Faces
/// are refined until the density, linear on each face, matches the image to `max_error` or their
/// edges are short enough; an existing density of the surface is multiplied.
/// \param uv  one row per face, within 1e6 of 0; where it jumps between faces the density may jump
/// \return density at corners; `resolved` is false if max_faces was too small for all detail
/// \throw ArgumentError naming the first texture coordinate out of range, value of the
/// picture that is negative or not finite, option out of range; SurfaceError if the picture is 0
/// wherever the surface is; Cancelled
[[nodiscard]] Refined refine_image(const Surface& surface, std::span<const FaceUv> uv,
                                   const Image& image, const ImageOptions& options = {},
                                   Context* context = nullptr);

}  // namespace dapple
