// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/remesh.hpp>
#include <dapple/topology.hpp>
#include <set>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr std::size_t kCount = 600;

double capacity_of(const Surface& surface, std::size_t count) {
  return surface.capacity() / static_cast<double>(count);
}

/// The remesh of a surface, and of one that follows it.
struct Sequence {
  Surface before, next;
  RemeshResult first = {};
  NextRemesh then = {};

  Sequence(const Surface& one, const Surface& other, std::size_t count = kCount)
      : before(one), next(other), first(remesh(one, count)) {
    then = remesh_next(before, first, next, capacity_of(before, count));
  }

  [[nodiscard]] bool stays(std::size_t k, double tolerance = 1e-9) const {
    const std::int32_t v = then.previous[k];
    return v >= 0 && (first.vertices[static_cast<std::size_t>(v)] - then.mesh.vertices[k]).norm() <=
                         tolerance;
  }
  [[nodiscard]] std::size_t staying() const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < then.previous.size(); ++k) count += stays(k) ? 1 : 0;
    return count;
  }
};

void expect_consistent(const Surface& surface, const RemeshResult& before, const NextRemesh& next) {
  const RemeshResult& mesh = next.mesh;
  ASSERT_EQ(next.previous.size(), mesh.vertices.size());
  EXPECT_LE(next.kept, mesh.vertices.size());
  std::set<std::int32_t> used;
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const Vec3 there = surface.point(mesh.source_faces[k], mesh.barycentric[k]);
    EXPECT_LE((there - mesh.vertices[k]).norm(), 1e-9 * surface.spacing(1));
    if (next.previous[k] < 0) continue;
    EXPECT_LT(static_cast<std::size_t>(next.previous[k]), before.vertices.size());
    EXPECT_TRUE(used.insert(next.previous[k]).second);
  }
}

class RemeshNextShapes : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(All, RemeshNextShapes, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(RemeshNextShapes, KeepsAllVerticesOfTheSameSurface) {
  const Surface surface = GetParam().surface();
  const Sequence made(surface, surface, 150);
  expect_consistent(surface, made.first, made.then);
  if (GetParam().name.starts_with("ZeroAreaFaces")) return;
  EXPECT_EQ(made.then.mesh.report.flaws, 0u);
  EXPECT_GE(made.staying(), made.first.vertices.size());
}

TEST(RemeshNext, KeepsVerticesUnderOtherFaces) {
  const Sequence made(box(4).surface(), box(7).surface());
  EXPECT_EQ(made.staying(), kCount);
  EXPECT_EQ(made.then.kept, kCount);
  EXPECT_EQ(made.then.mesh.report.corners, 8u);
}

Shape bumpy_grid() {
  return mapped(grid(30), [](const Vec3& p) {
    const double x = std::max(p[0] - 0.5, 0.0), y = p[1] - 0.5;
    return Vec3(p[0], p[1], 2.0 * x * x * std::exp(-20.0 * y * y));
  });
}

TEST(RemeshNext, MovesOnlyWhatHasChanged) {
  const Sequence made(grid(30).surface(), bumpy_grid().surface());
  expect_consistent(made.next, made.first, made.then);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < made.then.previous.size(); ++k) {
    const Vec3& place = made.then.mesh.vertices[k];
    if (place[0] < 0.35) {
      EXPECT_TRUE(made.stays(k)) << place.transpose();
    }
    kept += made.stays(k) ? 1 : 0;
  }
  EXPECT_GT(kept, kCount / 3);
  EXPECT_GE(made.then.kept, kCount / 3);
  const double wanted = static_cast<double>(kCount) * made.next.area() / made.before.area();
  EXPECT_NEAR(static_cast<double>(made.then.mesh.vertices.size()), wanted, 0.02 * wanted);
  EXPECT_GT(made.then.mesh.report.smallest_angle, 25.0);
  EXPECT_GT(made.then.mesh.report.mean_smallest_angle, 50.0);
}

TEST(RemeshNext, FillsASurfaceThatAppears) {
  const Shape other =
      mapped(icosphere(3), [](const Vec3& p) { return Vec3(p[0] + 3.0, p[1], p[2]); });
  const Sequence made(icosphere(3).surface(), joined(icosphere(3), other).surface());
  EXPECT_EQ(made.staying(), kCount);
  EXPECT_NEAR(static_cast<double>(made.then.mesh.vertices.size()), 2.0 * kCount, 2.0);
  EXPECT_EQ(std::ranges::count(made.then.previous, -1),
            static_cast<std::ptrdiff_t>(made.then.mesh.vertices.size() - kCount));
  EXPECT_EQ(made.then.mesh.report.euler, 4);
  EXPECT_EQ(made.then.mesh.report.flaws, 0u);
  EXPECT_GT(made.then.mesh.report.smallest_angle, 30.0);
}

