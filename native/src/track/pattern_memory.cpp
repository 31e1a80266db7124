// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/pattern_memory.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "base/tangent_basis.hpp"

namespace dapple {
namespace {

constexpr double kRebuilt =
    0.5;  // misfit, in distances to neighbors, above which the pattern is forgotten
constexpr double kPace = 3.0;      // longest move, in changes of the distances to the neighbors
constexpr std::size_t kLeast = 4;  // neighbors: with three, an affine map fits exactly
constexpr double kInLine = 1e-12;  // relative determinant of collinear offsets
constexpr std::size_t kGrain = 256;

/// The parts of the best affine map between planar offsets that recall() needs.
struct Fit {
  Eigen::Vector2d shift;  // of the origin
  double misfit;          // root mean square
};

/// \param from, to offsets in columns. The sums are computed in this order, because Eigen's
/// products choose their own.
Fit fit_affine(const Eigen::Matrix2Xd& from, const Eigen::Matrix2Xd& to) {
  const Eigen::Vector2d middle_from = from.rowwise().mean();
  const Eigen::Vector2d middle_to = to.rowwise().mean();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero(), cross = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < from.cols(); ++k) {
    const Eigen::Vector2d x = from.col(k) - middle_from;
    square += x * x.transpose();
    cross += (to.col(k) - middle_to) * x.transpose();
  }
  if (!(square.determinant() > kInLine * square.squaredNorm()))
    return {Eigen::Vector2d::Zero(), std::numeric_limits<double>::infinity()};
  const Eigen::Matrix2d map = cross * square.inverse();
  const Eigen::Vector2d shift = middle_to - map * middle_from;
  double misfit = 0.0;
  for (Eigen::Index k = 0; k < from.cols(); ++k)
    misfit += (map * from.col(k) + shift - to.col(k)).squaredNorm();
  return {shift, std::sqrt(misfit / static_cast<double>(from.cols()))};
}

/// The offsets of a ring from its middle in the tangent plane, in columns.
Eigen::Matrix2Xd offsets(std::size_t middle, std::span<const std::int32_t> ring,
                         const Vectors& positions, const Eigen::Matrix<double, 3, 2>& basis) {
  Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(ring.size()));
  for (std::size_t k = 0; k < ring.size(); ++k)
    result.col(static_cast<Eigen::Index>(k)) =
        basis.transpose() * (positions[static_cast<std::size_t>(ring[k])] - positions[middle]);
  return result;
}

}  // namespace

PatternMemory::PatternMemory(const RestrictedVoronoi& first) {
  for (std::size_t i = 0; i < first.cells.size(); ++i) {
    for (const CellBoundary& side : first.boundary(i)) neighbors_.push_back(side.neighbor);
    starts_.push_back(neighbors_.size());
  }
}

PatternMemory PatternMemory::exchanged(std::span<const std::int32_t> origin) const {
  std::vector<std::int32_t> present(starts_.size() - 1, -1);
  for (std::size_t k = 0; k < origin.size(); ++k)
    if (origin[k] >= 0) present[static_cast<std::size_t>(origin[k])] = static_cast<std::int32_t>(k);
  PatternMemory result;
  for (const std::int32_t o : origin) {
    if (o >= 0)
      for (const std::int32_t j : of(static_cast<std::size_t>(o)))
        if (present[static_cast<std::size_t>(j)] >= 0)
          result.neighbors_.push_back(present[static_cast<std::size_t>(j)]);
    result.starts_.push_back(result.neighbors_.size());
  }
  return result;
}

std::span<const std::int32_t> PatternMemory::of(std::size_t site) const {
  return std::span(neighbors_).subspan(starts_[site], starts_[site + 1] - starts_[site]);
}

Vectors PatternMemory::recall(const Places& first, const Vectors& before, const Places& now,
                              double share) const {
  Vectors moves(now.positions.size());
  parallel_chunks(moves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) moves[i] = recall_one(i, first, before, now, share);
  });
  return moves;
}

Vec3 PatternMemory::recall_one(std::size_t i, const Places& first, const Vectors& before,
                               const Places& now, double share) const {
  const std::span<const std::int32_t> ring = of(i);
  if (ring.size() < kLeast) return Vec3::Zero();
  const auto now_basis = tangent_basis(now.normals[i]);
  const Fit fit = fit_affine(offsets(i, ring, first.positions, tangent_basis(first.normals[i])),
                             offsets(i, ring, now.positions, now_basis));
  double then = 0.0, today = 0.0, change = 0.0;  // sums of distances and of their changes
  for (const std::int32_t neighbor : ring) {
    const auto j = static_cast<std::size_t>(neighbor);
    const double length = (now.positions[j] - now.positions[i]).norm();
    then += (first.positions[j] - first.positions[i]).norm();
    today += length;
    change += std::abs(length - (before[j] - before[i]).norm());
  }
  const auto count = static_cast<double>(ring.size());
  const double strangeness = fit.misfit / (kRebuilt * std::min(then, today) / count);
  if (!(strangeness < 1.0)) return Vec3::Zero();
  const double trust = 1.0 - strangeness * strangeness;
  const Vec3 way = share * trust * trust * (now_basis * fit.shift);
  const double longest = kPace * change / count;
  return way.norm() <= longest ? way : Vec3(longest / way.norm() * way);
}

}  // namespace dapple
