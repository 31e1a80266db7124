// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>
#include <dapple/image.hpp>
#include <dapple/sampler.hpp>

namespace dapple {

/// A piece of the plane z = 0, or the torus. Its density is linear on triangles.
class FlatDomain : public Domain {
 public:
  [[nodiscard]] Vec3 normal(std::int32_t) const override { return Vec3::UnitZ(); }

  /// Points of the domain as sites.
  /// \throw ArgumentError naming the first point that is not finite or outside
  [[nodiscard]] virtual Sites sites(std::span<const Vec2> points) const = 0;

  /// The point as the domain's caller knows it.
  [[nodiscard]] virtual Vec2 canonical(const Vec3& position) const = 0;

  /// The same domain with another rule for what a notch or a hole cuts off from its site.
  [[nodiscard]] virtual std::unique_ptr<FlatDomain> with_cells(Cells cells) const = 0;

  /// The same domain with an image as its density.
  /// \throw ArgumentError as the constructor from an image; for a polygon, which takes none
  [[nodiscard]] virtual std::unique_ptr<FlatDomain> with_density(const Image& density) const = 0;

  /// Its density; null if it is 1.
  [[nodiscard]] const Image* density() const { return density_.get(); }

  /// Where an optimization begins.
  /// \throw Cancelled
  [[nodiscard]] Sites start(Start kind, std::size_t count, std::uint64_t seed,
                            Context* context) const;

 protected:
  explicit FlatDomain(std::shared_ptr<const Image> density) : density_(std::move(density)) {}

 private:
  std::shared_ptr<const Image> density_;
};

/// A rectangle, a polygon with holes, or an image over a rectangle. Which cells touch is found
/// first, as if the domain were all of the rectangle around it; then the cells are cut out of the
/// triangles that make up the domain.
class PlanarDomain : public FlatDomain {
 public:
  /// [0, width] x [0, height].
  /// \throw ArgumentError unless both are finite and > 0
  [[nodiscard]] static PlanarDomain rectangle(double width, double height);

  /// The same with a density: the image's values at the centers of its pixels, linear on triangles
  /// between them, constant over the half pixel along the border.
  /// \throw ArgumentError naming the first value that is not finite or negative; if their integral
  /// is 0 or not finite
  [[nodiscard]] static PlanarDomain image(double width, double height, const Image& density);

  /// A polygon without its holes; the direction of the rings does not matter.
  /// \throw ArgumentError naming the first point that is not finite or repeats another, edge that
  /// crosses or touches another, ring of fewer than 3 points, hole that is not inside
  [[nodiscard]] static PlanarDomain polygon(const std::vector<Vec2>& outline,
                                            std::span<const std::vector<Vec2>> holes = {});

  /// The same domain as a flat mesh.
  [[nodiscard]] const Surface& surface() const { return surface_; }

  [[nodiscard]] RestrictedVoronoi cells(const Sites& sites, Context* context) const override;
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const override;
  [[nodiscard]] double area() const override { return surface_.area(); }
  [[nodiscard]] double mass() const override;
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
  PlanarDomain(Surface surface, const Vec2& size, std::shared_ptr<const Image> density);

  Surface surface_;
  Vec2 size_;
  std::shared_ptr<const Projector> projector_;  // onto the density's support
  std::shared_ptr<CellSurfaces> cell_surfaces_;
  Cells cells_ = Cells::kConnected;
};

/// The unit square with opposite sides joined. Which cells touch is found among the sites and their
/// images in the eight squares around it; then the cells are cut out of triangles that cover the
/// square and half a period around it.
///
/// Any point of the plane stands for its place in the square, and the gradient belongs to the point
/// as it is: while optimizing, positions are not wrapped, so that differences of positions are
/// steps. A site is its position alone; its face only says where the density is looked up.
class TorusDomain final : public FlatDomain {
 public:
  TorusDomain();  ///< density 1

  /// The image's values at the centers of its pixels, linear on triangles between them, going on
  /// periodically.
  /// \throw ArgumentError naming the first value that is not finite or negative; if their integral
  /// is 0 or not finite
  explicit TorusDomain(const Image& density);

  [[nodiscard]] RestrictedVoronoi cells(const Sites& sites, Context* context) const override;
  /// All points are of the torus: finds their faces. Those where the density is 0 move to where it
  /// is not.
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const override;
  [[nodiscard]] double area() const override { return 1.0; }
  [[nodiscard]] double mass() const override;
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
  Surface cover_;          // so much of the plane that it holds every cell of a site in the square
  std::shared_ptr<const Projector> support_;  // of the cover; null where the density is nowhere 0
};

}  // namespace dapple
