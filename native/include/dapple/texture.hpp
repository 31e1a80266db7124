// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <dapple/types.hpp>

namespace dapple {

/// The places of a picture's texels on a surface, row by row; row 0 is at v = 0.
struct Texels {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<std::int32_t> faces;  ///< the caller's index, per texel; -1 if no face is near
  std::vector<Vec3> barycentric;    ///< sum 1; in the margin outside a face some are negative

  [[nodiscard]] std::size_t size() const { return faces.size(); }
};

/// Find the face under the center of each texel; where texture coordinates overlap, the face of
/// lowest index. Texels up to `margin` texels away from a face continue the nearest one, so that
/// filtering does not mix in the background at seams. Parts outside [0, 1] x [0, 1] are left out.
/// \param uv      one row per face
/// \param rows, columns of the picture, >= 1
/// \param margin  in texels, >= 0
/// \throw ArgumentError naming the first texture coordinate that is not finite or too large, or
/// the size that is 0; Cancelled
[[nodiscard]] Texels texels(const Surface& surface, std::span<const FaceUv> uv, std::size_t rows,
                            std::size_t columns, int margin = 4, Context* context = nullptr);

}  // namespace dapple
