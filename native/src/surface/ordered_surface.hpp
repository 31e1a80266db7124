// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <dapple/context.hpp>
#include <dapple/moments.hpp>
#include <dapple/surface.hpp>
#include <memory>

#include "base/lazy.hpp"
#include "surface/connectivity.hpp"
#include "surface/ordered_face.hpp"
#include "surface/shading.hpp"

namespace dapple {

/// The data of one face that algorithms need: two cache lines.
struct alignas(64) FaceGeometry {
  Vec3 normal = Vec3::Zero();            ///< unit; zero for a face without area
  Vec3 density_gradient = Vec3::Zero();  ///< of the linear density, in the face's plane
  Vec3 centroid = Vec3::Zero();
  Moments moments;  ///< of the whole face, relative to its centroid
};

class Islands;

/// A surface as the algorithms see it. Faces and vertices have their own order (see Connectivity),
/// which all indices here refer to unless they are called the caller's. Immutable; copies share
/// everything.
class OrderedSurface {
 public:
  /// \throw SurfaceError if there is no area, no density where there is area, or an area that is
  /// not finite; Cancelled
  OrderedSurface(std::span<const Vec3> vertices, Connectivity connectivity, const Density& density,
                 Context* context = nullptr)
      : OrderedSurface(vertices, std::make_shared<const Connectivity>(std::move(connectivity)),
                       density, context) {}
  OrderedSurface(std::span<const Vec3> vertices, std::shared_ptr<const Connectivity> connectivity,
                 const Density& density, Context* context = nullptr);

  /// The same with moved vertices, or another density (both in the caller's order). Geometry is
  /// computed again for faces that differ, and shared for the others. Hard edges stay; given
  /// normals are dropped if vertices move.
  /// \pre as many as before.
  /// \throw SurfaceError as the constructor
  [[nodiscard]] OrderedSurface deformed(std::span<const Vec3> vertices,
                                        Context* context = nullptr) const;
  [[nodiscard]] OrderedSurface with_density(const Density& density,
                                            Context* context = nullptr) const;
  /// The same with other shading; a new surface has no hard edges yet.
  [[nodiscard]] OrderedSurface shaded(std::shared_ptr<const Shading> shading) const;

  /// Whether these are exactly the vertices, in the caller's order.
  [[nodiscard]] bool has_vertices(std::span<const Vec3> vertices) const;

  /// The faces whose corners or densities differ from another's of the same connectivity; sorted.
  [[nodiscard]] std::vector<OrderedFace> changed_faces(const OrderedSurface& before) const;

  [[nodiscard]] std::size_t vertex_count() const { return vertices_->size(); }
  [[nodiscard]] std::size_t face_count() const { return connectivity_->faces.size(); }
  [[nodiscard]] double area() const { return geometry_->area; }
  /// Integral of the density, in the caller's unit.
  [[nodiscard]] double capacity() const { return unit_capacity() / density_unit(); }
  /// Integral of the density times density_unit(), as for faces and cells.
  [[nodiscard]] double unit_capacity() const { return geometry_->unit_capacity; }
  /// The factor of the density in `geometry` and in domains: 1 unless the mean density lies beyond
  /// 2^64 or 2^-64; then a power of two that brings it near 1, so that squares of integrals neither
  /// overflow nor underflow.
  [[nodiscard]] double density_unit() const { return geometry_->density_unit; }

  [[nodiscard]] OrderedFace ordered_face(std::int32_t callers) const {
    return connectivity_->ordered_face[static_cast<std::size_t>(callers)];
  }
  /// The same; for a face that does not count, the face that it lies on.
  [[nodiscard]] OrderedFace counted_face(std::int32_t callers) const {
    const OrderedFace face = ordered_face(callers);
    const DoubledFace* doubled = doubled_face(face);
    return doubled ? doubled->counted : face;
  }
  /// The record of a face that does not count; null if it counts.
  [[nodiscard]] const DoubledFace* doubled_face(OrderedFace face) const;
  [[nodiscard]] bool counts(OrderedFace face) const { return !doubled_face(face); }
  /// Whether a half-edge is the only one of its edge.
  [[nodiscard]] bool is_border(std::int32_t half_edge) const {
    return next_around(half_edge) == half_edge && counts(face_of(half_edge));
  }
  [[nodiscard]] std::int32_t original_face(OrderedFace face) const {
    return connectivity_->original_face[as_index(face)];
  }
  [[nodiscard]] const Face& corners(OrderedFace face) const {
    return connectivity_->faces[as_index(face)];
  }
  [[nodiscard]] const Vec3& vertex(std::int32_t vertex) const {
    return (*vertices_)[static_cast<std::size_t>(vertex)];
  }
  /// The density at the corners of a face; it is linear in between.
  [[nodiscard]] Vec3 densities(OrderedFace face) const;
  [[nodiscard]] const FaceGeometry& geometry(OrderedFace face) const {
    return first_geometry_[as_index(face) / kBlock][as_index(face) % kBlock];
  }
  /// The point of a face with these barycentric coordinates.
  [[nodiscard]] Vec3 point(OrderedFace face, const Vec3& weights) const {
    const auto [a, b, c] = corners(face);
    return weights[0] * vertex(a) + weights[1] * vertex(b) + weights[2] * vertex(c);
  }
  /// Prefetch the data of a face.
  void prefetch(OrderedFace face) const {
#if defined(__GNUC__)
    const auto* bytes = reinterpret_cast<const char*>(&geometry(face));
    for (std::size_t byte = 0; byte < sizeof(FaceGeometry); byte += 64)
      __builtin_prefetch(bytes + byte);
    __builtin_prefetch(&connectivity_->faces[as_index(face)]);
#else
    static_cast<void>(face);
#endif
  }
  /// Sets of faces connected over edges; `component(face)` is in 0..components() - 1.
  [[nodiscard]] std::int32_t components() const { return connectivity_->components; }
  [[nodiscard]] std::int32_t component(OrderedFace face) const {
    return connectivity_->component[as_index(face)];
  }
  /// The body that a face is of (see Joints::bodies); 0 if there is one alone.
  [[nodiscard]] std::int32_t body(OrderedFace face) const {
    return connectivity_->body.empty() ? 0 : connectivity_->body[as_index(face)];
  }
  /// The lowest vertex of the welded group of a vertex.
  [[nodiscard]] std::int32_t welded(std::int32_t vertex) const {
    return connectivity_->welded_vertex[static_cast<std::size_t>(vertex)];
  }
  /// The corners of a face as welded vertices.
  [[nodiscard]] Face welded_corners(OrderedFace face) const {
    const auto [a, b, c] = corners(face);
    return {welded(a), welded(b), welded(c)};
  }
  /// The next half-edge around the edge of `half_edge` (see half_edge()):
  /// the other side of an inner edge, itself on a border, the next of a ring where three or more
  /// faces meet.
  [[nodiscard]] std::int32_t next_around(std::int32_t half_edge) const {
    return connectivity_->next_around_edge[static_cast<std::size_t>(half_edge)];
  }