TEST(RemeshNext, DropsVerticesOfASurfaceThatIsGone) {
  const Shape other =
      mapped(icosphere(3), [](const Vec3& p) { return Vec3(p[0] + 3.0, p[1], p[2]); });
  const Sequence made(joined(icosphere(3), other).surface(), other.surface(), 2 * kCount);
  EXPECT_EQ(made.then.mesh.report.euler, 2);
  EXPECT_EQ(made.staying(), made.then.mesh.vertices.size());
  EXPECT_NEAR(static_cast<double>(made.then.mesh.vertices.size()), 1.0 * kCount, 20.0);
}

TEST(RemeshNext, FindsTheTopologyOfATornSurface) {
  Shape torn = grid(30);
  std::erase_if(torn.faces, [&](const Face& face) {
    const Vec3& p = torn.vertices[static_cast<std::size_t>(face[0])];
    return (p - Vec3(0.7, 0.5, 0.0)).norm() < 0.15;
  });
  const Sequence made(grid(30).surface(), torn.surface());
  EXPECT_EQ(made.then.mesh.report.euler, 0);
  EXPECT_EQ(made.then.mesh.report.border_loops, 2);
  EXPECT_EQ(made.then.mesh.report.flaws, 0u);
  for (std::size_t k = 0; k < made.then.previous.size(); ++k)
    if (made.then.mesh.vertices[k][0] < 0.4) {
      EXPECT_TRUE(made.stays(k));
    }
}

TEST(RemeshNext, StartsAnewWhereNothingIsLeft) {
  const Shape far =
      mapped(icosphere(3), [](const Vec3& p) { return Vec3(p[0] + 50.0, p[1], p[2]); });
  const Sequence made(icosphere(3).surface(), far.surface());
  EXPECT_EQ(made.then.mesh.vertices.size(), kCount);
  EXPECT_EQ(made.then.kept, 0u);
  EXPECT_EQ(std::ranges::count(made.then.previous, -1), static_cast<std::ptrdiff_t>(kCount));
}

TEST(RemeshNext, StartsAnewAfterAMeshWithoutTriangles) {
  const Surface surface = icosphere(2).surface();
  const NextRemesh found = remesh_next(surface, {}, surface, capacity_of(surface, 100));
  EXPECT_EQ(found.mesh.vertices.size(), 100u);
  EXPECT_EQ(found.kept, 0u);
}

TEST(RemeshNext, ComesToNoMoreVerticesOverManyFrames) {
  const Surface surface = grid(30).surface(), other = bumpy_grid().surface();
  const double capacity = capacity_of(surface, kCount);
  RemeshResult mesh = remesh(surface, kCount);
  const Surface* now = &surface;
  for (int frame = 0; frame < 12; ++frame) {
    const Surface* next = now == &surface ? &other : &surface;
    mesh = remesh_next(*now, mesh, *next, capacity).mesh;
    now = next;
    EXPECT_EQ(mesh.report.flaws, 0u);
  }
  EXPECT_NEAR(static_cast<double>(mesh.vertices.size()), 1.0 * kCount, 8.0);
  EXPECT_GT(mesh.report.mean_smallest_angle, 50.0);
}

TEST(RemeshNext, RefusesWhatItCannotContinue) {
  const Surface surface = icosphere(2).surface(), small = icosphere(1).surface();
  const RemeshResult mesh = remesh(surface, 100);
  const auto next = [&](double capacity, const RemeshOptions& options) {
    return remesh_next(surface, mesh, surface, capacity, options);
  };
  expect_message<ArgumentError>([&] { next(0.0, {}); }, {"capacity is 0: it must be > 0"});
  RemeshOptions options;
  options.adaptive = true;
  expect_message<ArgumentError>([&] { next(0.1, options); }, {"adaptive is on"});
  options = {};
  options.non_manifold = NonManifold::kCut;
  expect_message<ArgumentError>([&] { next(0.1, options); }, {"non_manifold is cut"});
  expect_message<ArgumentError>([&] { static_cast<void>(remesh_next(small, mesh, surface, 0.1)); },
                                {"mesh is not of the surface before"});
  RemeshResult broken = mesh;
  broken.faces[3][1] = 100;
  expect_message<ArgumentError>(
      [&] { static_cast<void>(remesh_next(surface, broken, surface, 0.1)); },
      {"mesh has 100 in its faces: it must be in 0..100 - 1"});
}

}  // namespace
}  // namespace dapple::test
