// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <brute_force.hpp>
#include <cmath>
#include <dapple/crowding.hpp>
#include <dapple/curvature.hpp>
#include <dapple/energy.hpp>
#include <dapple/projector.hpp>
#include <dapple/solids.hpp>
#include <dapple/topology.hpp>
#include <dapple/visibility.hpp>
#include <limits>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

using Triangle = std::array<Vec3, 3>;

Triangle triangle_of(const Shape& shape, const Face& face) {
  const auto at = [&](std::size_t k) { return shape.vertices[static_cast<std::size_t>(face[k])]; };
  return {at(0), at(1), at(2)};
}

/// How far from the closest point of a triangle its corners' last digits may lead, the farther the
/// thinner it is; infinite without area.
double needle_rounding(const Triangle& corners) {
  const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
  const double longest = std::max({u.norm(), v.norm(), (v - u).norm()});
  const double height = u.cross(v).norm() / longest;
  return 64.0 * std::numeric_limits<double>::epsilon() * longest * (longest / height);
}

/// The closest of all faces, one after the other.
void expect_closest(const Shape& shape, const Vec3& point, double distance, double rounding) {
  double least = std::numeric_limits<double>::infinity();
  for (const Face& face : shape.faces) {
    const Triangle corners = triangle_of(shape, face);
    const Vec3 closest = test::closest_on_triangle(point, corners[0], corners[1], corners[2]);
    const double found = (closest - point).norm() + needle_rounding(corners);
    if (std::isfinite(found)) least = std::min(least, found);
  }
  EXPECT_LE(distance, least + rounding);
}

/// Of faces that lie on each other one counts, which may be as far from the others.
double doubled_apart(const Shape& shape, const Surface& surface) {
  if (surface.doubled_faces() == 0) return 0.0;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : shape.vertices) box.extend(p);
  return surface.weld().value_or(0.0) * box.diagonal().norm();
}

void fuzz_projector(Bytes& bytes, const Shape& shape, const Surface& surface) {
  const double size = std::sqrt(surface.area());
  std::vector<Vec3> points = take_sites(bytes, surface, bytes.below(10)).positions;
  test::Random random(bytes.byte());
  for (Vec3& p : points) p += bytes.power(-6, 2) * size * random.in_box();
  if (!points.empty() && bytes.one_in(8)) points[0] = {bytes.wild(), bytes.wild(), bytes.wild()};
  const auto found = answer([&] { return Projector(surface).project(points); });
  if (!found) return;
  test::check_on_surface(surface, {found->positions, found->faces}, found->barycentric);
  double largest = size;
  for (const Vec3& p : shape.vertices) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!std::isfinite(found->distances[k])) continue;  // the largest of all numbers away
    const double rounding = 1e-12 * std::max(largest, points[k].norm());
    EXPECT_NEAR(found->distances[k], (points[k] - found->positions[k]).norm(), rounding);
    expect_closest(shape, points[k], found->distances[k], rounding + doubled_apart(shape, surface));
  }
}

void expect_topology(const Topology& found) {
  EXPECT_GE(found.components, 1);
  EXPECT_GE(found.border_edges, 0);
  EXPECT_EQ(found.closed, found.manifold && found.border_edges == 0);
  EXPECT_EQ(found.manifold, found.genus >= 0);
}

void expect_islands(const Surface& surface) {
  const std::vector<std::int32_t> found = islands(surface);
  ASSERT_EQ(found.size(), surface.face_count());
  std::int32_t next = 0;
  for (const std::int32_t island : found) {
    EXPECT_LE(island, next);
    next = std::max(next, island + 1);
  }
  EXPECT_GT(next, 0);
}

void expect_curvature(const Surface& surface) {
  const std::vector<double> density = curvature_density(surface);
  EXPECT_EQ(density.size(), surface.vertex_count());
  for (const double value : density) {
    EXPECT_GE(value, 0.0);
    EXPECT_LE(value, 1.0);
  }
}

void fuzz_points(Bytes& bytes, const Surface& surface) {
  std::vector<Vec3> points = take_sites(bytes, surface, bytes.below(40)).positions;
  if (!points.empty() && bytes.one_in(4)) points.back() = points.front();
  if (!points.empty() && bytes.one_in(8)) points[0] = {bytes.wild(), bytes.wild(), bytes.wild()};
  if (const auto away = answer([&] { return away_from_neighbors(points); })) {
    EXPECT_EQ(away->size(), points.size());
    for (const Vec3& direction : *away) EXPECT_LE(direction.norm(), 1.0 + 1e-9);
  }
  const double size = std::sqrt(surface.area()), distance = bytes.one_in(2) ? 0.0 : 1.0;
  std::array<double, 4> eye = {size * bytes.power(-6, 6), -size, 0.5 * size, distance};
  if (bytes.one_in(8)) eye[static_cast<std::size_t>(bytes.below(4))] = bytes.wild();
  if (const auto seen = answer([&] { return seen_from(surface, eye, points); })) {
    EXPECT_EQ(seen->size(), points.size());
    for (const std::uint8_t one : *seen) EXPECT_LE(one, 1);
  }
}

