// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/refine.hpp>

#include "base/triangle.hpp"
#include "base/validate.hpp"

namespace dapple {
namespace {

/// Whether a piece is a whole face.
bool is_whole(const std::array<Vec3, 3>& piece) {
  return piece[0] == Vec3::UnitX() && piece[1] == Vec3::UnitY() && piece[2] == Vec3::UnitZ();
}

}  // namespace

std::vector<Vec3> Refined::vertices(std::span<const Vec3> coarse) const {
  check_same_length("vertices", coarse.size(), "the surface", original.vertex_count());
  std::vector<Vec3> result(coarse.begin(), coarse.end());
  result.reserve(coarse.size() + ends.size());
  for (std::size_t k = 0; k < ends.size(); ++k)
    result.emplace_back(between(result[static_cast<std::size_t>(ends[k][0])],
                                result[static_cast<std::size_t>(ends[k][1])], shares[k]));
  return result;
}

Refined Refined::deformed(std::span<const Vec3> coarse) const {
  Refined result = *this;
  result.original = original.deformed(coarse);
  result.surface = surface.deformed(vertices(coarse));
  return result;
}

Refined Refined::then(const Refined& finer) const {
  check_same_length("faces of finer's original", finer.original.face_count(), "the surface",
                    surface.face_count());
  if (!finer.original.same_faces(surface))
    throw ArgumentError("finer.original is not the refined surface: refine that one again");
  Refined result{original,
                 finer.surface,
                 {},
                 {},
                 ends,
                 shares,
                 resolved && finer.resolved,
                 std::max(inset, finer.inset)};
  result.ends.insert(result.ends.end(), finer.ends.begin(), finer.ends.end());
  result.shares.insert(result.shares.end(), finer.shares.begin(), finer.shares.end());
  result.parents.reserve(finer.parents.size());
  result.barycentric.reserve(finer.parents.size());
  for (std::size_t f = 0; f < finer.parents.size(); ++f) {
    const auto middle = static_cast<std::size_t>(finer.parents[f]);
    result.parents.push_back(parents[middle]);
    std::array<Vec3, 3>& corners = result.barycentric.emplace_back(barycentric[middle]);
    if (is_whole(finer.barycentric[f])) continue;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = combined(barycentric[middle], finer.barycentric[f][k]);
  }
  return result;
}

}  // namespace dapple
