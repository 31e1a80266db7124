// SPDX-License-Identifier: GPL-3.0-or-later
#include "stipple/raster_domain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "base/density_unit.hpp"
#include "base/laps.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/segment.hpp"
#include "base/validate.hpp"
#include "plane/flat_cells.hpp"
#include "stipple/pixel_integrals.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 512;  // cells per chunk
constexpr std::size_t kSides = 7;    // per cell: the average is about six
constexpr std::int32_t kFrame = -1;  // label of the edges along the picture's border

/// Rescales the density if its values are far from 1.
Image checked(Image density) {
  check_image("density", density);
  const double most = *std::max_element(density.values.begin(), density.values.end());
  double sum = 0.0;
  for (const double value : density.values) sum += value / most;
  const double unit = density_unit(most, sum / static_cast<double>(density.values.size()));
  if (unit != 1.0)
    for (double& value : density.values) value *= unit;
  return density;
}

Surface rectangle(const Vec2& size) {
  const std::vector<Vec3> vertices = {
      {0, 0, 0}, {size.x(), 0, 0}, {size.x(), size.y(), 0}, {0, size.y(), 0}};
  const std::vector<Face> faces = {{0, 1, 2}, {0, 2, 3}};
  return {vertices, faces};
}

/// The cell of a site in the rectangle [0, size]; edge k lies on the bisector with link k.
void shape_cell(const Vec2& size, const Vec2& x, std::span<const SiteGraph::Link> links,
                FlatPolygon& cell) {
  cell.corners = {{-x, kFrame},
                  {Vec2(size.x(), 0.0) - x, kFrame},
                  {size - x, kFrame},
                  {Vec2(0.0, size.y()) - x, kFrame}};
  for (std::size_t k = 0; k < links.size(); ++k) {
    const Vec2 d = links[k].offset.head<2>();
    cell.cut(d, 0.5 * d.squaredNorm(), static_cast<std::int32_t>(k));
  }
}

void append_boundaries(const FlatPolygon& cell, const PixelIntegrals& integrals,
                       std::span<const SiteGraph::Link> links, std::vector<CellBoundary>& out) {
  for (std::size_t k = 0; k < cell.corners.size(); ++k) {
    const FlatPolygon::Corner& corner = cell.corners[k];
    if (corner.edge == kFrame) continue;
    const PixelIntegrals::Edge edge = integrals.along(k);
    if (edge.length <= 0.0) continue;
    const SiteGraph::Link& link = links[static_cast<std::size_t>(corner.edge)];
    const Vec2 flux = edge.flux / link.offset.norm();
    const Vec2& end = cell.corners[k + 1 < cell.corners.size() ? k + 1 : 0].x;
    const Vec2 along = end - corner.x;
    out.push_back({link.site, Vec3(flux.x(), flux.y(), 0.0), link.offset, edge.length,
                   2.0 * std::sqrt(squared_distance_to_segment(corner.x, along))});
  }
}

/// The largest coordinate that belongs to a pixel.
double end_of(std::int32_t pixel, std::int32_t count) {
  const double end = pixel + 1;
  return pixel + 1 < count ? std::nextafter(end, 0.0) : end;
}

Vec2 flat(const Vec3& p) { return p.head<2>(); }

/// The cells of some consecutive sites, with their boundaries in the same order.
struct Chunk {
  Laps laps;  // time of the search for neighbors
  std::vector<CellBoundary> boundaries;

  void integrate(const Image& density, const FlatSites& sites, std::size_t begin, std::size_t end,
                 RestrictedVoronoi& result) {
    const Vec2 size(static_cast<double>(density.columns), static_cast<double>(density.rows));
    FlatCells cells(sites, {Vec2::Zero(), size});
    PixelIntegrals integrals(density);
    FlatPolygon cell;
    boundaries.reserve(kSides * (end - begin));
    for (std::size_t k = begin; k < end; ++k) {
      {
        const Laps::Lap lap(laps);
        cells.turn_to(static_cast<std::int32_t>(k));
      }
      const std::size_t site = sites.site_at(k);
      const Vec2 x = flat(sites.position(static_cast<std::int32_t>(k)));
      shape_cell(size, x, cells.links(), cell);
      integrals.reset(cell, x);
      result.cells[site] = integrals.moments();
      const std::size_t first = boundaries.size();
      append_boundaries(cell, integrals, cells.links(), boundaries);
      result.rows[site].count = boundaries.size() - first;
    }
  }
};

