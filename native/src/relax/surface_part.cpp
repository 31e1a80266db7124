// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax/surface_part.hpp"

#include <algorithm>
#include <unordered_set>

#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// The vertices of faces; sorted.
std::vector<std::int32_t> vertices_of(const OrderedSurface& mesh,
                                      std::span<const OrderedFace> faces) {
  std::vector<std::int32_t> result;
  for (const OrderedFace face : faces)
    for (const std::int32_t v : mesh.corners(face)) result.push_back(v);
  sort_unique(result);
  return result;
}

Surface cut_out(const Surface& whole, std::span<const OrderedFace> faces, Context* context) {
  const OrderedSurface& mesh = whole.ordered();
  const std::vector<std::int32_t> vertices = vertices_of(mesh, faces);
  std::vector<Vec3> positions;
  std::vector<std::int32_t> places, edges;
  for (const std::int32_t v : vertices) {
    positions.push_back(mesh.vertex(v));
    places.push_back(mesh.welded(v));
  }
  std::vector<Face> corners;
  std::vector<double> densities;
  for (const OrderedFace face : faces) {
    check_at(corners.size());
    const Vec3 density = mesh.densities(face);
    for (std::int32_t k = 0; k < 3; ++k) {
      edges.push_back(edge_of(mesh, half_edge(face, k)));
      if (!whole.uniform()) densities.push_back(density[k]);
    }
    Face& local = corners.emplace_back(mesh.corners(face));
    for (std::int32_t& v : local)
      v = static_cast<std::int32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                    vertices.begin());
  }
  return {positions,
          corners,
          Density{DensityAt::kCorners, densities},
          Joints{edges, places},
          whole.sharp_angle(),
          /*merge_doubled=*/false,
          context};
}

/// Walks over faces outside a set, starting at its rim, and distinguishes holes from the rest of
/// the surface.
class Holes {
 public:
  Holes(const OrderedSurface& mesh, const std::vector<OrderedFace>& faces, std::size_t most)
      : mesh_(mesh), faces_(faces), most_(most) {}

  std::vector<OrderedFace> find() {
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      check_at(f, 512);
      for_each_beside(faces_[f], [this](OrderedFace other) { walk_from(other); });
    }
    return std::move(holes_);
  }

 private:
  template <typename Visit>
  void for_each_beside(OrderedFace face, const Visit& visit) const {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = half_edge(face, k);
      for (std::int32_t g = mesh_.next_around(h); g != h; g = mesh_.next_around(g))
        visit(face_of(g));
    }
  }

  [[nodiscard]] bool is_inside(OrderedFace face) const {
    return std::binary_search(faces_.begin(), faces_.end(), face);
  }

  void walk_from(OrderedFace start) {
    if (is_inside(start) || seen_.contains(as_index(start))) return;
    std::vector<OrderedFace> walked = {start};
    seen_.insert(as_index(start));
    bool closed = true;
    for (std::size_t k = 0; closed && k < walked.size() && walked.size() <= most_; ++k)
      for_each_beside(walked[k], [&](OrderedFace other) {
        if (is_inside(other)) return;
        if (seen_.insert(as_index(other)).second)
          walked.push_back(other);
        else
          closed = closed && std::find(walked.begin(), walked.end(), other) != walked.end();
      });
    if (closed && walked.size() <= most_) holes_.insert(holes_.end(), walked.begin(), walked.end());
  }

  const OrderedSurface& mesh_;
  const std::vector<OrderedFace>& faces_;
  std::size_t most_;
  std::unordered_set<std::size_t> seen_;
  std::vector<OrderedFace> holes_;
};

}  // namespace

SurfacePart::SurfacePart(const Surface& whole, std::span<const OrderedFace> faces, Context* context)
    : surface_(cut_out(whole, faces, context)), inside_(whole.face_count(), -1) {
  for (const OrderedFace face : faces) {
    check_at(outside_.size());
    const std::int32_t callers = whole.ordered().original_face(face);
    inside_[static_cast<std::size_t>(callers)] = static_cast<std::int32_t>(outside_.size());
    outside_.push_back(callers);
  }
}

std::vector<OrderedFace> without_holes(const Surface& surface, std::vector<OrderedFace> faces,
                                       std::size_t most) {
  const std::vector<OrderedFace> holes = Holes(surface.ordered(), faces, most).find();
  faces.insert(faces.end(), holes.begin(), holes.end());
  std::sort(faces.begin(), faces.end());
  return faces;
}

std::shared_ptr<const SurfaceDomain> domain_of(const Surface& part) {
  return std::make_shared<const SurfaceDomain>(part, Cells::kConnected, /*sides=*/nullptr,
                                               EmptyFaces::kLeft);
}

}  // namespace dapple
