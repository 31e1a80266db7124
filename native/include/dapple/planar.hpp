// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <dapple/sampler.hpp>
#include <dapple/types.hpp>

namespace dapple {

/// A piece of the plane z = 0, or the torus. The density is linear on triangles.
class FlatDomain : public Domain {
 public:
  [[nodiscard]] Vec3 normal(std::int32_t) const override { return Vec3::UnitZ(); }

  /// Points of the domain as sites.
  /// \throw ArgumentError naming the first point that is not finite or lies outside
  [[nodiscard]] virtual Sites sites(std::span<const Vec2> points) const = 0;

  /// The point in the caller's coordinates.
  [[nodiscard]] virtual Vec2 canonical(const Vec3& position) const = 0;

  /// The same domain with another rule for parts that a notch or a hole cuts off from their site.
  [[nodiscard]] virtual std::unique_ptr<FlatDomain> with_cells(Cells cells) const = 0;

  /// The same domain with an image as its density.
  /// \throw ArgumentError as the constructor from an image; for a polygon, which takes none
  [[nodiscard]] virtual std::unique_ptr<FlatDomain> with_density(const Image& density) const = 0;

  /// Its density; null if it is 1.
  [[nodiscard]] const Image* density() const { return density_.get(); }

  /// Initial positions for an optimization.
  /// \throw Cancelled
  [[nodiscard]] Sites start(Start kind, std::size_t count, std::uint64_t seed,
                            Context* context) const;

 protected:
  explicit FlatDomain(std::shared_ptr<const Image> density) : density_(std::move(density)) {}

 private:
  std::shared_ptr<const Image> density_;
};

/// A rectangle, a polygon with holes, or an image over a rectangle. First the neighbors of each
/// cell are found, as if the domain were its whole bounding rectangle; then the cells are clipped
/// from the triangles of the domain.
class Plane : public FlatDomain {
 public:
  /// [0, width] x [0, height].
  /// \throw ArgumentError unless both are finite and > 0
  [[nodiscard]] static Plane rectangle(double width, double height);

  /// The same with a density: the image's values at the centers of its pixels, linear on triangles
  /// between them, constant over the half pixel along the border.
  /// \throw ArgumentError naming the first value that is not finite or negative; if their integral
  /// is 0 or not finite
  [[nodiscard]] static Plane image(double width, double height, const Image& density);

  /// A polygon with holes; the direction of the rings does not matter.
  /// \throw ArgumentError naming the first point that is not finite or repeats another, edge that
  /// crosses or touches another, ring of fewer than 3 points, hole that is not inside
  [[nodiscard]] static Plane polygon(const std::vector<Vec2>& outline,
                                     std::span<const std::vector<Vec2>> holes = {});

  /// The same domain as a flat mesh.
  [[nodiscard]] const Surface& surface() const { return surface_; }

  void update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t set,
                    Context* context) const override;
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const override;
  [[nodiscard]] double area() const override { return surface_.area(); }
  [[nodiscard]] double capacity() const override;
  [[nodiscard]] double density_unit() const override;
  [[nodiscard]] bool uniform() const override { return surface_.uniform(); }
  void check(const Sites& sites) const override;
  [[nodiscard]] Sites sites(std::span<const Vec2> points) const override;
  [[nodiscard]] Vec2 canonical(const Vec3& position) const override { return position.head<2>(); }
  [[nodiscard]] std::unique_ptr<FlatDomain> with_cells(Cells cells) const override;
  [[nodiscard]] std::vector<bool> on_border(const Sites& sites,
                                            const RestrictedVoronoi& diagram) const override;
  [[nodiscard]] std::unique_ptr<FlatDomain> with_density(const Image& density) const override;
  [[nodiscard]] Surface sampling_surface(std::size_t) const override { return surface_; }

 private:
  /// \param size width and height of a rectangle; 0 for a polygon
  Plane(Surface surface, const Vec2& size, std::shared_ptr<const Image> density);

  Surface surface_;
  Vec2 size_;
  std::shared_ptr<const Projector> projector_;  // onto the density's support
  std::shared_ptr<CellSurfaces> cell_surfaces_;
  Cells cells_ = Cells::kConnected;
};

/// The unit square with opposite sides joined. First the neighbors of each cell are found among the
/// sites and their images in the eight squares around; then the cells are clipped from triangles
/// that cover the square and half a period around it.
///
/// Any point of the plane stands for its place in the square. Positions are not wrapped during an
/// optimization, so that differences of positions are steps. A site is given by its position alone;
/// its face only tells where to look up the density.
class Torus final : public FlatDomain {
 public:
  Torus();  ///< density 1

  /// The image's values at the centers of its pixels, linear on triangles between them, going on
  /// periodically.
  /// \throw ArgumentError naming the first value that is not finite or negative; if their integral
  /// is 0 or not finite
  explicit Torus(const Image& density);

  void update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t set,
                    Context* context) const override;
  /// Every point lies on the torus, so this finds the faces. Points where the density is 0 move to
  /// where it is positive.
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const override;
  [[nodiscard]] double area() const override { return 1.0; }
  [[nodiscard]] double capacity() const override;
  [[nodiscard]] double density_unit() const override;
  [[nodiscard]] bool uniform() const override { return period_.uniform(); }
  [[nodiscard]] double period() const override { return 1.0; }
  void check(const Sites& sites) const override;
  [[nodiscard]] Sites sites(std::span<const Vec2> points) const override;
  [[nodiscard]] Vec2 canonical(const Vec3& position) const override;  ///< in [0, 1)^2
  [[nodiscard]] std::unique_ptr<FlatDomain> with_cells(Cells cells) const override;
  [[nodiscard]] std::vector<bool> on_border(const Sites& sites,
                                            const RestrictedVoronoi& diagram) const override;
  [[nodiscard]] std::unique_ptr<FlatDomain> with_density(const Image& density) const override;
  [[nodiscard]] Surface sampling_surface(std::size_t) const override { return period_; }
  [[nodiscard]] Sites to_sampling_surface(const Sites& sites) const override;

 private:
  [[nodiscard]] std::int32_t face_at(const Vec2& wrapped) const;
  [[nodiscard]] Sites bind(std::span<const Vec3> points) const;
  void lead_to_density(Sites& sites, const Context* context) const;

  Eigen::Array2i pixels_;  // columns and rows; 0 without a density
  Eigen::Array2i before_;  // pixels of the cover left of and below the square's first
  Eigen::Array2i quads_;   // of the cover
  Surface period_;         // once around
  Surface cover_;          // a part of the plane that contains the cell of every site in the square
  std::shared_ptr<const Projector> support_;  // of the cover; null where the density is nowhere 0
};

}  // namespace dapple