/// Concatenate the boundaries of all sites, in the order of the sites.
void join_boundaries(const FlatSites& sites, const std::vector<Chunk>& chunks,
                     RestrictedVoronoi& result) {
  std::size_t count = 0;
  for (RestrictedVoronoi::Row& row : result.rows) {
    row.first = count;
    count += row.count;
  }
  result.boundaries.resize(count);
  parallel_chunks(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    auto next = chunks[begin / kGrain].boundaries.begin();
    for (std::size_t k = begin; k < end; ++k) {
      const RestrictedVoronoi::Row& row = result.rows[sites.site_at(k)];
      const auto to = result.boundaries.begin() + static_cast<std::ptrdiff_t>(row.first);
      std::copy_n(next, row.count, to);
      next += static_cast<std::ptrdiff_t>(row.count);
    }
  });
}

}  // namespace

RasterDomain::RasterDomain(Image density)
    : density_(checked(std::move(density))),
      size_(static_cast<double>(density_.columns), static_cast<double>(density_.rows)),
      capacity_(std::accumulate(density_.values.begin(), density_.values.end(), 0.0)),
      frame_(rectangle(size_)) {}

// Only the first of coincident sites has a cell.
void RasterDomain::update_cells(RestrictedVoronoi& result, const Sites& sites, std::size_t /*set*/,
                                Context* context) const {
  const FlatSites places =
      in_stage(context, Stage::kNeighbors, [&] { return FlatSites(sites.positions, false); });
  result.cells.assign(sites.size(), {});
  result.rows.assign(sites.size(), {});
  std::vector<Chunk> chunks((places.size() + kGrain - 1) / kGrain);
  Tally tally(context, places.size());
  std::optional<SharedLoop> loop(std::in_place, context, Stage::kNeighbors);
  parallel_chunks(places.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    tally.check();
    Chunk& mine = chunks[begin / kGrain];
    loop->run(begin / kGrain, mine.laps,
              [&] { mine.integrate(density_, places, begin, end, result); });
    tally.add(end - begin);
  });
  loop.reset();
  join_boundaries(places, chunks, result);
}

Sites RasterDomain::project(std::span<const Vec3> points, std::span<const std::int32_t>,
                            const Context* context) const {
  check_finite("points", points);
  Sites sites;
  sites.positions.resize(points.size());
  sites.faces.resize(points.size());
  sites.barycentric.assign(points.size(), Vec3::Zero());
  parallel_chunks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (context) context->check();
    for (std::size_t k = begin; k < end; ++k) {
      const Vec2 p = nearest(flat(points[k]));
      const Vec2 last = size_ - Vec2::Ones();
      const Vec2 pixel = p.array().floor().min(last.array());
      sites.positions[k] = {p.x(), p.y(), 0.0};
      sites.faces[k] = static_cast<std::int32_t>(pixel.y() * size_.x() + pixel.x());
    }
  });
  return sites;
}

// Search square rings of pixels around the pixel that contains the point; all pixels of ring k are
// at least k - 1 away.
Vec2 RasterDomain::nearest(const Vec2& point) const {
  const auto columns = static_cast<std::int32_t>(density_.columns);
  const auto rows = static_cast<std::int32_t>(density_.rows);
  const Vec2 inside = point.cwiseMax(0.0).cwiseMin(size_);
  const std::int32_t column = std::min(static_cast<std::int32_t>(inside.x()), columns - 1);
  const std::int32_t row = std::min(static_cast<std::int32_t>(inside.y()), rows - 1);
  Vec2 best = inside;
  double distance = std::numeric_limits<double>::infinity();
  const auto look = [&](std::int32_t c, std::int32_t r) {
    if (c < 0 || c >= columns || r < 0 || r >= rows) return;
    if (density_.values[static_cast<std::size_t>(r) * density_.columns +
                        static_cast<std::size_t>(c)] <= 0.0)
      return;
    const Vec2 low(c, r);
    const Vec2 p = inside.cwiseMax(low).cwiseMin(Vec2(end_of(c, columns), end_of(r, rows)));
    if ((p - inside).norm() >= distance) return;
    distance = (p - inside).norm();
    best = p;
  };
  look(column, row);
  for (std::int32_t k = 1; distance > k - 1 && k <= std::max(columns, rows); ++k)
    for (std::int32_t along = -k; along <= k; ++along) {
      look(column + along, row - k);
      look(column + along, row + k);
      look(column - k, row + along);
      look(column + k, row + along);
    }
  return best;
}

std::vector<bool> RasterDomain::on_border(const Sites& sites, const RestrictedVoronoi&) const {
  const FlatSites places(sites.positions, false);
  std::vector<char> found(sites.size(), 0);  // not bool, because several would share a byte
  parallel_chunks(places.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    FlatCells cells(places, {Vec2::Zero(), size_});
    for (std::size_t k = begin; k < end; ++k) {
      cells.turn_to(static_cast<std::int32_t>(k));
      found[places.site_at(k)] = cells.at_frame() ? 1 : 0;
    }
  });
  return {found.begin(), found.end()};
}

void RasterDomain::check(const Sites& sites) const { check_finite("positions", sites.positions); }

}  // namespace dapple
