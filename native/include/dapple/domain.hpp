// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <memory>
#include <mutex>

namespace dapple {

/// Where sites live, as the energy and the optimizer see it: a surface, the plane or the torus.
/// Implementations are immutable; every member may be called from several threads at once.
class Domain {
 public:
  virtual ~Domain() = default;

  /// The cells of the sites, relative to each site; integrals as mass().
  /// \param context  has the progress of this evaluation alone
  /// \throw Cancelled
  [[nodiscard]] virtual RestrictedVoronoi cells(const Sites& sites, Context* context) const = 0;

  /// The same in the memory that `diagram` has, whatever it held: evaluations that follow each
  /// other need not allocate. After an error it holds nothing of use.
  virtual void update_cells(const Sites& sites, Context* context,
                            RestrictedVoronoi& diagram) const {
    diagram = cells(sites, context);
  }

  /// The nearest points of the domain, each with its face; `hints` are faces near the points.
  /// \param context  is asked whether to go on, no more: this is a part of a step
  /// \throw Cancelled
  [[nodiscard]] virtual Sites project(std::span<const Vec3> points,
                                      std::span<const std::int32_t> hints,
                                      const Context* context = nullptr) const = 0;

  /// Unit normal of a face (of the plane, for flat domains).
  /// \pre the face is one of the domain's
  [[nodiscard]] virtual Vec3 normal(std::int32_t face) const = 0;

  [[nodiscard]] virtual double area() const = 0;
  /// Integral of the density. Like the cells' integrals, it is of the density times density_unit().
  [[nodiscard]] virtual double mass() const = 0;
  /// A power of two, 1 unless the density is extremely far from 1: keeps squares of integrals in
  /// the range of numbers.
  [[nodiscard]] virtual double density_unit() const { return 1.0; }
  [[nodiscard]] virtual bool uniform() const = 0;

  /// Per site, whether its cell ends at the domain's border.
  [[nodiscard]] virtual std::vector<bool> on_border(const Sites& sites,
                                                    const RestrictedVoronoi& diagram) const = 0;

  /// Length after which the x and y axes come back to where they began; 0 if they do not.
  [[nodiscard]] virtual double period() const { return 0.0; }

  /// A surface of the domain whose components exchange no sites where there are so many; on the
  /// torus once around.
  [[nodiscard]] virtual Surface sampling_surface(std::size_t count) const = 0;
  /// The same to draw the points from that are to become sites.
  [[nodiscard]] virtual Surface start_surface(std::size_t count) const {
    return sampling_surface(count);
  }
  /// Sites of the domain as sites of that surface.
  [[nodiscard]] virtual Sites to_sampling_surface(const Sites& sites) const { return sites; }

  /// Distance between neighbors if n points were packed hexagonally.
  [[nodiscard]] double spacing(std::size_t count) const;

  /// \throw ArgumentError naming the first site that is not of the domain
  virtual void check(const Sites& sites) const = 0;
};

class CellBuilders;
class CellSurfaces;

/// Where a point goes that has left a face near it.
enum class Steps {
  kAnywhere,  ///< to the nearest point of the surface, unless that is on another sheet
  kConnected  ///< to the nearest one met by walking from that face: needs no projector, whose
              ///< making takes longer than a few steps on a surface that soon changes again
};

/// What becomes of faces without density that are far from all sites, and of parts without sites.
enum class EmptyFaces {
  kCovered,  ///< they belong to cells, as all faces do
  kLeft      ///< to none, where cells follow the surface: they take time and change no other cell
};

/// A surface with its projector. Sites stay where there is density, and a step does not carry them
/// to another sheet.
class SurfaceDomain final : public Domain {
 public:
  /// \param sides where they are known; otherwise they follow the number of sites
  explicit SurfaceDomain(const Surface& surface, Cells cells = Cells::kConnected,
                         Steps steps = Steps::kAnywhere, KnownSides sides = std::nullopt,
                         EmptyFaces empty = EmptyFaces::kCovered);

  [[nodiscard]] RestrictedVoronoi cells(const Sites& sites, Context* context) const override;
  void update_cells(const Sites& sites, Context* context,
                    RestrictedVoronoi& diagram) const override;
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context = nullptr) const override;
  [[nodiscard]] Vec3 normal(std::int32_t face) const override;
  [[nodiscard]] double area() const override { return surface_.area(); }
  [[nodiscard]] double mass() const override;
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
  Steps steps_;
  EmptyFaces empty_;
  std::shared_ptr<CellSurfaces> cell_surfaces_;
  std::shared_ptr<CellBuilders> builders_;
  mutable std::mutex making_;
  mutable std::unique_ptr<const Projector> projector_;  // made when it is first needed
};

}  // namespace dapple
