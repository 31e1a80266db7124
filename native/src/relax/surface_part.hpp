// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

#include "surface/ordered_face.hpp"

namespace dapple {

/// Some faces of a surface as a surface of their own, connected as they were.
class SurfacePart {
 public:
  /// \param faces sorted; at least one
  /// \throw Cancelled
  SurfacePart(const Surface& whole, std::span<const OrderedFace> faces, Context* context);

  [[nodiscard]] const Surface& surface() const { return surface_; }
  /// The caller's faces of the whole as the part's; -1 for those that are not in it.
  [[nodiscard]] std::int32_t inside(std::int32_t face) const {
    return inside_[static_cast<std::size_t>(face)];
  }
  /// The part's faces as the caller's of the whole.
  [[nodiscard]] std::int32_t outside(std::int32_t face) const {
    return outside_[static_cast<std::size_t>(face)];
  }

 private:
  Surface surface_;
  std::vector<std::int32_t> outside_;
  std::vector<std::int32_t> inside_;
};

/// Faces and those that only they surround: what no way leads out of without crossing them.
/// \param faces sorted
/// \param most  faces; a larger hole is none
/// \return sorted
[[nodiscard]] std::vector<OrderedFace> without_holes(const Surface& surface,
                                                     std::vector<OrderedFace> faces,
                                                     std::size_t most);

}  // namespace dapple
