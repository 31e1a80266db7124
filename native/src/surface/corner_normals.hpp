// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>

#include "surface/ordered_surface.hpp"

namespace dapple {

/// Hard edges: borders, edges of three faces and more, edges whose faces are oriented against each
/// other, and those whose faces' normals differ by more than `sharp_angle` degrees.
[[nodiscard]] std::shared_ptr<const Shading> shading_by_angle(const OrderedSurface& mesh,
                                                              double sharp_angle);

/// The same with given normals: between faces that have them, exactly the edges across which they
/// jump are hard. \param corners three per face of the caller's, unit or zero
[[nodiscard]] std::shared_ptr<const Shading> shading_of_normals(const OrderedSurface& mesh,
                                                                double sharp_angle,
                                                                std::span<const Vec3> corners);

/// The angle of a face at one of its corners, in radians; corners are numbered like half-edges.
[[nodiscard]] double angle_at(const OrderedSurface& mesh, std::int32_t corner);

/// Unit normals at the corners of faces: the given ones, elsewhere the mean over the surrounding
/// faces that are joined to this one by edges that are not hard, weighted by their angles at the
/// vertex (Thuermer and Wuethrich 1998). Zero where these cancel.
class CornerNormals {
 public:
  /// \param faces the caller's indices of the faces
  CornerNormals(const OrderedSurface& mesh, std::span<const std::int32_t> faces);

  /// \pre the face was requested
  [[nodiscard]] const Vec3& at(OrderedFace face, std::int32_t corner) const;

  /// The same as a direction: where normals cancel, as on a sheet folded flat, the face's own
  /// normal; for a face without area, the z axis.
  /// \pre as at()
  [[nodiscard]] Vec3 direction_at(OrderedFace face, std::int32_t corner) const;
  /// The direction of the normals of the three corners, added with weights.
  [[nodiscard]] Vec3 between(OrderedFace face, const Vec3& weights) const;

 private:
  [[nodiscard]] Vec3 direction_of(OrderedFace face, const Vec3& sum) const;
  [[nodiscard]] bool is_given(std::int32_t corner) const;

  const OrderedSurface& mesh_;
  std::vector<std::int32_t> fan_;  // per corner, -1 where it is not wanted or given
  std::vector<Vec3> normals_;      // per fan
};

}  // namespace dapple
