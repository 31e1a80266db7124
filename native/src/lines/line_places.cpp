// SPDX-License-Identifier: GPL-3.0-or-later
#include "lines/line_places.hpp"

#include <algorithm>

#include "base/segment.hpp"
#include "lines/line_sites.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {

LinePlaces::LinePlaces(const Surface& surface, const FeatureLines& lines)
    : mesh_(surface.ordered()), lines_(lines), edge_of_(3 * surface.face_count(), 0) {
  for (std::size_t c = 0; c < lines.chains().size(); ++c) {
    const LineChain& chain = lines.chains()[c];
    for (std::size_t e = 0; e < chain.half_edges.size(); ++e) {
      for_each_half_edge(mesh_, chain.half_edges[e],
                         [&](std::int32_t h) { edge_of_[as_index(h)] = e; });
      at_vertices_[chain.vertices[e]] = {-1, static_cast<std::int32_t>(c), e, 0.0};
    }
    if (chain.closed) continue;
    const std::size_t last = chain.half_edges.size() - 1;
    at_vertices_[chain.vertices.back()] = {-1, static_cast<std::int32_t>(c), last, 1.0};
  }
  for (std::size_t k = 0; k < lines.corners().size(); ++k)
    at_vertices_[lines.corners()[k]] = {static_cast<std::int32_t>(k), -1, 0, 0.0};
}

LinePlace LinePlaces::find(std::int32_t face, const Vec3& point, double tolerance) const {
  const OrderedFace ordered = mesh_.ordered_face(face);
  for (const std::int32_t v : mesh_.welded_corners(ordered))
    if ((mesh_.vertex(v) - point).norm() <= tolerance) return at_vertex(v);
  LinePlace found;
  double least = tolerance;
  for (std::int32_t k = 0; k < 3; ++k) {
    const std::int32_t h = half_edge(ordered, k), chain = lines_.chain_of(h);
    if (chain < 0) continue;
    const std::size_t e = edge_of_[as_index(h)];
    const LineChain& line = lines_.chains()[as_index(chain)];
    const Vec3 &a = mesh_.vertex(line.vertices[e]), &b = mesh_.vertex(line.vertices[e + 1]);
    const double share = nearest_share(point, a, b);
    const double distance = (a + share * (b - a) - point).norm();
    if (distance > least) continue;
    least = distance;
    found = {-1, chain, e, share};
  }
  return found;
}

LinePlace LinePlaces::at_vertex(std::int32_t vertex) const {
  const auto found = at_vertices_.find(vertex);
  return found == at_vertices_.end() ? LinePlace{} : found->second;
}

Sites LinePlaces::site_at(const LinePlace& place) const {
  if (place.corner >= 0)
    return point_on_edge(mesh_, lines_.half_edge_at(as_index(place.corner)), 0.0);
  return point_on_chain(mesh_, lines_.chains()[as_index(place.chain)], {place.edge, place.share});
}

}  // namespace dapple
