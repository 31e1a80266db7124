// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <dapple/remesh.hpp>
#include <dapple/topology.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

constexpr double kMostVerticesNext = 200.0;  // other surfaces may be far larger

RemeshOptions take_remesh_options(Bytes& bytes, const Surface& surface) {
  RemeshOptions options;
  take_options(bytes, options);
  options.optimizer.max_evaluations = std::min(options.optimizer.max_evaluations, 5);
  if (bytes.one_in(3)) {
    const std::vector<Face> faces = surface.faces();
    const std::size_t face = take_count(bytes) % faces.size();
    options.edges.push_back({faces[face][0], faces[face][1]});
  }
  return options;
}

void expect_mesh(const Surface& surface, const RemeshResult& mesh) {
  const std::size_t count = mesh.vertices.size();
  ASSERT_EQ(mesh.source_faces.size(), count);
  ASSERT_EQ(mesh.barycentric.size(), count);
  for (std::size_t k = 0; k < count; ++k) {
    EXPECT_TRUE(mesh.vertices[k].allFinite());
    EXPECT_LT(static_cast<std::size_t>(mesh.source_faces[k]), surface.face_count());
    EXPECT_GE(mesh.barycentric[k].minCoeff(), 0.0);
  }
  for (const Face& face : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(static_cast<std::size_t>(face[k]), count);
      EXPECT_NE(face[k], face[(k + 1) % 3]);
    }
  EXPECT_TRUE(mesh.density.empty() || mesh.density.size() == 3 * surface.face_count());
  for (const double value : mesh.density) EXPECT_TRUE(std::isfinite(value) && value >= 0.0);
  const Topology before = topology(surface);
  if (mesh.report.flaws > 0 || !before.manifold) return;
  EXPECT_EQ(mesh.report.nonmanifold_edges, 0u);
  EXPECT_EQ(mesh.report.euler, 2 * before.components - 2 * before.genus - before.border_loops);
}

/// The mesh of another surface after this one.
void expect_next(const Surface& before, const RemeshResult& mesh, std::size_t count,
                 RemeshOptions options, Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  options.edges.clear();
  const double capacity = std::max(before.capacity() / static_cast<double>(count),
                                   surface->capacity() / kMostVerticesNext);
  const auto made = answer_of_threads([&](int threads) {
    options.threads = threads;
    return remesh_next(before, mesh, *surface, capacity, options);
  });
  if (!made) return;
  expect_mesh(*surface, made->mesh);
  ASSERT_EQ(made->previous.size(), made->mesh.vertices.size());
  for (const std::int32_t vertex : made->previous)
    EXPECT_TRUE(vertex >= -1 && vertex < static_cast<std::int32_t>(mesh.vertices.size()));
}

}  // namespace

void fuzz_remesh(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  RemeshOptions options = take_remesh_options(bytes, *surface);
  const std::size_t count = take_count(bytes);
  const auto made = answer_of_threads([&](int threads) {
    options.threads = threads;
    return remesh(*surface, count, options);
  });
  if (!made) return;
  expect_mesh(*surface, *made);
  if (bytes.one_in(2)) expect_next(*surface, *made, count, options, bytes);
}

}  // namespace dapple::fuzz
