// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/planar.hpp>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "base/triangle.hpp"
#include "base/validate.hpp"
#include "base/vectors.hpp"
#include "plane/flat_graph.hpp"
#include "plane/polygon_mesh.hpp"
#include "start/class_start.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"
#include "voronoi/cell_surface.hpp"

namespace dapple {
namespace {

constexpr double kCut = 0.3;  // share of the progress of an evaluation when large faces are cut
constexpr double kOutside = 1e-9;  // of the domain's size: larger distances are not rounding errors

const Image& checked(const Image& image) {
  check_image("density", image);
  return image;
}

/// Checks the size before allocating memory: two triangles per cell.
void check_grid(std::size_t columns, std::size_t rows) {
  if (columns > kMostSurfaceFaces / 2 / rows)
    throw ArgumentError("density needs " + std::to_string(rows) + " x " + std::to_string(columns) +
                        " vertices: at most " + std::to_string(kMostSurfaceFaces / 2) +
                        " are possible");
}

/// Triangles on a grid with lines at x and y, two per cell. The triangle below the diagonal has the
/// index 2 (row * columns + column), the one above it the next index. `value(column, row)` is the
/// density at a grid point.
template <typename Value>
Surface grid_surface(const std::vector<double>& x, const std::vector<double>& y,
                     const Value& value) {
  check_grid(x.size(), y.size());
  std::vector<Vec3> vertices;
  std::vector<double> density;
  vertices.reserve(x.size() * y.size());
  density.reserve(vertices.capacity());
  for (std::size_t row = 0; row < y.size(); ++row) {
    check_context(nullptr);
    for (std::size_t column = 0; column < x.size(); ++column) {
      vertices.emplace_back(x[column], y[row], 0.0);
      density.push_back(value(column, row));
    }
  }
  std::vector<Face> faces;
  faces.reserve(2 * (x.size() - 1) * (y.size() - 1));
  const auto vertex = [&](std::size_t column, std::size_t row) {
    return static_cast<std::int32_t>(row * x.size() + column);
  };
  for (std::size_t row = 0; row + 1 < y.size(); ++row) {
    check_context(nullptr);
    for (std::size_t column = 0; column + 1 < x.size(); ++column) {
      const std::int32_t a = vertex(column, row), c = vertex(column + 1, row + 1);
      faces.push_back({a, vertex(column + 1, row), c});
      faces.push_back({a, c, vertex(column, row + 1)});
    }
  }
  return Surface(vertices, faces, density);
}

Surface box_surface(const Vec2& low, const Vec2& high) {
  const std::vector<Vec3> vertices = {{low.x(), low.y(), 0},
                                      {high.x(), low.y(), 0},
                                      {high.x(), high.y(), 0},
                                      {low.x(), high.y(), 0}};
  const std::vector<Face> faces = {{0, 1, 2}, {0, 2, 3}};
  return Surface(vertices, faces);
}

/// The centers of pixels first .. last, of `count` pixels per unit length.
std::vector<double> centers(int first, int last, int count) {
  std::vector<double> result;
  for (int k = first; k <= last; ++k) result.push_back((k + 0.5) / count);
  return result;
}

/// The image, repeated periodically, over the centers of pixels from `first` to `last`.
Surface periodic_surface(const Image& image, const Eigen::Array2i& first,
                         const Eigen::Array2i& last) {
  const auto columns = static_cast<int>(image.columns), rows = static_cast<int>(image.rows);
  const auto wrapped = [](int k, int count) {
    return static_cast<std::size_t>((k % count + count) % count);
  };
  return grid_surface(centers(first.x(), last.x(), columns), centers(first.y(), last.y(), rows),
                      [&](std::size_t column, std::size_t row) {
                        const std::size_t c =
                            wrapped(static_cast<int>(column) + first.x(), columns);
                        const std::size_t r = wrapped(static_cast<int>(row) + first.y(), rows);
                        return image.values[r * image.columns + c];
                      });
}

Eigen::Array2i size_of(const Image& image) {
  return {static_cast<int>(image.columns), static_cast<int>(image.rows)};
}

// A cell reaches up to half a period beyond its site, which is in the square. The cover is
// therefore the square with a margin of half a period, rounded up to whole pixels.
Eigen::Array2i pixels_before(const Eigen::Array2i& size) { return size / 2 + 2; }
Eigen::Array2i last_pixel(const Eigen::Array2i& size) { return size + (size + 1) / 2 + 1; }

double wrap(double x) {
  const double wrapped = x - std::floor(x);
  return wrapped < 1.0 ? wrapped : 0.0;  // the difference can round up to 1
}

/// The bounding box of a domain.
/// \param size of a rectangle; 0 for a polygon
Eigen::AlignedBox2d frame_of(const Surface& surface, const Vec2& size) {
  if (!size.isZero()) return {Vec2::Zero(), size};
  Eigen::AlignedBox2d frame;
  for (const Vec3& corner : surface.vertices()) frame.extend(corner.head<2>());
  return frame;
}

std::vector<Vec3> in_space(const char* name, std::span<const Vec2> points) {
  std::vector<Vec3> result;
  for (const Vec2& p : points) result.emplace_back(p.x(), p.y(), 0.0);
  check_finite(name, result);
  return result;
}

}  // namespace

// ---- plane and torus ----

Sites FlatDomain::start(Start kind, std::size_t count, std::uint64_t seed, Context* context) const {
  check_count("count", count);
  const Surface surface = start_surface(count);
  const ClassStarts starts{{{&surface, count}}, &surface, period(), seed};
  return project(
      (kind == Start::kRandom ? random_start(starts) : poisson_start(starts, context)).positions,
      {});
}

// ---- the plane ----

Plane::Plane(Surface surface, const Vec2& size, std::shared_ptr<const Image> density)
    : FlatDomain(std::move(density)),
      surface_(std::move(surface)),
      size_(size),
      projector_(std::make_shared<Projector>(surface_, /*support_only=*/true)),
      cell_surfaces_(std::make_shared<CellSurfaces>(Cells::kEuclidean)) {}

Plane Plane::rectangle(double width, double height) {
  check_positive("width", width);
  check_positive("height", height);
  return {box_surface(Vec2::Zero(), {width, height}), {width, height}, nullptr};
}

Plane Plane::image(double width, double height, const Image& density) {
  check_positive("width", width);
  check_positive("height", height);
  checked(density);
  const auto lines = [](double length, std::size_t count) {
    std::vector<double> result = {0.0};
    for (std::size_t k = 0; k < count; ++k)
      result.push_back(length * (static_cast<double>(k) + 0.5) / static_cast<double>(count));
    result.push_back(length);
    return result;
  };
  const auto pixel = [](std::size_t line, std::size_t count) {
    return std::clamp<std::size_t>(line, 1, count) - 1;
  };
  Surface surface = grid_surface(
      lines(width, density.columns), lines(height, density.rows),
      [&](std::size_t column, std::size_t row) {
        return density
            .values[pixel(row, density.rows) * density.columns + pixel(column, density.columns)];
      });
  return {std::move(surface), {width, height}, std::make_shared<const Image>(density)};
}

Plane Plane::polygon(const std::vector<Vec2>& outline, std::span<const std::vector<Vec2>> holes) {
  return {polygon_surface(outline, holes), Vec2::Zero(), nullptr};
}

void Plane::update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t /*set*/,
                         Context* context) const {
  if (context) context->check();
  Stretch cutting(context, 0.0, kCut);
  // A rectangle is convex, so straight lines between its points stay inside.
  const auto cut =
      size_.isZero() ? cell_surfaces_->at(surface_, sites.size(), cutting.context()).cut : nullptr;
  Stretch dividing(context, cut ? kCut : 0.0, 1.0);
  diagram = restricted_voronoi(
      cut ? cut->surface() : surface_, cut ? cut->on_pieces(sites) : sites,
      in_stage(context, Stage::kNeighbors,
               [&] { return plane_graph(sites.positions, frame_of(surface_, size_)); }),
      cells_, dividing.context());
}

