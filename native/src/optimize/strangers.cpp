// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/strangers.hpp"

#include <algorithm>
#include <dapple/neighbors.hpp>

#include "base/parallel.hpp"

namespace dapple {
namespace {

constexpr double kSameSide = -0.5;  // cosine between normals: 120 degrees

/// Whether sites on faces with these normals lie on the two sides of something between them.
/// \param d from the second to the first
bool look_away(const Vec3& first, const Vec3& second, const Vec3& d) {
  return first.dot(second) <= kSameSide && first.dot(d) > 0.0 && second.dot(d) < 0.0;
}

bool touch(const RestrictedVoronoi& diagram, std::size_t i, std::size_t j) {
  const auto boundary = diagram.boundary(i);
  return std::any_of(boundary.begin(), boundary.end(), [&](const CellBoundary& side) {
    return static_cast<std::size_t>(side.neighbor) == j;
  });
}

}  // namespace

std::vector<Stranger> find_strangers(const Domain& domain, const Sites& sites,
                                     const RestrictedVoronoi& diagram,
                                     const std::vector<double>& spacings) {
  const Neighbors tree(sites.positions);
  const std::size_t count = sites.size();
  std::vector<std::vector<Stranger>> found((count + kVectorGrain - 1) / kVectorGrain);
  parallel_chunks(count, kVectorGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> near;
    for (std::size_t i = begin; i < end; ++i) {
      const std::int32_t body = domain.body(sites.faces[i]);
      // The one with the larger spacing finds the pair.
      tree.within(sites.positions[i], kStrange * spacings[i], near);
      for (const Neighbor& neighbor : near) {
        const auto j = static_cast<std::size_t>(neighbor.index);
        if (domain.body(sites.faces[j]) == body || neighbor.squared_distance == 0.0) continue;
        if (spacings[j] > spacings[i] || (spacings[j] == spacings[i] && j < i)) continue;
        const Vec3 d = sites.positions[i] - sites.positions[j];
        if (d.norm() >= 0.5 * kStrange * (spacings[i] + spacings[j]) ||
            (!touch(diagram, i, j) &&
             look_away(domain.normal(sites.faces[i]), domain.normal(sites.faces[j]), d)))
          continue;
        found[begin / kVectorGrain].push_back({static_cast<std::int32_t>(i), neighbor.index, d});
      }
    }
  });
  std::vector<Stranger> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace dapple
