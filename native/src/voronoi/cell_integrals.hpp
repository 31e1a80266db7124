// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <limits>

#include "base/triple.hpp"
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

  /// Before the flood moves on to other bisectors: merge the boundaries found with those used so
  /// far into `out`, by site.
  void flush_boundary(const OrderedSites& sites, std::vector<CellBoundary>& out);

 private:
  void set_density(const FaceGeometry& geometry, const Triple& centroid);
  [[nodiscard]] double density(const Triple& x) const { return at_site_ + gradient_.dot(x); }
  void add_area(const FaceGeometry& geometry);
  void add_boundary(const FaceGeometry& geometry);
  CellBoundary& boundary_with(std::int32_t bisector) {
    const auto k = static_cast<std::size_t>(bisector);
    if (k >= boundary_.size()) boundary_.resize(k + 1, kNoBoundary);
    return boundary_[k];
  }

  static inline const CellBoundary kNoBoundary = {-1, Vec3::Zero(), Vec3::Zero(), 0.0,
                                                  std::numeric_limits<double>::infinity()};

  const Surface* surface_;
  CellFlood* flood_;
  bool uniform_;  // whether the density is 1 everywhere
  Moments moments_;
  // Per bisector; path_length is that of one half, squared.
  std::vector<CellBoundary> boundary_;
  Triple gradient_ = {0.0, 0.0, 0.0};  // of the density on the face
  double at_site_ = 1.0;               // its value, extended to the site
};

}  // namespace dapple