double Plane::capacity() const { return surface_.ordered().unit_capacity(); }

double Plane::density_unit() const { return surface_.ordered().density_unit(); }

Sites Plane::project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                     const Context* context) const {
  Projection found = projector_->project(points, hints, context);
  move_off_zeros(surface_, found.faces, found.barycentric, found.positions);
  return {std::move(found.positions), std::move(found.faces), std::move(found.barycentric)};
}

void Plane::check(const Sites& sites) const { check_sites(surface_, sites); }

Sites Plane::sites(std::span<const Vec2> points) const {
  Projection found = Projector(surface_).project(in_space("positions", points));
  for (std::size_t k = 0; k < points.size(); ++k)
    if (found.distances[k] > kOutside * std::sqrt(area()))
      throw ArgumentError(entry("positions", k) + " is (" + number(points[k].x()) + ", " +
                          number(points[k].y()) + "), outside the domain by " +
                          number(found.distances[k]));
  return {std::move(found.positions), std::move(found.faces), std::move(found.barycentric)};
}

std::unique_ptr<FlatDomain> Plane::with_cells(Cells cells) const {
  auto result = std::make_unique<Plane>(*this);
  result->cells_ = cells;
  return result;
}

std::vector<bool> Plane::on_border(const Sites& sites, const RestrictedVoronoi& diagram) const {
  return cells_on_border(surface_, sites, diagram);
}

std::unique_ptr<FlatDomain> Plane::with_density(const Image& density) const {
  if (size_.x() == 0.0)
    throw ArgumentError("density is an image, but the domain is a polygon: use a rectangle");
  return image(size_.x(), size_.y(), density).with_cells(cells_);
}

// ---- the torus ----

Torus::Torus()
    : FlatDomain(nullptr),
      pixels_(0, 0),
      before_(0, 0),
      quads_(1, 1),
      period_(box_surface({0, 0}, {1, 1})),
      cover_(box_surface({-1, -1}, {2, 2})) {}

