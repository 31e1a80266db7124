// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "base/vectors.hpp"

namespace dapple {

/// Two sites that moves may bring nearer than a least distance. Directions are tangential at both
/// ends, because a site stays in its plane.
struct Contact {
  std::size_t i, j;
  double gap;       ///< distance - least distance
  Vec3 at_i, at_j;  ///< the direction from j to i in the plane of each; zero if locked
  double room;      ///< increase of the gap if both sites move by one unit along at_i and -at_j
  double nearly;    ///< how much nearer than the least distance they may remain

  /// How much nearer than the least distance the sites are after the moves, to first order.
  [[nodiscard]] double excess(const Vectors& moves) const {
    return -(gap + at_i.dot(moves[i]) - at_j.dot(moves[j]));
  }
};

/// The tangent planes in which sites move.
struct Planes {
  const Vectors& normals;           ///< per site
  const std::vector<bool>& locked;  ///< per site, whether it stays; empty: none

  /// The part of a direction in a site's plane; zero if the site is locked.
  [[nodiscard]] Vec3 part(std::size_t k, const Vec3& direction) const {
    if (!locked.empty() && locked[k]) return Vec3::Zero();
    return direction - normals[k].dot(direction) * normals[k];
  }
};

/// Least room of two sites that can move apart along the surface. Those on the two sides of a thin
/// edge have less: they would have to move far for a little more distance.
inline constexpr double kRoomAlong = 0.5;

/// Add a contact, unless none of the two can move apart.
/// \param d from j to i; not zero
/// \param least_room contacts with less room are not added
/// \return whether it was added
bool add_contact(const Planes& planes, std::size_t i, std::size_t j, const Vec3& d, double least,
                 double nearly, std::vector<Contact>& contacts, double least_room = 0.0);

/// Change moves so that the sites of each contact keep their least distance, to first order: errors
/// of a step along a curved surface are left to the next step. Each contact restricts the moves to
/// a half-space; they are projected onto one after another (Gauss-Seidel), so that a site pressed
/// against others moves to where there is space, also along them.
void separate(std::span<const Contact> contacts, Vectors& moves);

}  // namespace dapple
