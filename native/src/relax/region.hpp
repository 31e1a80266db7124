// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "rebalance/among_locked.hpp"
#include "relax/surface_part.hpp"

namespace dapple {

/// The sites of one round and the part of the surface that they lie on.
struct Region {
  struct Member {
    std::int32_t site;
    bool fixed;
    bool open;      // new sites may be inserted into its cell, even if it is locked
    bool measured;  // it may move, or has a neighbor that may
  };

  SurfacePart part;
  std::vector<Member> members = {};
  Sites sites = {};  // on the part

  /// \param face of the part
  void add(const Member& member, const Sites& from, std::size_t k, std::int32_t face) {
    members.push_back(member);
    sites.positions.push_back(from.positions[k]);
    sites.faces.push_back(face);
    sites.barycentric.push_back(from.barycentric[k]);
  }

  /// Copy the new places of movable members back to all sites.
  /// \param first index of the first member among the found sites
  void put_free(const Sites& found, std::size_t first, Sites& all) const {
    for (std::size_t k = 0; k < members.size(); ++k) {
      if (members[k].fixed) continue;
      const auto site = static_cast<std::size_t>(members[k].site);
      all.positions[site] = found.positions[first + k];
      all.faces[site] = part.outside(found.faces[first + k]);
      all.barycentric[site] = found.barycentric[first + k];
    }
  }

  [[nodiscard]] std::vector<bool> fixed() const {
    return which([](const Member& member) { return member.fixed; });
  }
  [[nodiscard]] std::vector<bool> free() const {
    return which([](const Member& member) { return !member.fixed; });
  }
  [[nodiscard]] std::vector<bool> open() const {
    return which([](const Member& member) { return member.open; });
  }
  [[nodiscard]] std::vector<bool> measured() const {
    return which([](const Member& member) { return member.measured; });
  }
  [[nodiscard]] SharedCells shared(const RestrictedVoronoi& diagram) const {
    return {diagram.cells, open(), fixed()};
  }

 private:
  [[nodiscard]] std::vector<bool> which(const auto& is) const {
    std::vector<bool> result;
    result.reserve(members.size());
    for (const Member& member : members) result.push_back(is(member));
    return result;
  }
};

}  // namespace dapple
