// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/grout.hpp"

#include "base/polygon.hpp"
#include "base/sort_unique.hpp"

namespace dapple {
namespace {

constexpr double kBeyond = 1e-9;  // of the distance to a neighbor: rounding error of corners

std::vector<std::int32_t> neighbors_of(std::span<const CellPolygon> cell) {
  std::vector<std::int32_t> result;
  for (const CellPolygon& piece : cell)
    for (const std::int32_t edge : piece.edges)
      if (edge >= 0) result.push_back(edge);
  sort_unique(result);
  return result;
}

void start(Polygon& polygon, const CellPolygon& piece, const Vec3& site) {
  std::vector<Polygon::Corner> corners;
  for (std::size_t k = 0; k < piece.points.size(); ++k)
    corners.push_back({piece.points[k] - site, piece.edges[k]});
  polygon.start(corners);
}

/// Clip by the bisector of the site and the one at `to`, moved by `width` toward the site.
void cut(Polygon& polygon, const Vec3& to, std::int32_t neighbor, double width) {
  const double distance = to.norm();
  const Vec3 normal = to / distance;
  if (polygon.measure(normal, 0.5 * distance).high > kBeyond * distance) return;
  if (polygon.measure(normal, 0.5 * distance - width).high > 0.0) polygon.cut(neighbor);
}

CellPolygon to_piece(const Polygon& polygon, const CellPolygon& like, const Vec3& site) {
  CellPolygon result{like.site, like.face, {}, {}};
  for (const Polygon::Corner& corner : polygon.corners()) {
    result.points.push_back(corner.x + site);
    result.edges.push_back(corner.edge);
  }
  return result;
}

}  // namespace

std::vector<CellPolygon> without_grout(std::span<const CellPolygon> cell,
                                       std::span<const Vec3> sites, double width) {
  if (width == 0.0) return {cell.begin(), cell.end()};
  const std::vector<std::int32_t> neighbors = neighbors_of(cell);
  std::vector<CellPolygon> result;
  Polygon polygon;
  for (const CellPolygon& piece : cell) {
    const Vec3& site = sites[static_cast<std::size_t>(piece.site)];
    start(polygon, piece, site);
    for (const std::int32_t j : neighbors)
      if (!polygon.empty()) cut(polygon, sites[static_cast<std::size_t>(j)] - site, j, width);
    if (polygon.corners().size() >= 3) result.push_back(to_piece(polygon, piece, site));
  }
  return result;
}

double area_of(const CellPolygon& piece) {
  double twice = 0.0;
  for (std::size_t k = 2; k < piece.points.size(); ++k)
    twice +=
        (piece.points[k - 1] - piece.points[0]).cross(piece.points[k] - piece.points[0]).norm();
  return 0.5 * twice;
}

}  // namespace dapple
