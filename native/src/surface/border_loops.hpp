// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dapple {

/// Number of closed chains of border half-edges of an OpenMesh mesh.
template <typename Mesh>
[[nodiscard]] std::int32_t count_border_loops(const Mesh& mesh) {
  std::vector<bool> seen(mesh.n_halfedges(), false);
  std::int32_t loops = 0;
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || seen[static_cast<std::size_t>(start.idx())]) continue;
    ++loops;
    for (auto h = start; !seen[static_cast<std::size_t>(h.idx())]; h = h.next())
      seen[static_cast<std::size_t>(h.idx())] = true;
  }
  return loops;
}

}  // namespace dapple
