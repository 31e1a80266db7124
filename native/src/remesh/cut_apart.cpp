// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/cut_apart.hpp"

#include <algorithm>

#include "base/sets.hpp"
#include "base/sort_unique.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {

void cut_apart(RemeshResult& mesh) {
  using Half = std::array<std::int32_t, 3>;  // an edge, and the corner where it starts
  std::vector<Half> halves;
  const auto corner_count = static_cast<std::int32_t>(3 * mesh.faces.size());
  const auto vertex = [&](std::int32_t corner) -> std::int32_t& {
    return mesh.faces[as_index(corner / 3)][as_index(corner % 3)];
  };
  const auto next = [](std::int32_t corner) { return corner - corner % 3 + (corner + 1) % 3; };
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto [a, b] = std::minmax(vertex(c), vertex(next(c)));
    halves.push_back({a, b, c});
  }
  std::ranges::sort(halves);
  Sets fans(as_index(corner_count));
  for (std::size_t k = 0, end = 0; k < halves.size(); k = end) {
    while (end < halves.size() && halves[end][0] == halves[k][0] && halves[end][1] == halves[k][1])
      ++end;
    const std::int32_t c = halves[k][2], d = halves[end - 1][2];
    if (end - k != 2) continue;
    const bool opposite = vertex(c) != vertex(d);
    fans.join(c, opposite ? next(d) : d);
    fans.join(next(c), opposite ? d : next(d));
  }
  std::vector<std::int32_t> root(mesh.vertices.size(), -1), made(as_index(corner_count), -1);
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto fan = fans.find(c);
    const auto v = as_index(vertex(c));
    std::int32_t& number = made[as_index(fan)];
    if (number < 0 && root[v] < 0) number = root[v] = static_cast<std::int32_t>(v);
    if (number < 0) {
      number = static_cast<std::int32_t>(mesh.vertices.size());
      mesh.vertices.push_back(Vec3(mesh.vertices[v]));
      mesh.source_faces.push_back(std::int32_t(mesh.source_faces[v]));
      mesh.barycentric.push_back(Vec3(mesh.barycentric[v]));
      mesh.features.push_back(VertexFeature(mesh.features[v]));
    }
  }
  std::vector<std::array<std::int32_t, 2>> lines;
  std::vector<bool> on_line(as_index(corner_count));
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto [a, b] = std::minmax(vertex(c), vertex(next(c)));
    on_line[as_index(c)] =
        std::ranges::binary_search(mesh.lines, std::array<std::int32_t, 2>{a, b});
  }
  for (std::int32_t c = 0; c < corner_count; ++c) vertex(c) = made[as_index(fans.find(c))];
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto [a, b] = std::minmax(vertex(c), vertex(next(c)));
    if (on_line[as_index(c)]) lines.push_back({a, b});
  }
  sort_unique(lines);
  mesh.lines = std::move(lines);
}

}  // namespace dapple
