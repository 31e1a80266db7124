// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/image.hpp>
#include <dapple/option.hpp>
#include <dapple/refine.hpp>

namespace dapple {

struct ImageOptions {
  bool repeat = false;
  double tolerance = 0.02;
  double texels = 1.0;
  double shortest = 0.0;
  std::size_t max_faces = 1'000'000;
};

inline constexpr std::tuple kImageOptions = {
    Option{"repeat",
           &ImageOptions::repeat,
           {},
           "",
           Level::kExpert,
           "The picture goes on periodically; otherwise its border does."},
    Option{
        "tolerance",
        &ImageOptions::tolerance,
        {0.0, kFinite, true},
        "",
        Level::kExpert,
        "How far the density may be off at a point, relative to the picture's maximum, and twice "
        "how far the mass of a face may be off, relative to itself."},
    Option{"texels",
           &ImageOptions::texels,
           {0.0, kFinite, true},
           "pixels",
           Level::kExpert,
           "Edges this short or shorter stay whole."},
    Option{"shortest",
           &ImageOptions::shortest,
           {0.0, kFinite},
           "",
           Level::kExpert,
           "The same on the surface, in the units of its vertices: detail far finer than the "
           "spacing of samples costs time and changes nothing."},
    Option{"max_faces",
           &ImageOptions::max_faces,
           {1.0, kMostRefinedFaces},
           "",
           Level::kExpert,
           "Most faces; what would take more stays coarser, and resolved is False."}};

constexpr const auto& options_of(const ImageOptions&) { return kImageOptions; }

/// Lay a picture over the surface as its density: (0, 0) is the outer corner of its first pixel,
/// (1, 1) that of its last; between the centers of pixels it is bilinear. Faces are cut until the
/// density, linear on each, is within the tolerance of the picture or their edges are short enough;
/// a density that the surface already has is multiplied.
/// \param uv  one row per face, within 1e6 of 0; where it jumps between faces the density may jump
/// \return density at corners; not `resolved` if max_faces was too few for all detail
/// \throw ArgumentError naming the first texture coordinate out of range, value of the
/// picture that is negative or not finite, option out of range; SurfaceError if the picture is 0
/// wherever the surface is; Cancelled
[[nodiscard]] Refined refine_image(const Surface& surface, std::span<const FaceUv> uv,
                                   const Image& image, const ImageOptions& options = {},
                                   Context* context = nullptr);

}  // namespace dapple
