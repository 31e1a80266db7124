// SPDX-License-Identifier: GPL-3.0-or-later
#include "invariants.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <dapple/restricted_voronoi.hpp>
#include <set>

namespace dapple::test {
namespace {

template <typename T>
bool equal_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

double largest_coordinate(const Surface& surface) {
  double size = 0.0;
  for (const Vec3& p : surface.vertices()) size = std::max(size, p.cwiseAbs().maxCoeff());
  return size;
}

void check_arrays(const Samples& samples) {
  const std::size_t count = samples.size();
  EXPECT_EQ(samples.normals.size(), count);
  EXPECT_EQ(samples.faces.size(), count);
  EXPECT_EQ(samples.barycentric.size(), count);
  EXPECT_EQ(samples.ids.size(), count);
  EXPECT_EQ(samples.classes.size(), count);
  EXPECT_EQ(samples.report.count, count);
  for (std::size_t k = 0; k < samples.normals.size(); ++k)
    EXPECT_NEAR(samples.normals[k].norm(), 1.0, 1e-12) << "normals[" << k << "]";
  const std::set<std::int32_t> ids(samples.ids.begin(), samples.ids.end());
  EXPECT_EQ(ids.size(), count) << "ids repeat";
}

}  // namespace

void check_on_surface(const Surface& surface, const Sites& sites,
                      const std::vector<Vec3>& weights) {
  ASSERT_EQ(sites.faces.size(), sites.positions.size());
  ASSERT_EQ(weights.size(), sites.positions.size());
  const double rounding = 1e-13 * largest_coordinate(surface);
  for (std::size_t k = 0; k < sites.size(); ++k) {
    ASSERT_GE(sites.faces[k], 0) << "faces[" << k << "]";
    ASSERT_LT(sites.faces[k], static_cast<std::int32_t>(surface.face_count()))
        << "faces[" << k << "]";
    ASSERT_GE(weights[k].minCoeff(), 0.0) << "barycentric[" << k << "]";
    ASSERT_NEAR(weights[k].sum(), 1.0, 1e-14) << "barycentric[" << k << "]";
    const Vec3 there = surface.point(sites.faces[k], weights[k]);
    ASSERT_LE((there - sites.positions[k]).norm(), rounding)
        << "positions[" << k << "] is off its face";
  }
}

void check_cells(const Surface& surface, const Sites& sites, double rounding) {
  double area = 0.0, capacity = 0.0;
  for (const Moments& cell : restricted_voronoi(surface, sites, Cells::kEuclidean).cells) {
    EXPECT_GE(cell.area, 0.0);
    EXPECT_GE(cell.capacity, 0.0);
    area += cell.area;
    capacity += cell.capacity;
  }
  if (sites.size() == 0) return;
  const std::vector<double> densities = surface.density();
  const double densest =
      densities.empty() ? 1.0 : *std::max_element(densities.begin(), densities.end());
  EXPECT_NEAR(area, surface.area(), 1e-10 * surface.area() + rounding) << sites.size() << " sites";
  EXPECT_NEAR(capacity, surface.capacity(), 1e-10 * surface.capacity() + rounding * densest)
      << sites.size() << " sites";
}

void check(const Surface& surface, const Samples& samples, double rounding) {
  check_arrays(samples);
  const Sites sites = sites_of(samples);
  check_on_surface(surface, sites, samples.barycentric);
  check_cells(surface, sites, rounding);
}

bool is_where_dense(const Surface& surface, std::int32_t face, const Vec3& weights) {
  if (surface.uniform()) return true;
  const std::vector<double> values = surface.density();
  const auto f = static_cast<std::size_t>(face);
  if (surface.density_at() == DensityAt::kFaces) return values[f] > 0.0;
  const double most = *std::max_element(values.begin(), values.end());  // avoids underflow
  const Face corners = surface.faces()[f];
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool at_vertices = surface.density_at() == DensityAt::kVertices;
    const std::size_t at = at_vertices ? static_cast<std::size_t>(corners[k]) : 3 * f + k;
    sum += weights[static_cast<Eigen::Index>(k)] * (values[at] / most);
  }
  return sum > 0.0;
}

void check_where_dense(const Surface& surface, const Samples& samples,
                       std::span<const std::int32_t> locked) {
  for (std::size_t k = 0; k < samples.size() && !surface.uniform(); ++k)
    if (std::find(locked.begin(), locked.end(), samples.ids[k]) == locked.end()) {
      EXPECT_TRUE(is_where_dense(surface, samples.faces[k], samples.barycentric[k]))
          << "sample " << k << " is where the density is 0";
    }
}

bool same_bytes(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return equal_bytes(a, b);
}

bool same_bytes(const Samples& a, const Samples& b) {
  return equal_bytes(a.positions, b.positions) && equal_bytes(a.normals, b.normals) &&
         equal_bytes(a.faces, b.faces) && equal_bytes(a.barycentric, b.barycentric) &&
         equal_bytes(a.ids, b.ids) && equal_bytes(a.classes, b.classes) &&
         equal_bytes(a.report.energies, b.report.energies);
}

Sites sites_of(const Samples& samples) { return {samples.positions, samples.faces}; }

}  // namespace dapple::test
