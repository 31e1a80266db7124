// SPDX-License-Identifier: GPL-3.0-or-later
#include "density/piece_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/triangle.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

// The weights of a point in one of the pieces, from its weights in the parent.
Vec3 weights_in(const std::array<Vec3, 3>& corners, const Vec3& weights) {
  const auto doubled = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
  };
  const auto& [a, b, c] = corners;
  return Vec3(doubled(weights, b, c), doubled(a, weights, c), doubled(a, b, weights)) /
         doubled(a, b, c);
}

}  // namespace

PieceFinder::PieceFinder(const Refined& refined) : refined_(refined), grids_(grids()) {
  const std::size_t cells =
      grids_.empty() ? 0
                     : grids_.back().first + static_cast<std::size_t>(grids_.back().side) *
                                                 static_cast<std::size_t>(grids_.back().side);
  starts_.assign(cells + 1, 0);
  for (std::size_t f = 0; f < refined_.parents.size(); ++f)
    for_each_cell(f, [&](std::size_t cell) { ++starts_[cell + 1]; });
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  pieces_.resize(starts_.back());
  std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t f = 0; f < refined_.parents.size(); ++f)
    for_each_cell(f,
                  [&](std::size_t cell) { pieces_[next[cell]++] = static_cast<std::int32_t>(f); });
}

/// A grid of about as many cells as the face has pieces.
std::vector<PieceFinder::Grid> PieceFinder::grids() const {
  std::vector<std::size_t> counts(refined_.original.face_count(), 0);
  for (const std::int32_t parent : refined_.parents) ++counts[static_cast<std::size_t>(parent)];
  std::vector<Grid> result(counts.size());
  std::size_t first = 0;
  for (std::size_t f = 0; f < counts.size(); ++f) {
    const double side =
        counts[f] > 1 ? std::ceil(std::sqrt(2.0 * static_cast<double>(counts[f]))) : 1.0;
    result[f] = {first, static_cast<std::int32_t>(side)};
    first += static_cast<std::size_t>(result[f].side) * static_cast<std::size_t>(result[f].side);
  }
  return result;
}

std::int32_t PieceFinder::along(const Grid& grid, double weight) {
  return std::clamp(static_cast<std::int32_t>(weight * grid.side), 0, grid.side - 1);
}

/// Visits the cells that a piece's bounding box meets.
template <typename Visit>
void PieceFinder::for_each_cell(std::size_t piece, const Visit& visit) const {
  const auto& [a, b, c] = refined_.barycentric[piece];
  const Grid& grid = grids_[static_cast<std::size_t>(refined_.parents[piece])];
  if (grid.side == 1) return visit(grid.first);
  const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  for (std::int32_t row = along(grid, low[1]); row <= along(grid, high[1]); ++row)
    for (std::int32_t column = along(grid, low[2]); column <= along(grid, high[2]); ++column)
      visit(grid.first + static_cast<std::size_t>(row * grid.side + column));
}

/// Replaces a doubled face by the one that counts; only that one has pieces.
PieceFinder::Found PieceFinder::find_below(std::int32_t parent, const Vec3& weights) const {
  const Surface& surface = refined_.original;
  const OrderedSurface& mesh = surface.ordered();
  const OrderedFace counted = mesh.counted_face(parent);
  const auto [a, b, c] = mesh.corners(counted);
  return find(mesh.original_face(counted),
              closest_barycentric(surface.point(parent, weights), mesh.vertex(a), mesh.vertex(b),
                                  mesh.vertex(c)));
}

// A point shared by several pieces belongs to the one with the lowest index.
PieceFinder::Found PieceFinder::find(std::int32_t parent, const Vec3& weights) const {
  const OrderedSurface& mesh = refined_.original.ordered();
  if (!mesh.counts(mesh.ordered_face(parent))) return find_below(parent, weights);
  const Grid& grid = grids_[static_cast<std::size_t>(parent)];
  const std::size_t cell =
      grid.first +
      static_cast<std::size_t>(along(grid, weights[1]) * grid.side + along(grid, weights[2]));
  Found best{pieces_[starts_[cell]], weights};
  if (grid.side == 1) return best;  // the face is its only piece
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = starts_[cell]; k < starts_[cell + 1]; ++k) {
    const Vec3 inside =
        weights_in(refined_.barycentric[static_cast<std::size_t>(pieces_[k])], weights);
    if (!(inside.minCoeff() > most)) continue;  // also if the piece has no area
    most = inside.minCoeff();
    best = {pieces_[k], inside};
  }
  const Vec3 clipped = best.weights.cwiseMax(0.0);
  return {best.face, clipped / clipped.sum()};
}

}  // namespace dapple
