// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "remesh/dual.hpp"

namespace dapple {

/// What a site was in the mesh of the surface before.
struct Origin {
  std::int32_t vertex = -1;  ///< -1: it is new
  bool stays = false;        ///< it does not move, because the surface around it is the same
};

/// The sites of a remesh, with what they may do.
struct RemeshSites {
  Sites sites;
  std::vector<SiteKind> kinds;
  std::vector<std::int32_t> chains;  ///< of FeatureLines; -1 for those on none, or at corners
  std::vector<bool> pinned;          ///< added for the topology: it and its surroundings stay
  std::vector<Origin> origins;

  [[nodiscard]] std::size_t size() const { return sites.size(); }
  /// Whether a site may go anywhere within its sheet.
  [[nodiscard]] bool is_free(std::size_t site) const {
    return kinds[site] == SiteKind::kFree && !origins[site].stays;
  }
  /// Whether all corners of a triangle stay.
  [[nodiscard]] bool stay(const Face& triangle) const;
  void add(const Sites& more, SiteKind kind, std::int32_t chain, bool pin, Origin origin = {});
  /// Some of the sites, with what they may do.
  [[nodiscard]] RemeshSites chosen(std::span<const std::size_t> members) const;
  void move(std::size_t site, const Sites& to, SiteKind kind, std::int32_t chain);
};

/// Mend violations: move free sites to the lines that their cells reach, and add sites elsewhere,
/// at most one for each neighborhood.
/// \param dense neighborhoods are small: more sites at once, some of which may be needless
/// \return the number of edits
std::size_t mend(const Surface& surface, const FeatureLines& lines,
                 std::span<const Violation> violations, RemeshSites& sites, bool dense = false);

/// Remove up to `excess` free sites that are far from pinned sites, lines and each other.
/// \param skipped the first so many stay
/// \return number of sites removed
std::size_t thin_out(const Dual& dual, std::size_t excess, RemeshSites& sites,
                     std::size_t skipped = 0);

/// Per site, whether it is within `rings` edges of a marked one.
[[nodiscard]] std::vector<bool> widened(std::span<const Face> triangles, std::vector<bool> marked,
                                        int rings);

}  // namespace dapple
