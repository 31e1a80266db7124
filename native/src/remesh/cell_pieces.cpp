// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/cell_pieces.hpp"

#include <numeric>

#include "base/parallel.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 512;  // pieces

}  // namespace

CellPieces::CellPieces(const Surface& surface, const FeatureLines& lines,
                       std::span<const CellPolygon> polygons, std::size_t sites)
    : rows_(sites + 1, 0) {
  firsts_.reserve(polygons.size() + 1);
  firsts_.push_back(0);
  for (const CellPolygon& polygon : polygons)
    firsts_.push_back(firsts_.back() + static_cast<std::int32_t>(polygon.points.size()));
  const auto edges = as_index(firsts_.back());
  for (auto* values : {&rivals_, &half_edges_, &pieces_}) values->resize(edges);
  for (auto* values : {&sites_, &faces_}) values->resize(polygons.size());
  from_.resize(edges);
  parallel_chunks(polygons.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) place(surface, lines, polygons[p], p);
  });
  for (const std::int32_t site : sites_) ++rows_[as_index(site) + 1];
  std::partial_sum(rows_.begin(), rows_.end(), rows_.begin());
  index_faces(surface);
}

void CellPieces::place(const Surface& surface, const FeatureLines& lines,
                       const CellPolygon& polygon, std::size_t piece) {
  const OrderedFace face = surface.ordered().ordered_face(polygon.face);
  const std::size_t count = polygon.points.size();
  const bool turned = lines.sign(face) < 0;
  for (std::size_t k = 0, e = as_index(firsts_[piece]); k < count; ++k, ++e) {
    // Turned over, the edge from point k + 1 to point k comes before that from k to k - 1.
    const std::size_t edge = turned ? (2 * count - 2 - k) % count : k;
    const std::size_t point = turned ? count - 1 - k : k;
    const std::int32_t on = polygon.edges[edge];
    from_[e] = polygon.points[point];
    rivals_[e] = on >= 0 ? on : kOnEdge;
    half_edges_[e] = on >= 0 ? -1 : dapple::half_edge(face, -1 - on);
    pieces_[e] = static_cast<std::int32_t>(piece);
  }
  sites_[piece] = polygon.site;
  faces_[piece] = polygon.face;
}

void CellPieces::index_faces(const Surface& surface) {
  face_rows_.assign(surface.face_count() + 1, 0);
  const auto row = [&](std::int32_t face) {
    return as_index(surface.ordered().ordered_face(face));
  };
  for (const std::int32_t face : faces_) ++face_rows_[row(face) + 1];
  std::partial_sum(face_rows_.begin(), face_rows_.end(), face_rows_.begin());
  by_face_.resize(faces_.size());
  std::vector<std::size_t> next(face_rows_.begin(), face_rows_.end() - 1);
  for (std::size_t p = 0; p < faces_.size(); ++p)
    by_face_[next[row(faces_[p])]++] = static_cast<std::int32_t>(p);
}

}  // namespace dapple