void fuzz_solids(Bytes& bytes, const Surface& surface) {
  std::vector<Vec3> points = take_sites(bytes, surface, bytes.below(40)).positions;
  if (!points.empty() && bytes.one_in(8)) points[0] = {bytes.wild(), bytes.wild(), bytes.wild()};
  std::vector<std::int32_t> counts;
  for (std::size_t left = points.size(); left > 0; left -= static_cast<std::size_t>(counts.back()))
    counts.push_back(1 + static_cast<std::int32_t>(bytes.below(static_cast<int>(left))));
  const Solids solids{points, counts, bytes.one_in(2) ? 0.0 : bytes.power(-6, 2)};
  const std::vector<Vec3> vertices = surface.vertices();
  const std::vector<Face> faces = surface.faces();
  if (const auto reach = answer([&] { return reached_by_solids(vertices, faces, solids); })) {
    EXPECT_EQ(reach->size(), faces.size());
  }
  if (const auto pairs = answer([&] { return touching_solids(solids); })) {
    EXPECT_TRUE(std::is_sorted(pairs->begin(), pairs->end()));
  }
}

/// Where the plane half-way between two sites is all but parallel to a face that it crosses, the
/// rounding of coordinates moves the line in which they meet, for each of the two its own way.
double area_by_flat_bisectors(const Surface& surface, const Sites& sites) {
  const std::vector<Vec3> vertices = surface.vertices();
  const std::vector<Face> faces = surface.faces();
  const auto at = [&](std::int32_t v) -> const Vec3& {
    return vertices[static_cast<std::size_t>(v)];
  };
  double largest = 0.0;
  for (const Vec3& x : vertices) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * largest;
  double result = 0.0;
  for (std::size_t i = 0; i < sites.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 way = (sites.positions[i] - sites.positions[j]).stableNormalized();
      const Vec3 middle = 0.5 * (sites.positions[i] + sites.positions[j]);
      for (const auto& [a, b, c] : faces) {
        const Vec3 sides((at(a) - middle).dot(way), (at(b) - middle).dot(way),
                         (at(c) - middle).dot(way));
        if (!(sides.minCoeff() <= rounding && sides.maxCoeff() >= -rounding)) continue;
        const Vec3 ab = at(b) - at(a), ac = at(c) - at(a);
        const double sine = way.cross(ab.cross(ac).stableNormalized()).norm();
        const double longest = std::max({ab.stableNorm(), ac.stableNorm(), (ac - ab).stableNorm()});
        result += longest * std::min(longest, rounding / sine);
      }
    }
  return result;
}

void fuzz_energy(Bytes& bytes, const Surface& surface) {
  const Sites sites = take_sites(bytes, surface, bytes.below(30));
  const Cells cells = bytes.one_in(2) ? Cells::kConnected : Cells::kEuclidean;
  const double weight = take_option(bytes, {}, 30.0);
  const auto energy = answer([&] { return evaluate_energy(surface, sites, weight, cells); });
  if (!energy) return;
  double area = 0.0;
  for (const Moments& cell : energy->diagram.cells) area += cell.area;
  const double rounding = area_rounding(surface) + area_by_flat_bisectors(surface, sites);
  if (sites.size() > 0) {
    EXPECT_NEAR(area, surface.area(), 1e-10 * surface.area() + rounding);
  }
  test::check_cells(surface, sites, rounding);
  // Squares of capacities end where numbers do.
  if (bytes.was_wild() || std::abs(std::log10(surface.capacity())) > 60.0) return;
  EXPECT_GE(energy->cvt, 0.0);
  for (const Vec3& part : energy->gradient) EXPECT_TRUE(part.allFinite());
}

}  // namespace

void fuzz_surface(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  EXPECT_GT(surface->area(), 0.0);
  EXPECT_GT(surface->capacity(), 0.0);
  expect_topology(topology(*surface));
  expect_islands(*surface);
  expect_curvature(*surface);
  fuzz_projector(bytes, shape, *surface);
  fuzz_energy(bytes, *surface);
  fuzz_points(bytes, *surface);
  fuzz_solids(bytes, *surface);
}

}  // namespace dapple::fuzz
