// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax/surface_part.hpp"

#include <algorithm>
#include <limits>
#include <unordered_set>

#include "base/progress.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::int32_t kNone = -1;

/// The vertices of faces, numbered in the order of the whole surface.
class PartVertices {
 public:
  PartVertices(const OrderedSurface& mesh, std::span<const OrderedFace> faces)
      : number_(mesh.vertex_count(), kNone), first_(mesh.vertex_count(), kNone) {
    for (const OrderedFace face : faces)
      for (const std::int32_t v : mesh.corners(face)) number_[as_index(v)] = 0;
    for (std::size_t v = 0; v < number_.size(); ++v) {
      check_at(v);
      if (number_[v] != kNone) add(mesh, static_cast<std::int32_t>(v));
    }
  }

  [[nodiscard]] std::int32_t number(std::int32_t vertex) const { return number_[as_index(vertex)]; }
  [[nodiscard]] const std::vector<Vec3>& positions() const { return positions_; }
  /// Per vertex, the first one at its place.
  [[nodiscard]] const std::vector<std::int32_t>& places() const { return places_; }

 private:
  void add(const OrderedSurface& mesh, std::int32_t vertex) {
    const auto number = static_cast<std::int32_t>(positions_.size());
    number_[as_index(vertex)] = number;
    positions_.push_back(mesh.vertex(vertex));
    std::int32_t& first = first_[as_index(mesh.welded(vertex))];
    if (first == kNone) first = number;
    places_.push_back(first);
  }

  std::vector<std::int32_t> number_, first_;  // per vertex of the whole surface
  std::vector<Vec3> positions_;
  std::vector<std::int32_t> places_;
};

/// The lowest half-edge in the part of the edge of `half_edge`.
/// \param inside per caller's face, its number in the part
std::int32_t lowest_inside(const OrderedSurface& mesh, std::span<const std::int32_t> inside,
                           std::int32_t half_edge) {
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max(), h = half_edge;
  do {
    const std::int32_t face = inside[as_index(mesh.original_face(face_of(h)))];
    if (face != kNone) lowest = std::min(lowest, 3 * face + h % 3);
    h = mesh.next_around(h);
  } while (h != half_edge);
  return lowest;
}

Surface cut_out(const Surface& whole, std::span<const OrderedFace> faces,
                std::span<const std::int32_t> inside, Context* context) {
  const OrderedSurface& mesh = whole.ordered();
  const PartVertices vertices(mesh, faces);
  std::vector<std::int32_t> edges;
  std::vector<Face> corners;
  std::vector<double> densities;
  edges.reserve(3 * faces.size());
  corners.reserve(faces.size());
  if (!whole.uniform()) densities.reserve(3 * faces.size());
  for (const OrderedFace face : faces) {
    check_at(corners.size());
    const Vec3 density = mesh.densities(face);
    for (std::int32_t k = 0; k < 3; ++k) {
      edges.push_back(lowest_inside(mesh, inside, half_edge(face, k)));
      if (!whole.uniform()) densities.push_back(density[k]);
    }
    Face& local = corners.emplace_back(mesh.corners(face));
    for (std::int32_t& v : local) v = vertices.number(v);
  }
  return {vertices.positions(),
          corners,
          Density{DensityAt::kCorners, densities},
          Joints{edges, vertices.places()},
          whole.sharp_angle(),
          /*merge_doubled=*/false,
          context};
}

/// Walks over faces outside a set, starting at its rim, and distinguishes holes from the rest of
/// the surface.
class Holes {
 public:
  Holes(const OrderedSurface& mesh, const std::vector<OrderedFace>& faces, std::size_t most)
      : mesh_(mesh), faces_(faces), most_(most), inside_(mesh.face_count(), false) {
    for (const OrderedFace face : faces) inside_[as_index(face)] = true;
  }

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

  [[nodiscard]] bool is_inside(OrderedFace face) const { return inside_[as_index(face)]; }

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
  std::vector<bool> inside_;
  std::unordered_set<std::size_t> seen_;
  std::vector<OrderedFace> holes_;
};

std::vector<std::int32_t> original_faces(const Surface& whole, std::span<const OrderedFace> faces) {
  std::vector<std::int32_t> result;
  result.reserve(faces.size());
  for (const OrderedFace face : faces) result.push_back(whole.ordered().original_face(face));
  return result;
}

/// Per face of the whole, its number among these.
std::vector<std::int32_t> numbers_of(std::span<const std::int32_t> faces, std::size_t count) {
  std::vector<std::int32_t> result(count, kNone);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_at(f);
    result[as_index(faces[f])] = static_cast<std::int32_t>(f);
  }
  return result;
}

}  // namespace

SurfacePart::SurfacePart(const Surface& whole, std::span<const OrderedFace> faces, Context* context)
    : outside_(original_faces(whole, faces)),
      inside_(numbers_of(outside_, whole.face_count())),
      surface_(cut_out(whole, faces, inside_, context)),
      domain_(domain_of(surface_)) {}

std::vector<OrderedFace> without_holes(const Surface& surface, std::vector<OrderedFace> faces,
                                       std::size_t most) {
  std::vector<OrderedFace> holes = Holes(surface.ordered(), faces, most).find();
  std::sort(holes.begin(), holes.end());
  const auto count = static_cast<std::ptrdiff_t>(faces.size());
  faces.insert(faces.end(), holes.begin(), holes.end());
  std::inplace_merge(faces.begin(), faces.begin() + count, faces.end());
  return faces;
}

std::shared_ptr<const SurfaceDomain> domain_of(const Surface& part) {
  return std::make_shared<const SurfaceDomain>(part, Cells::kConnected, /*sides=*/nullptr,
                                               EmptyFaces::kLeft);
}

}  // namespace dapple
