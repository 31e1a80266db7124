// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <functional>

#include "surface/ordered_face.hpp"

namespace dapple {

/// A site that reached a face, and the area it found there; sites are ordered ones.
struct Coverage {
  std::int32_t site;
  OrderedFace face;
  double area;
};

/// A face and one of the sites that divide it among themselves.
struct Share {
  std::int32_t site;
  OrderedFace face;
  auto operator<=>(const Share&) const = default;
};

/// The sites among `asked` that own a part of `face` if only `rivals` compete; all sorted.
using Divide = std::function<std::vector<std::int32_t>(
    OrderedFace face, std::span<const std::int32_t> asked, std::span<const std::int32_t> rivals)>;

/// Faces that the floods did not cover, because straight distance goes through walls there.
[[nodiscard]] std::vector<OrderedFace> uncovered_faces(const Surface& surface,
                                                       std::span<const Coverage> pieces);

/// Give every uncovered face to sites that it is connected to along the surface, by label
/// propagation.
///
/// The labels of a face are its owners; it starts with the sites that reached it. Layer by layer an
/// uncovered face takes the owners of its neighbors as candidates and keeps those that own a part
/// of it, until nothing changes. A site that owns nothing against some rivals owns nothing against
/// more, so only owners and newcomers ever compete. A site whose flood found an area of the face is
/// the nearest of all there, and owns it against any rivals. The faces of a component without any
/// site stay without owners.
/// \param uncovered sorted
/// \return sorted by site
[[nodiscard]] std::vector<Share> share_out(const Surface& surface, std::span<const Coverage> pieces,
                                           std::span<const OrderedFace> uncovered,
                                           const Divide& divide);

}  // namespace dapple
