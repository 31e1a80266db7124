// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/surface_record.hpp>
#include <string>

#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

void check_length(const char* name, std::size_t length, std::size_t needed) {
  if (length != needed)
    throw ArgumentError(std::string(name) + " has " + std::to_string(length) +
                        " entries: " + std::to_string(needed) + " are needed");
}

void check_indices(const char* name, std::span<const std::int32_t> indices, std::size_t count) {
  for (std::size_t k = 0; k < indices.size(); ++k)
    if (indices[k] < 0 || static_cast<std::size_t>(indices[k]) >= count)
      throw ArgumentError(entry(name, k) + " is " + std::to_string(indices[k]) +
                          ": it must be in 0.." + std::to_string(count) + " - 1");
}

/// Checks that each index occurs once, so that every walk along the ring returns to its start.
void check_permutation(const char* name, std::span<const std::int32_t> indices, std::size_t count) {
  check_length(name, indices.size(), count);
  check_indices(name, indices, count);
  std::vector<bool> seen(count, false);
  for (std::size_t k = 0; k < count; ++k) {
    if (seen[static_cast<std::size_t>(indices[k])])
      throw ArgumentError(entry(name, k) + " is " + std::to_string(indices[k]) +
                          ", like an earlier entry: they must differ");
    seen[static_cast<std::size_t>(indices[k])] = true;
  }
}

std::vector<DoubledFace> doubled_of(const MeshRecord& record) {
  std::vector<DoubledFace> result;
  for (std::size_t k = 0; k < record.doubled.size(); ++k) {
    const auto& [face, counted, a, b, c] = record.doubled[k];
    const std::array<std::int32_t, 2> faces = {face, counted};
    const std::array<std::int32_t, 3> corners = {a, b, c};
    check_indices("doubled", faces, record.faces.size());
    check_indices("doubled", corners, 3);
    result.push_back({OrderedFace{face},
                      OrderedFace{counted},
                      {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b),
                       static_cast<std::uint8_t>(c)}});
    if (k > 0 && !(result[k - 1].face < result[k].face))
      throw ArgumentError(entry("doubled", k) + " is out of order");
  }
  return result;
}

void check_record(const MeshRecord& record) {
  const std::size_t faces = record.faces.size(), vertices = record.original_vertex.size();
  check_permutation("original_vertex", record.original_vertex, vertices);
  check_permutation("original_face", record.original_face, faces);
  check_permutation("next_around_edge", record.next_around_edge, 3 * faces);
  check_faces(record.faces, vertices);
  check_length("welded_vertex", record.welded_vertex.size(), vertices);
  check_indices("welded_vertex", record.welded_vertex, vertices);
  check_length("component", record.component.size(), faces);
  check_indices("component", record.component, faces);
  if (!record.body.empty()) check_length("body", record.body.size(), faces);
}

}  // namespace

MeshRecord record_of(const Connectivity& mesh) {
  MeshRecord record{mesh.weld,
                    mesh.merge_doubled,
                    mesh.faces,
                    mesh.original_face,
                    mesh.original_vertex,
                    mesh.next_around_edge,
                    mesh.welded_vertex,
                    mesh.component,
                    mesh.body,
                    {}};
  for (const DoubledFace& one : mesh.doubled)
    record.doubled.push_back({static_cast<std::int32_t>(one.face),
                              static_cast<std::int32_t>(one.counted), one.corners[0],
                              one.corners[1], one.corners[2]});
  return record;
}

std::shared_ptr<const Connectivity> restored(MeshRecord record) {
  check_record(record);
  auto mesh = std::make_shared<Connectivity>();
  mesh->doubled = doubled_of(record);
  mesh->weld = record.weld;
  mesh->merge_doubled = record.merge_doubled;
  mesh->faces = std::move(record.faces);
  mesh->original_face = std::move(record.original_face);
  mesh->original_vertex = std::move(record.original_vertex);
  mesh->next_around_edge = std::move(record.next_around_edge);
  mesh->welded_vertex = std::move(record.welded_vertex);
  mesh->component = std::move(record.component);
  mesh->body = std::move(record.body);
  mesh->ordered_face.resize(mesh->faces.size());
  for (std::size_t f = 0; f < mesh->faces.size(); ++f) {
    mesh->ordered_face[static_cast<std::size_t>(mesh->original_face[f])] = nth_face(f);
    mesh->components = std::max(mesh->components, mesh->component[f] + 1);
  }
  return mesh;
}

SurfaceRecord record_of(const Surface& surface) {
  const OrderedSurface& mesh = surface.ordered();
  return {mesh.shared_connectivity(), surface.vertices(),  surface.density_at(), surface.density(),
          surface.sharp_angle(),      mesh.shading().hard, mesh.shading().given};
}

Surface restored(const SurfaceRecord& record, Context* context) {
  const std::size_t vertices = record.connectivity->original_vertex.size();
  const std::size_t faces = record.connectivity->faces.size();
  check_length("vertices", record.vertices.size(), vertices);
  check_finite<SurfaceError>("vertices", record.vertices);
  check_length("hard_edges", record.hard_edges.size(), faces);
  if (!record.normals.empty()) check_length("normals", record.normals.size(), 3 * faces);
  check_finite<SurfaceError>("normals", record.normals);
  const OrderedSurface plain(record.vertices, record.connectivity, Density{}, context);
  const Surface shaded(std::make_shared<const OrderedSurface>(plain.shaded(
      std::make_shared<Shading>(Shading{record.sharp_angle, record.hard_edges, record.normals}))));
  return shaded.with_density({record.density_at, record.density}, context);
}

}  // namespace dapple
