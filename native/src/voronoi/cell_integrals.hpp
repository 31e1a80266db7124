// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/cells.hpp>

#include "surface/ordered_surface.hpp"
#include "voronoi/cell_flood.hpp"

namespace dapple {

/// Sums the integrals over one cell: its moments, and the fluxes through its boundary.
class CellIntegrals {
 public:
  /// The arguments must outlive the integrals.
  /// \param flood clips the faces that are added
  CellIntegrals(const Surface& surface, CellFlood& flood)
      : surface_(&surface), flood_(&flood), uniform_(surface.uniform()) {}

  /// Begin a cell.
  void reset();

  /// Add the piece of `face` that the flood has just clipped.
  void add(OrderedFace face, bool whole);

  [[nodiscard]] const Moments& moments() const { return moments_; }

  /// Before the flood moves on to other bisectors: merge what was found with those used so far into
  /// `out`, by site.
  void flush_boundary(const OrderedSites& sites, std::vector<CellBoundary>& out);

 private:
  void set_density(const FaceGeometry& geometry, const Vec3& centroid);
  [[nodiscard]] double density(const Vec3& x) const { return at_site_ + gradient_.dot(x); }
  void add_area(const FaceGeometry& geometry);
  void add_boundary(const FaceGeometry& geometry);
  CellBoundary& boundary_with(std::int32_t bisector);

  const Surface* surface_;
  CellFlood* flood_;
  bool uniform_;  // whether the density is 1 everywhere
  Moments moments_;
  std::vector<CellBoundary> boundary_;  // per bisector
  Vec3 gradient_ = Vec3::Zero();        // of the density on the face
  double at_site_ = 1.0;                // its value, extended to the site
};

}  // namespace dapple
