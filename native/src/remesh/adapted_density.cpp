// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/adapted_density.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <functional>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

#include "base/parallel.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 256;          // vertices
constexpr double kLeast = 0.1, kMost = 100;  // distances, in their mean
constexpr double kGrowth = 0.25;             // of the spacing, by the way: angles stay large

/// The vertices along the edges of the faces at each vertex.
class VertexGraph {
 public:
  explicit VertexGraph(const OrderedSurface& mesh) : mesh_(mesh), rows_(mesh.vertex_count() + 1) {
    for_each_edge([&](std::int32_t from, std::int32_t) { ++rows_[as_index(from) + 1]; });
    std::partial_sum(rows_.begin(), rows_.end(), rows_.begin());
    ends_.resize(rows_.back());
    std::vector<std::size_t> next(rows_.begin(), rows_.end() - 1);
    for_each_edge([&](std::int32_t from, std::int32_t to) { ends_[next[as_index(from)]++] = to; });
  }

  [[nodiscard]] std::span<const std::int32_t> around(std::int32_t vertex) const {
    const std::size_t first = rows_[as_index(vertex)];
    return std::span(ends_).subspan(first, rows_[as_index(vertex) + 1] - first);
  }

 private:
  template <typename Visit>
  void for_each_edge(const Visit& visit) const {
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      const Face corners = mesh_.welded_corners(nth_face(f));
      for (std::size_t k = 0; k < 3; ++k) {
        visit(corners[k], corners[(k + 1) % 3]);
        visit(corners[(k + 1) % 3], corners[k]);
      }
    }
  }

  const OrderedSurface& mesh_;
  std::vector<std::size_t> rows_;
  std::vector<std::int32_t> ends_;
};

}  // namespace

AdaptedDensity::AdaptedDensity(const Surface& surface, std::size_t count)
    : surface_(surface),
      count_(static_cast<double>(count)),
      factors_(surface.vertex_count(), 1.0) {}

void AdaptedDensity::learn(std::span<const Vec3> vertices, std::span<const double> distances) {
  const double mean = std::accumulate(distances.begin(), distances.end(), 0.0) /
                      static_cast<double>(distances.size());
  if (!(mean > 0.0)) return;
  const OrderedSurface& mesh = surface_.ordered();
  const Neighbors tree(vertices);
  parallel_chunks(factors_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbor> nearest;
    for (std::size_t v = begin; v < end; ++v) {
      tree.nearest(mesh.vertex(static_cast<std::int32_t>(v)), 1, nearest);
      const double much = distances[as_index(nearest[0].index)] / mean;
      // A distance falls with the squared spacing, thus with the density; half of that in a round.
      factors_[v] *= std::sqrt(std::clamp(much, kLeast, kMost));
    }
  });
  limit_growth();
}

/// The mean distance of neighbors where the factor is 1, in a lattice of all vertices.
double AdaptedDensity::spacing() const {
  const OrderedSurface& mesh = surface_.ordered();
  double sum = 0.0;  // integral of the factor
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto [a, b, c] = mesh.welded_corners(nth_face(f));
    sum += mesh.geometry(nth_face(f)).moments.area / 3.0 *
           (factors_[as_index(a)] + factors_[as_index(b)] + factors_[as_index(c)]);
  }
  return std::sqrt(2.0 / std::numbers::sqrt3 * sum / count_);
}

/// The spacing grows no faster than by kGrowth along edges (Borouchaki, Hecht and Frey 1998, Mesh
/// gradation control): where it changes sooner, triangles become thin.
void AdaptedDensity::limit_growth() {
  const OrderedSurface& mesh = surface_.ordered();
  const VertexGraph graph(mesh);
  const double unit = spacing();
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<double> spacings(factors_.size());
  for (std::size_t v = 0; v < spacings.size(); ++v) {
    spacings[v] = unit / std::sqrt(factors_[v]);
    open.emplace(spacings[v], static_cast<std::int32_t>(v));
  }
  while (!open.empty()) {
    const auto [spacing, v] = open.top();
    open.pop();
    if (spacing > spacings[as_index(v)]) continue;
    for (const std::int32_t u : graph.around(v)) {
      const double most = spacing + kGrowth * (mesh.vertex(u) - mesh.vertex(v)).norm();
      if (!(most < spacings[as_index(u)])) continue;
      spacings[as_index(u)] = most;
      open.emplace(most, u);
    }
  }
  for (std::size_t v = 0; v < spacings.size(); ++v)
    factors_[v] = unit * unit / (spacings[v] * spacings[v]);
}

std::vector<double> AdaptedDensity::values() const {
  const OrderedSurface& mesh = surface_.ordered();
  std::vector<double> values(3 * surface_.face_count());
  for (std::size_t f = 0; f < surface_.face_count(); ++f) {
    const OrderedFace face = mesh.ordered_face(static_cast<std::int32_t>(f));
    const Face corners = mesh.welded_corners(face);
    const Vec3 own = mesh.densities(face);
    for (std::size_t c = 0; c < 3; ++c)
      values[3 * f + c] = own[static_cast<Eigen::Index>(c)] * factors_[as_index(corners[c])];
  }
  return values;
}

}  // namespace dapple
