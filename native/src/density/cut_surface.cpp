// SPDX-License-Identifier: GPL-3.0-or-later
#include "density/cut_surface.hpp"

#include <algorithm>
#include <atomic>
#include <bit>

#include "base/hexagonal.hpp"
#include "base/parallel.hpp"
#include "base/triangle.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kMany = 24.0;   // cells on a face: if there are more, the surface is cut
constexpr double kFew = 8.0;     // cells on a piece
constexpr double kNarrow = 1.0;  // spacings: all cells of a narrower face are in one row
constexpr std::size_t kMostFaces = 100'000'000;

/// The largest power of two not above the number, so that similar numbers share a refinement.
std::size_t order_of(std::size_t count) { return std::bit_floor(std::max<std::size_t>(count, 1)); }

double area_of(const Piece& piece) {
  const auto& [a, b, c] = piece.corners;
  return 0.5 * (b - a).cross(c - a).norm();
}

/// The capacity of a piece of a face.
double capacity_of(const Surface& surface, const Piece& piece) {
  const auto& [a, b, c] = piece.barycentric;
  const Vec3 densities = surface.ordered().densities(surface.ordered().ordered_face(piece.parent));
  return area_of(piece) * ((a + b + c) / 3.0).dot(densities);
}

/// The longest edge of a piece, unless the piece is narrower than `narrow`.
EdgeMarks longest_edge(const Piece& piece, double narrow) {
  const auto& [a, b, c] = piece.corners;
  const std::array<double, 3> lengths = {(b - a).norm(), (c - b).norm(), (a - c).norm()};
  const auto longest = std::max_element(lengths.begin(), lengths.end());
  EdgeMarks marks{};
  marks[static_cast<std::size_t>(longest - lengths.begin())] =
      (b - a).cross(c - a).norm() > narrow * *longest;
  return marks;
}

bool has_large_face(const Surface& surface, double capacity) {
  std::atomic<bool> found = false;
  parallel_chunks(surface.face_count(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end && !found; ++f)
      if (surface.ordered().geometry(nth_face(f)).moments.capacity > capacity) found = true;
  });
  return found;
}

/// Barycentric coordinates of a site; they are computed if the sites have none.
Vec3 weights_of(const Surface& surface, const Sites& sites, std::size_t k) {
  if (!sites.barycentric.empty()) return sites.barycentric[k];
  const auto [a, b, c] = surface.ordered().corners(surface.ordered().ordered_face(sites.faces[k]));
  return closest_barycentric(sites.positions[k], surface.ordered().vertex(a),
                             surface.ordered().vertex(b), surface.ordered().vertex(c));
}

}  // namespace

Sites CutSurface::on_pieces(const Sites& sites) const {
  Sites result{sites.positions, sites.faces, std::vector<Vec3>(sites.size())};
  parallel_chunks(sites.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto [face, weights] =
          finder_.find(sites.faces[k], weights_of(refined_.original, sites, k));
      result.faces[k] = face;
      result.barycentric[k] = weights;
    }
  });
  return result;
}

std::shared_ptr<const CutSurface> cut_for(const Surface& surface, std::size_t count,
                                          Context* context) {
  const auto cells = static_cast<double>(order_of(count));
  if (!has_large_face(surface, kMany * (surface.ordered().unit_capacity() / cells))) return nullptr;
  const double cell = surface.capacity() / cells;
  const auto criterion = [&](const Piece& piece) {
    const double capacity = capacity_of(surface, piece);
    if (!(capacity > kFew * cell)) return EdgeMarks{};
    return longest_edge(piece, kNarrow * hexagonal_spacing(area_of(piece) * cell / capacity));
  };
  return std::make_shared<const CutSurface>(refine(surface, criterion, kMostFaces, context));
}

}  // namespace dapple