Torus::Torus(const Image& density)
    : FlatDomain(std::make_shared<const Image>(density)),
      pixels_(size_of(checked(density))),
      before_(pixels_before(pixels_)),
      quads_(last_pixel(pixels_) + before_),
      period_(periodic_surface(density, {0, 0}, pixels_)),
      cover_(periodic_surface(density, -before_, last_pixel(pixels_))) {
  if (std::find(density.values.begin(), density.values.end(), 0.0) != density.values.end())
    support_ = std::make_shared<const Projector>(cover_, /*support_only=*/true);
}

std::int32_t Torus::face_at(const Vec2& wrapped) const {
  const Eigen::Array2d at =
      uniform() ? ((wrapped.array() + 1.0) / 3.0).eval()
                : (wrapped.array() * pixels_.cast<double>() - 0.5 + before_.cast<double>()).eval();
  const Eigen::Array2i quad = at.floor().cast<int>().max(0).min(quads_ - 1);
  const Eigen::Array2d inside = at - quad.cast<double>();
  return 2 * (quad.y() * quads_.x() + quad.x()) + (inside.y() > inside.x() ? 1 : 0);
}

Vec2 Torus::canonical(const Vec3& position) const {
  return {wrap(position.x()), wrap(position.y())};
}

void Torus::update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t /*set*/,
                         Context* context) const {
  if (context) context->check();
  Sites wrapped;
  wrapped.positions.resize(sites.size());
  wrapped.faces.resize(sites.size());
  for_each_vector(sites.size(), [&](std::size_t k) {
    const Vec2 p = canonical(sites.positions[k]);
    wrapped.positions[k] = {p.x(), p.y(), 0.0};
    wrapped.faces[k] = face_at(p);
  });
  const SiteGraph graph =
      in_stage(context, Stage::kNeighbors, [&] { return torus_graph(wrapped.positions); });
  diagram = restricted_voronoi(cover_, wrapped, graph, Cells::kEuclidean, context);
}

double Torus::capacity() const {
  const OrderedSurface& period = period_.ordered();
  return period.unit_capacity() * (density_unit() / period.density_unit());
}

double Torus::density_unit() const { return cover_.ordered().density_unit(); }

Sites Torus::project(std::span<const Vec3> points, std::span<const std::int32_t>,
                     const Context* context) const {
  check_finite("points", points);
  if (context) context->check();
  Sites sites = bind(points);
  if (support_) lead_to_density(sites, context);
  return sites;
}

/// Bind the points to the faces of the cover without moving them.
Sites Torus::bind(std::span<const Vec3> points) const {
  const OrderedSurface& cover = cover_.ordered();
  Sites sites{Vectors(points.size()), std::vector<std::int32_t>(points.size()),
              Vectors(points.size())};
  for_each_vector(points.size(), [&](std::size_t k) {
    const Vec2 p = canonical(points[k]);
    sites.faces[k] = face_at(p);
    const auto [a, b, c] = cover.corners(cover.ordered_face(sites.faces[k]));
    sites.positions[k] = {points[k].x(), points[k].y(), 0.0};
    sites.barycentric[k] =
        closest_barycentric({p.x(), p.y(), 0.0}, cover.vertex(a), cover.vertex(b), cover.vertex(c));
  });
  return sites;
}

/// Move sites on density 0 to the nearest point with positive density.
void Torus::lead_to_density(Sites& sites, const Context* context) const {
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (is_on_density(cover_, sites.faces[k], sites.barycentric[k])) continue;
    const Vec2 p = canonical(sites.positions[k]);
    const Vec3 point(p.x(), p.y(), 0.0);
    Projection found = support_->project({&point, 1}, {}, context);
    move_off_zeros(cover_, found.faces, found.barycentric, found.positions);
    const Vec3 moved = sites.positions[k] + (found.positions[0] - point);
    const Sites there = bind({&moved, 1});
    sites.positions[k] = there.positions[0];
    sites.faces[k] = there.faces[0];
    sites.barycentric[k] = there.barycentric[0];
  }
}

void Torus::check(const Sites& sites) const { check_sites(cover_, sites); }

Sites Torus::sites(std::span<const Vec2> points) const {
  return bind(in_space("positions", points));
}

// Cells on a torus are connected, so the rule for parts of cells does not matter.
std::unique_ptr<FlatDomain> Torus::with_cells(Cells) const {
  return std::make_unique<Torus>(*this);
}

std::vector<bool> Torus::on_border(const Sites& sites, const RestrictedVoronoi&) const {
  return std::vector<bool>(sites.size(), false);
}

std::unique_ptr<FlatDomain> Torus::with_density(const Image& density) const {
  return std::make_unique<Torus>(density);
}

Sites Torus::to_sampling_surface(const Sites& sites) const {
  std::vector<Vec3> points;
  for (const Vec3& x : sites.positions) {
    const Vec2 p = canonical(x);
    points.emplace_back(p.x(), p.y(), 0.0);
  }
  Projection found = Projector(period_).project(points);
  return {std::move(found.positions), std::move(found.faces), std::move(found.barycentric)};
}

}  // namespace dapple
