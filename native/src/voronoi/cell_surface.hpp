// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "density/cut_surface.hpp"
#include "surface/sides.hpp"

namespace dapple {

/// The surface that the cells of a given number of sites are computed on.
struct CellSurface {
  std::shared_ptr<const SidedSurface> sided;  ///< see with_sides(); null where nothing differs
  std::shared_ptr<const CutSurface> cut;      ///< the same, cut into pieces; null if it is not cut

  /// The surface without the cuts.
  [[nodiscard]] const Surface& uncut(const Surface& whole) const {
    return sided ? sided->all : whole;
  }
  /// The surface without parts where sites should not start.
  [[nodiscard]] const Surface& start(const Surface& whole) const {
    return sided ? sided->without_rims : whole;
  }
};

/// Depends only on the surface and `count`. Only cells that follow the surface have sides.
/// \throw Cancelled
[[nodiscard]] CellSurface cell_surface(const Surface& surface, std::size_t count, Cells cells,
                                       Context* context = nullptr);

/// The sides of walls where there are `count` sites, whose cells may or may not follow the surface.
[[nodiscard]] KnownSides sides_for(const Surface& surface, std::size_t count, Cells cells,
                                   Context* context = nullptr);

/// Caches the results of cell_surface() for one surface. Every member may be called from several
/// threads.
class CellSurfaces {
 public:
  explicit CellSurfaces(Cells cells, KnownSides sides = std::nullopt)
      : cells_(cells), known_(std::move(sides)) {}
  [[nodiscard]] CellSurface at(const Surface& surface, std::size_t count,
                               Context* context = nullptr);
  /// The sides, if they do not depend on the count; otherwise null.
  [[nodiscard]] std::shared_ptr<const SidedSurface> known(const Surface& surface);

 private:
  [[nodiscard]] std::shared_ptr<const SidedSurface> sides_of(const Surface& surface,
                                                             std::size_t count,
                                                             Context* context) const;

  Cells cells_;
  KnownSides known_;
  std::mutex mutex_;
  std::map<std::size_t, std::shared_ptr<const SidedSurface>> sided_;  // by the count
  // By the order of magnitude of the count; those with sides by these too.
  std::map<std::pair<int, const SidedSurface*>, std::shared_ptr<const CutSurface>> cut_;
};

}  // namespace dapple
