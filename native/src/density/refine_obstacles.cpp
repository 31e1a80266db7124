// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/projector.hpp>
#include <dapple/refine_obstacles.hpp>
#include <limits>

#include "base/progress.hpp"
#include "base/triangle.hpp"
#include "base/validate.hpp"
#include "density/pieces.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kCut = 0.8;         // share of the progress when all faces are cut
constexpr double kFilled = 0.9;      // share of the progress when they have their density
constexpr double kRounding = 1e-14;  // of the largest coordinate: error of a sample's position

double largest_coordinate(const Surface& surface) {
  double largest = 0.0;
  for (std::size_t v = 0; v < surface.vertex_count(); ++v)
    largest = std::max(
        largest, surface.ordered().vertex(static_cast<std::int32_t>(v)).cwiseAbs().maxCoeff());
  return largest;
}

double distance_to(const Vec3& point, const std::array<Vec3, 3>& t) {
  const Vec3 w = closest_barycentric(point, t[0], t[1], t[2]);
  return (w[0] * t[0] + w[1] * t[1] + w[2] * t[2] - point).norm();
}

double farthest_corner(const Vec3& point, const std::array<Vec3, 3>& t) {
  return std::max({(t[0] - point).norm(), (t[1] - point).norm(), (t[2] - point).norm()});
}

/// The balls, and which of them reach each face.
class Balls {
 public:
  Balls(const Surface& surface, const Obstacles& obstacles)
      : points_(obstacles.points), of_face_(surface.face_count()) {
    check_same_length("radii", obstacles.radii.size(), "points", points_.size());
    const double rounding = kRounding * largest_coordinate(surface);
    for (const double radius : obstacles.radii)
      radii_.push_back(radius > 0.0 ? radius + rounding : radius);
    if (points_.empty()) return;
    const auto reached = Projector(surface).faces_within(points_, radii_);
    for (std::size_t k = 0; k < reached.size(); ++k)
      for (const std::int32_t face : reached[k])
        of_face_[static_cast<std::size_t>(face)].push_back(k);
  }

  [[nodiscard]] bool reach(std::int32_t parent, const std::array<Vec3, 3>& t) const {
    const std::vector<std::size_t>& near = of_face_[static_cast<std::size_t>(parent)];
    return std::any_of(near.begin(), near.end(),
                       [&](std::size_t k) { return distance_to(points_[k], t) < radii_[k]; });
  }

  /// The smallest radius of the balls whose border crosses the triangle; infinite if the triangle
  /// is inside a ball or no ball reaches it.
  [[nodiscard]] double crossing_radius(std::int32_t parent, const std::array<Vec3, 3>& t) const {
    double smallest = std::numeric_limits<double>::infinity();
    for (const std::size_t k : of_face_[static_cast<std::size_t>(parent)]) {
      if (farthest_corner(points_[k], t) < radii_[k])
        return std::numeric_limits<double>::infinity();
      if (distance_to(points_[k], t) < radii_[k]) smallest = std::min(smallest, radii_[k]);
    }
    return smallest;
  }

 private:
  std::span<const Vec3> points_;
  std::vector<double> radii_;
  std::vector<std::vector<std::size_t>> of_face_;
};

/// A refinement without any cuts, as refine() returns it for a refined surface.
Refined uncut(const Surface& surface) {
  Refined refined{surface, surface, {}, {}, {}, {}, true};
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    refined.parents.push_back(static_cast<std::int32_t>(f));
    refined.barycentric.push_back({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
  }
  return refined;
}

std::array<Vec3, 3> corners_of(const OrderedSurface& surface, OrderedFace face) {
  const auto [a, b, c] = surface.corners(face);
  return {surface.vertex(a), surface.vertex(b), surface.vertex(c)};
}

}  // namespace

Refined refine_obstacles(const Surface& surface, const Obstacles& obstacles,
                         const ObstacleOptions& options, Context* context) {
  check_positive("edge", options.edge);
  if (!obstacles.areas.empty())
    check_same_length("areas", obstacles.areas.size(), "faces", surface.face_count());
  const auto in_area = [&](std::int32_t face) {
    return !obstacles.areas.empty() && obstacles.areas[static_cast<std::size_t>(face)] != 0;
  };
  const Balls balls(surface, obstacles);
  Stretch cutting(context, 0.0, kCut);
  const bool nothing_to_cut = obstacles.points.empty() && !surface.merge_doubled();
  Refined refined =
      nothing_to_cut ? uncut(surface)
                     : refine(
                           surface,
                           [&](const Piece& piece) {
                             if (in_area(piece.parent)) return EdgeMarks{};
                             return longer_than(
                                 options.edge * balls.crossing_radius(piece.parent, piece.corners),
                                 piece.corners);
                           },
                           options.max_faces, cutting.context());
  const OrderedSurface& fine = refined.surface.ordered();
  Stretch filling(context, kCut, kFilled), measuring(context, kFilled, 1.0);
  std::vector<std::uint8_t> taken;
  for (std::size_t f = 0; f < refined.parents.size(); ++f) {
    report_at(filling.context(), f, refined.parents.size());
    const OrderedFace face = fine.ordered_face(static_cast<std::int32_t>(f));
    taken.push_back(in_area(refined.parents[f]) ||
                    balls.reach(refined.parents[f], corners_of(fine, face)));
  }
  const bool takes = std::find(taken.begin(), taken.end(), 1) != taken.end();
  if (!takes && refined.surface.density_at() == DensityAt::kCorners && !refined.surface.uniform()) {
    if (context) context->advance(1.0);
    return refined;
  }
  const std::vector<double> density = density_without(refined.surface, taken);
  if (density.empty())
    throw ArgumentError("points and areas take all of the surface: nothing can be placed");
  refined.surface =
      refined.surface.with_density({DensityAt::kCorners, density}, measuring.context());
  if (context) context->advance(1.0);
  return refined;
}

}  // namespace dapple
