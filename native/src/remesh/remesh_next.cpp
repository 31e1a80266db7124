// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/remesh.hpp>
#include <span>

#include "base/progress.hpp"
#include "base/validate.hpp"
#include "remesh/best_remesh.hpp"
#include "remesh/carried_sites.hpp"
#include "sample/timed_call.hpp"

namespace dapple {
namespace {

constexpr double kCarried = 0.2;  // of the progress

/// \throw ArgumentError naming the first index out of range
void check_indices(std::span<const std::int32_t> indices, std::size_t end, const char* name) {
  for (const std::int32_t index : indices)
    if (index < 0 || as_index(index) >= end)
      throw ArgumentError("mesh has " + std::to_string(index) + " in its " + name +
                          ": it must be in 0.." + std::to_string(end) + " - 1");
}

void check(const Surface& before, const RemeshResult& mesh) {
  const std::size_t count = mesh.vertices.size();
  if (mesh.source_faces.size() != count || mesh.barycentric.size() != count ||
      mesh.features.size() != count)
    throw ArgumentError("mesh has arrays of different lengths");
  for (const Face& face : mesh.faces) check_indices(face, count, "faces");
  for (const auto& line : mesh.lines) check_indices(line, count, "lines");
  for (std::size_t k = 0; k < count; ++k)
    if (mesh.source_faces[k] < 0 || as_index(mesh.source_faces[k]) >= before.face_count())
      throw ArgumentError("mesh is not of the surface before: vertex " + std::to_string(k) +
                          " lies on face " + std::to_string(mesh.source_faces[k]) + " of " +
                          std::to_string(before.face_count()));
}

void check(double capacity, const RemeshOptions& options) {
  check_options(options);
  if (options.adaptive)
    throw ArgumentError("adaptive is on: a sequence keeps the density of its first mesh");
  if (options.non_manifold == NonManifold::kCut)
    throw ArgumentError("non_manifold is cut: the meshes of a sequence are not cut apart");
  if (!(capacity > 0.0 && std::isfinite(capacity)))
    throw ArgumentError("capacity is " + number(capacity) + ": it must be > 0");
}

/// The number of vertices of that capacity.
std::size_t count_for(const Surface& surface, double capacity) {
  const double wanted = std::max(std::round(surface.capacity() / capacity), 1.0);
  if (!(wanted <= static_cast<double>(kMostSamples)))
    throw ArgumentError("capacity is " + number(capacity) + ": the surface needs more than " +
                        std::to_string(kMostSamples) + " vertices");
  return static_cast<std::size_t>(wanted);
}

NextRemesh remeshed(const Surface& before, const RemeshResult& mesh, const Surface& next,
                    double capacity, const RemeshOptions& options, Context* context) {
  Stretch carrying(context, 0.0, kCarried), solving(context, kCarried, 1.0);
  const std::size_t count = count_for(next, capacity);
  const FeatureLines lines(next, rules_of(next, count, options), context);
  CarriedSites carried;
  if (!mesh.vertices.empty())
    carried = carry_sites(before, mesh, {next, lines, capacity, line_spacing(next, lines, count)},
                          options, carrying.context());
  const std::size_t asked = carried.sites.size() > 0 ? carried.sites.size() : count;
  TracedMesh made = best_remesh(next, asked, options, lines,
                                {.given = std::move(carried.sites), .kept = KeptTriangles(mesh)},
                                solving.context());
  NextRemesh result{std::move(made.mesh), {}, 0};
  result.mesh.report.evaluations += carried.evaluations;
  for (const Origin& origin : made.origins) {
    result.previous.push_back(origin.vertex);
    if (origin.stays) ++result.kept;
  }
  return result;
}

}  // namespace

NextRemesh remesh_next(const Surface& before, const RemeshResult& mesh, const Surface& next,
                       double capacity, const RemeshOptions& options, Context* context) {
  TimedCall call(context);
  check(capacity, options);
  check(before, mesh);
  if (context) context->check();
  NextRemesh result = with_threads(options.threads, [&] {
    return remeshed(before, mesh, next, capacity, options, call.context());
  });
  call.write(result.mesh.report);
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
