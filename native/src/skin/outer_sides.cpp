// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/outer_sides.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kRatio = 2.0, kMargin = 0.1;    // by which the outside sees more than the inside
constexpr std::size_t kPlaces = 64, kLeast = 4;  // looked from, per patch
constexpr std::size_t kAllPlaces = 1 << 14;      // of all patches, if they need no more

/// Faces that are connected over edges and oriented alike.
struct Patches {
  std::vector<OrderedFace> faces;   // patch after patch
  std::vector<std::size_t> starts;  // the first of each patch, and the end
};

/// The welded vertex at which a half-edge starts.
std::int32_t start_of(const OrderedSurface& mesh, std::int32_t half_edge) {
  return mesh.welded_corners(face_of(half_edge))[static_cast<std::size_t>(half_edge % 3)];
}

/// The face on the other side of an edge, if it is the only one and oriented alike; otherwise the
/// face itself.
OrderedFace alike(const OrderedSurface& mesh, std::int32_t half_edge) {
  const std::int32_t twin = mesh.next_around(half_edge);
  const bool is_pair = mesh.next_around(twin) == half_edge;
  return is_pair && start_of(mesh, half_edge) != start_of(mesh, twin) ? face_of(twin)
                                                                      : face_of(half_edge);
}

Patches find_patches(const OrderedSurface& mesh) {
  const std::size_t count = mesh.face_count();
  Patches result;
  result.faces.reserve(count);
  std::vector<bool> found(count, false);
  for (std::size_t f = 0; f < count; ++f) {
    if (found[f]) continue;
    found[f] = true;
    std::size_t next = result.faces.size();
    result.starts.push_back(next);
    result.faces.push_back(nth_face(f));
    for (; next < result.faces.size(); ++next)
      for (std::int32_t k = 0; k < 3; ++k) {
        const OrderedFace other = alike(mesh, half_edge(result.faces[next], k));
        if (found[as_index(other)]) continue;
        found[as_index(other)] = true;
        result.faces.push_back(other);
      }
  }
  result.starts.push_back(result.faces.size());
  return result;
}

/// Barycentric coordinates that spread over a triangle (Roberts 2018, the R2 sequence).
Vec3 nth_weights(std::size_t k) {
  const auto fraction = [&](double step) {
    const double x = 0.5 + step * static_cast<double>(k);
    return x - std::floor(x);
  };
  double u = fraction(0.7548776662466927), v = fraction(0.5698402909980532);
  if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
  return {u, v, 1.0 - u - v};
}

/// The outer sides of a patch, found from places spread evenly over its area.
Sides sides_of(const OrderedSurface& mesh, std::span<const OrderedFace> patch, std::size_t places,
               const FreeOnSides& free) {
  double area = 0.0, passed = 0.0;
  for (const OrderedFace face : patch) area += mesh.geometry(face).moments.area;
  std::array<double, 2> seen{};
  std::size_t k = 0;
  for (const OrderedFace face : patch) {
    passed += mesh.geometry(face).moments.area;
    for (;
         k < places && (static_cast<double>(k) + 0.5) * area < static_cast<double>(places) * passed;
         ++k) {
      const auto here = free(mesh.point(face, nth_weights(k)), mesh.geometry(face).normal);
      for (std::size_t side = 0; side < 2; ++side)
        seen[side] += here[side] / static_cast<double>(places);
    }
  }
  const auto exceeds = [](double one, double other) { return one >= kRatio * other + kMargin; };
  if (exceeds(seen[0], seen[1])) return Sides::kFront;
  return exceeds(seen[1], seen[0]) ? Sides::kBack : Sides::kBoth;
}

}  // namespace

std::vector<Sides> outer_sides(const Surface& surface, const FreeOnSides& free,
                               const Context* context) {
  const OrderedSurface& mesh = surface.ordered();
  const Patches patches = find_patches(mesh);
  const std::size_t count = patches.starts.size() - 1;
  const std::size_t places =
      std::clamp(kAllPlaces / std::max(count, std::size_t{1}), kLeast, kPlaces);
  std::vector<Sides> result(mesh.face_count(), Sides::kBoth);
  parallel_chunks(count, 4, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    for (std::size_t k = begin; k < end; ++k) {
      const std::span patch(&patches.faces[patches.starts[k]],
                            patches.starts[k + 1] - patches.starts[k]);
      const Sides sides = sides_of(mesh, patch, places, free);
      for (const OrderedFace face : patch)
        result[static_cast<std::size_t>(mesh.original_face(face))] = sides;
    }
  });
  return result;
}

}  // namespace dapple
