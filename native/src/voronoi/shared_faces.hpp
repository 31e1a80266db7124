// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <functional>

namespace dapple {

/// A site that reached a face, and the area it found there; all indices are ordered ones.
struct Coverage {
  std::int32_t site;
  std::int32_t face;
  double area;
};

/// A face and one of the sites that divide it among themselves.
struct Share {
  std::int32_t site;
  std::int32_t face;
  auto operator<=>(const Share&) const = default;
};

/// Of the sites `asked`, those that own something of `face` when only `rivals` compete; all sorted.
using Divide = std::function<std::vector<std::int32_t>(
    std::int32_t face, std::span<const std::int32_t> asked, std::span<const std::int32_t> rivals)>;

/// Faces that the floods did not cover, because straight distance goes through walls there.
[[nodiscard]] std::vector<std::int32_t> find_orphans(const Surface& surface,
                                                     std::span<const Coverage> pieces);

/// Give every orphan to sites that it is connected to along the surface.
///
/// A face's candidates start as the sites that reached it. Layer by layer an orphan hears of the
/// owners of its neighbors and keeps those that own something of it, until nothing changes: what
/// is owned spreads over the orphans from the faces around them. A site that owns nothing against
/// some never owns anything against more, so only owners and newcomers ever compete; one that its
/// flood found an area for is nearest there of all sites, and owns it against any.
/// Orphans of a component without any site stay without owners.
/// \param orphans sorted
/// \return sorted by site
[[nodiscard]] std::vector<Share> share_orphans(const Surface& surface,
                                               std::span<const Coverage> pieces,
                                               std::span<const std::int32_t> orphans,
                                               const Divide& divide);

}  // namespace dapple
