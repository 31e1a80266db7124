// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <dapple/types.hpp>

namespace dapple {

/// A picture in its own coordinates: [0, columns] x [0, rows] with a density that is constant on
/// each pixel. The cells equal those of a flat mesh, at the cost of the pixels that they cover and
/// without the memory of a mesh.
///
/// A site's face is the pixel that holds it, row * columns + column.
class RasterDomain final : public Domain {
 public:
  /// \throw ArgumentError as check_image("density", density)
  explicit RasterDomain(Image density);

  void update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t set,
                    Context* context) const override;
  /// The nearest points in pixels with density.
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const override;
  [[nodiscard]] Vec3 normal(std::int32_t) const override { return Vec3::UnitZ(); }
  [[nodiscard]] double area() const override { return size_.x() * size_.y(); }
  [[nodiscard]] double capacity() const override { return capacity_; }
  [[nodiscard]] bool uniform() const override { return false; }
  [[nodiscard]] std::vector<bool> on_border(const Sites& sites,
                                            const RestrictedVoronoi& diagram) const override;
  [[nodiscard]] Surface sampling_surface(std::size_t) const override {
    return frame_;
  }  ///< of density 1
  void check(const Sites& sites) const override;

 private:
  [[nodiscard]] Vec2 nearest(const Vec2& point) const;

  Image density_;
  Vec2 size_;
  double capacity_;
  Surface frame_;
};

}  // namespace dapple