  [[nodiscard]] const Connectivity& connectivity() const { return *connectivity_; }
  [[nodiscard]] std::shared_ptr<const Connectivity> shared_connectivity() const {
    return connectivity_;
  }
  /// See islands_of().
  [[nodiscard]] Lazy<Islands>& islands() const { return *geometry_->islands; }
  [[nodiscard]] const Shading& shading() const { return *shading_; }
  [[nodiscard]] const std::vector<Vec3>& vertices() const { return *vertices_; }
  [[nodiscard]] DensityAt density_at() const { return density_->at; }
  [[nodiscard]] const std::vector<double>& density() const { return density_->values; }

 private:
  struct Values {
    DensityAt at = DensityAt::kVertices;
    std::vector<double> values;  // empty if uniform
  };
  static constexpr std::size_t kBlock = 1024;  // faces; a power of two
  /// A run of faces.
  struct Block {
    std::vector<FaceGeometry> faces;  // of the density times the unit
    // Of the faces, side by side: they are added up in order, and their geometry is far apart.
    std::vector<double> areas, capacities;
  };
  struct Geometry {
    std::vector<std::shared_ptr<const Block>> blocks;
    std::vector<const FaceGeometry*> first;  // per block
    double area = 0.0;
    double unit_capacity = 0.0;
    double density_unit = 1.0;
    std::shared_ptr<Lazy<Islands>> islands = std::make_shared<Lazy<Islands>>();
  };

  void place_density(const Density& density);
  void measure(const OrderedSurface* before, Context* context);
  [[nodiscard]] std::shared_ptr<const Block> measure_block(std::size_t block, double unit) const;
  [[nodiscard]] bool differs(OrderedFace face, const OrderedSurface& before) const;
  [[nodiscard]] bool block_differs(std::size_t block, const OrderedSurface& before) const;
  [[nodiscard]] double find_density_unit() const;
  static void check(const Geometry& geometry);

  std::shared_ptr<const Connectivity> connectivity_;
  std::shared_ptr<const std::vector<Vec3>> vertices_;
  std::shared_ptr<const Values> density_;
  std::shared_ptr<const Geometry> geometry_;
  std::shared_ptr<const Shading> shading_;
  const FaceGeometry* const* first_geometry_ = nullptr;  // per block
};

/// The lowest half-edge of an edge, which stands for it.
[[nodiscard]] inline std::int32_t edge_of(const OrderedSurface& mesh, std::int32_t half_edge) {
  std::int32_t lowest = half_edge;
  for (std::int32_t g = mesh.next_around(half_edge); g != half_edge; g = mesh.next_around(g))
    lowest = std::min(lowest, g);
  return lowest;
}

/// The length of a half-edge.
[[nodiscard]] inline double edge_length(const OrderedSurface& mesh, std::int32_t half_edge) {
  const Face& corners = mesh.corners(face_of(half_edge));
  const auto corner = [&](std::int32_t k) { return corners[static_cast<std::size_t>(k % 3)]; };
  return (mesh.vertex(corner(half_edge)) - mesh.vertex(corner(half_edge + 1))).stableNorm();
}

/// The indices of a density's values in the caller's order, and how many go together.
struct DensityLayout {
  const std::vector<std::int32_t>& order;
  std::size_t width;
};
[[nodiscard]] DensityLayout density_layout(const Connectivity& mesh, DensityAt at);

}  // namespace dapple
