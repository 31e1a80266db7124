// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <memory>
#include <mutex>

namespace dapple {

/// The domain of the sites, as the energy and the optimizer see it: a surface, a piece of the
/// plane, or the torus. Implementations are immutable; every member may be called from several
/// threads at once.
class Domain {
 public:
  virtual ~Domain() = default;

  /// The cells of the sites, with moments relative to each site and integrals in the unit of
  /// capacity().
  /// \param context  carries the progress of this evaluation alone
  /// \throw Cancelled
  [[nodiscard]] RestrictedVoronoi cells(const Sites& sites, Context* context) const;

  /// The same in the memory of `diagram`, whatever it held, so that repeated evaluations do not
  /// allocate. After an error its contents are unspecified.
  /// \param set  which of several sets of sites that are evaluated in turn this is, from 0 on: what
  /// is known of the last sites of each is kept. The cells do not depend on it
  virtual void update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t set,
                            Context* context) const = 0;

  /// The nearest points of the domain, each with its face; `hints` are faces near the points.
  /// \param context  checked for cancellation only, since this is a part of a step
  /// \throw Cancelled
  [[nodiscard]] virtual Sites project(std::span<const Vec3> points,
                                      std::span<const std::int32_t> hints,
                                      const Context* context = nullptr) const = 0;

  /// Unit normal of a face; z in flat domains.
  /// \pre the face belongs to the domain
  [[nodiscard]] virtual Vec3 normal(std::int32_t face) const = 0;

  /// Whether the domain is made of several bodies (see Joints::bodies), and which a face is of.
  /// \pre the face belongs to the domain
  [[nodiscard]] virtual bool has_bodies() const { return false; }
  [[nodiscard]] virtual std::int32_t body([[maybe_unused]] std::int32_t face) const { return 0; }

  [[nodiscard]] virtual double area() const = 0;
  /// Integral of the density times density_unit(), as are the cells' integrals.
  [[nodiscard]] virtual double capacity() const = 0;
  /// A power of two that keeps squares of integrals within the range of floating-point numbers; 1
  /// unless the density is extremely large or small.
  [[nodiscard]] virtual double density_unit() const { return 1.0; }
  [[nodiscard]] virtual bool uniform() const = 0;

  /// Per site, whether its cell ends at the domain's border.
  [[nodiscard]] virtual std::vector<bool> on_border(const Sites& sites,
                                                    const RestrictedVoronoi& diagram) const = 0;

  /// Period of the x and y axes; 0 if the domain is not periodic.
  [[nodiscard]] virtual double period() const { return 0.0; }

  /// The domain as a surface to place `count` sites on, cut where sites of the two sides of a thin
  /// wall never trade places; for the torus, one period.
  [[nodiscard]] virtual Surface sampling_surface(std::size_t count) const = 0;
  /// The same surface for drawing initial positions.
  [[nodiscard]] virtual Surface start_surface(std::size_t count) const {
    return sampling_surface(count);
  }
  /// Sites of the domain as sites of sampling_surface().
  [[nodiscard]] virtual Sites to_sampling_surface(const Sites& sites) const { return sites; }

  /// Distance between neighbors if n points were packed hexagonally.
  [[nodiscard]] double spacing(std::size_t count) const;

  /// \throw ArgumentError naming the first site outside the domain
  virtual void check(const Sites& sites) const = 0;
};

class CellBuilders;
class CellSurfaces;

/// Whether faces without density far from all sites, and parts without sites, belong to cells.
enum class EmptyFaces {
  kCovered,  ///< they belong to cells, like all faces
  kLeft  ///< where cells follow the surface they belong to none, which saves time and changes no
         ///< other cell
};

/// A surface. Sites stay where the density is positive, and no step carries one to another sheet: a
/// moved point goes to the nearest point reached by walking from the face that it left.
class SurfaceDomain final : public Domain {
 public:
  /// \param sides the two sides of thin walls, where they are known; otherwise they are found from
  /// the number of sites
  explicit SurfaceDomain(const Surface& surface, Cells cells = Cells::kConnected,
                         KnownSides sides = std::nullopt, EmptyFaces empty = EmptyFaces::kCovered);

  void update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t set,
                    Context* context) const override;
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const override;
  [[nodiscard]] Vec3 normal(std::int32_t face) const override;
  [[nodiscard]] bool has_bodies() const override;
  [[nodiscard]] std::int32_t body(std::int32_t face) const override;
  [[nodiscard]] double area() const override { return surface_.area(); }
  [[nodiscard]] double capacity() const override;
  [[nodiscard]] double density_unit() const override;
  [[nodiscard]] bool uniform() const override { return surface_.uniform(); }
  [[nodiscard]] std::vector<bool> on_border(const Sites& sites,
                                            const RestrictedVoronoi& diagram) const override;
  [[nodiscard]] Surface sampling_surface(std::size_t count) const override;
  [[nodiscard]] Surface start_surface(std::size_t count) const override;
  void check(const Sites& sites) const override;

 private:
  void lead_from_empty_faces(const Surface& ground, std::span<const Vec3> points, Projection& found,
                             const Context* context) const;
  [[nodiscard]] const Projector& projector(const Context* context) const;
  [[nodiscard]] Surface stepping_surface() const;

  Surface surface_;
  Cells cells_;
  EmptyFaces empty_;
  std::shared_ptr<CellSurfaces> cell_surfaces_;
  std::shared_ptr<CellBuilders> builders_;
  mutable std::mutex making_;
  mutable std::unique_ptr<const Projector> projector_;  // made when it is first needed
};

}  // namespace dapple
