// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/domain.hpp>
#include <dapple/surface.hpp>
#include <memory>

#include "surface/ordered_face.hpp"

namespace dapple {

/// The domain on the surface of a part: its two sides are not taken apart, and faces without
/// density far from all sites belong to no cell.
[[nodiscard]] std::shared_ptr<const SurfaceDomain> domain_of(const Surface& part);

/// Some faces of a surface as a surface of their own, with their connectivity.
class SurfacePart {
 public:
  /// \param faces sorted; at least one
  /// \throw Cancelled
  SurfacePart(const Surface& whole, std::span<const OrderedFace> faces, Context* context);

  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const std::shared_ptr<const SurfaceDomain>& domain() const { return domain_; }
  /// Faces of the whole surface (caller's indices) as faces of the part; -1 for faces outside it.
  [[nodiscard]] std::int32_t inside(std::int32_t face) const {
    return inside_[static_cast<std::size_t>(face)];
  }
  /// Faces of the part as faces of the whole surface (caller's indices).
  [[nodiscard]] std::int32_t outside(std::int32_t face) const {
    return outside_[static_cast<std::size_t>(face)];
  }

 private:
  std::vector<std::int32_t> outside_;
  std::vector<std::int32_t> inside_;
  Surface surface_;
  std::shared_ptr<const SurfaceDomain> domain_;  // keeps what was made to compute cells
};

/// The faces together with the holes that they enclose: faces from which every path outward crosses
/// them.
/// \param faces sorted
/// \param most  number of faces; larger holes are not filled
/// \return sorted
[[nodiscard]] std::vector<OrderedFace> without_holes(const Surface& surface,
                                                     std::vector<OrderedFace> faces,
                                                     std::size_t most);

}  // namespace dapple
