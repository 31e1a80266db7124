// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/local_projection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>

#include "base/parallel.hpp"
#include "base/triangle.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {

/// The nearest point found so far.
struct LocalProjection::Hit {
  double squared_distance;
  OrderedFace face;
  Vec3 barycentric;
};

namespace {

constexpr std::size_t kGrain = 64;
constexpr double kRounding = 1e-9;  // relative rounding error of a distance
constexpr double kDigits = 1e-14;   // relative rounding error of coordinates
constexpr double kTurned = 0.5;     // cosine: hits on faces turned farther than this are examined
constexpr int kStraight = 200;      // most faces crossed on the straight way to a hit

class Walk {
 public:
  using Hit = LocalProjection::Hit;

  Walk(const Surface& surface, const Vec3& point) : surface_(surface), point_(point) {}

  /// The nearest point among the faces connected to `start` within the ball that touches it.
  Hit from(OrderedFace start) {
    Hit best = closest(start);
    const bool may_stay = surface_.uniform() || has_density(surface_, start);
    // The ball touches the edge that contains the nearest point; the margin prevents that rounding
    // separates them.
    const double radius = std::sqrt(best.squared_distance) * (1.0 + kRounding) +
                          kDigits * point_.cwiseAbs().maxCoeff();
    const double ball = radius * radius;
    visit(start);
    while (!pending_.empty()) {
      const OrderedFace face = pending_.back();
      pending_.pop_back();
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t h = half_edge(face, k);
        if (squared_distance_to_edge(h) > ball) continue;
        for (std::int32_t g = surface_.ordered().next_around(h); g != h;
             g = surface_.ordered().next_around(g))
          if (visit(face_of(g)) && has_density(surface_, face_of(g)))
            best = may_stay || has_density(surface_, best.face) ? better(best, closest(face_of(g)))
                                                                : closest(face_of(g));
      }
    }
    return best;
  }

 private:
  bool visit(OrderedFace face) {
    if (!seen_.insert(face).second) return false;
    pending_.push_back(face);
    return true;
  }

  [[nodiscard]] Hit closest(OrderedFace face) const {
    const auto [a, b, c] = surface_.ordered().corners(face);
    const Vec3 weights =
        closest_barycentric(point_, surface_.ordered().vertex(a), surface_.ordered().vertex(b),
                            surface_.ordered().vertex(c));
    const Vec3 found = surface_.point(surface_.ordered().original_face(face), weights);
    return {(found - point_).squaredNorm(), face, weights};
  }

  // Ties go to the caller's lowest face index, as in the projector.
  [[nodiscard]] Hit better(const Hit& a, const Hit& b) const {
    if (a.squared_distance != b.squared_distance)
      return a.squared_distance < b.squared_distance ? a : b;
    return surface_.ordered().original_face(a.face) < surface_.ordered().original_face(b.face) ? a
                                                                                               : b;
  }

  [[nodiscard]] double squared_distance_to_edge(std::int32_t half_edge) const {
    const Face& corners = surface_.ordered().corners(face_of(half_edge));
    const auto k = static_cast<std::size_t>(half_edge % 3);
    const Vec3& a = surface_.ordered().vertex(corners[k]);
    const Vec3 along = surface_.ordered().vertex(corners[(k + 1) % 3]) - a;
    const double length = along.squaredNorm();
    const double t = length > 0.0 ? std::clamp((point_ - a).dot(along) / length, 0.0, 1.0) : 0.0;
    return (a + t * along - point_).squaredNorm();
  }

  const Surface& surface_;
  const Vec3& point_;
  std::unordered_set<OrderedFace> seen_;
  std::vector<OrderedFace> pending_;
};

/// The edge of a face (its half-edge) beyond which a point lies, seen along the face's normal; none
/// if the point is above or below the face.
std::optional<std::int32_t> edge_toward(const Surface& surface, OrderedFace face,
                                        const Vec3& point) {
  const Face& corners = surface.ordered().corners(face);
  const Vec3& normal = surface.ordered().geometry(face).normal;
  std::optional<std::int32_t> best;
  double farthest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& a = surface.ordered().vertex(corners[k]);
    const Vec3 along = surface.ordered().vertex(corners[(k + 1) % 3]) - a;
    const double beyond = normal.cross(along).dot(a - point) / along.norm();
    if (!(beyond > farthest + kDigits * point.cwiseAbs().maxCoeff())) continue;
    farthest = beyond;
    best = half_edge(face, static_cast<std::int32_t>(k));
  }
  return best;
}

/// Whether a straight walk from one face leads to the hit. It does not if the hit is on another
/// sheet, even at the same place.
bool leads_to(const Surface& surface, OrderedFace from, OrderedFace hit, const Vec3& point) {
  for (int step = 0; step < kStraight && from != hit; ++step) {
    const std::optional<std::int32_t> edge = edge_toward(surface, from, point);
    if (!edge) return false;
    const std::int32_t across = surface.ordered().next_around(*edge);
    if (across == *edge || surface.ordered().next_around(across) != *edge) return false;
    from = face_of(across);
  }
  return from == hit;
}

/// Whether a hit is on another component or on a face turned away.
bool on_another_sheet(const Surface& surface, OrderedFace from, OrderedFace hit) {
  return surface.ordered().component(from) != surface.ordered().component(hit) ||
         surface.ordered().geometry(from).normal.dot(surface.ordered().geometry(hit).normal) <
             kTurned;
}

}  // namespace

Projection LocalProjection::walk(std::span<const Vec3> points, std::span<const std::int32_t> from,
                                 const Context* context) const {
  const std::size_t count = points.size();
  Projection hits{std::vector<Vec3>(count), std::vector<std::int32_t>(count),
                  std::vector<Vec3>(count), std::vector<double>(count)};
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    if (context) context->check();
    for (std::size_t k = begin; k < end; ++k)
      walk_to(points[k], surface_->ordered().counted_face(from[k]), k, hits);
  });
  return hits;
}

void LocalProjection::mend(std::span<const Vec3> points, std::span<const std::int32_t> from,
                           Projection& hits, const Context* context) const {
  parallel_chunks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (context) context->check();
    for (std::size_t k = begin; k < end; ++k) {
      const OrderedFace start = surface_->ordered().counted_face(from[k]);
      const OrderedFace hit = surface_->ordered().ordered_face(hits.faces[k]);
      if (start == hit || !has_density(*surface_, start)) continue;  // no site may stay there
      if (on_another_sheet(*surface_, start, hit))
        walk_to(points[k], start, k, hits);
      else if (!leads_to(*surface_, start, hit, hits.positions[k]))
        stay(points[k], start, k, hits);
    }
  });
}

void LocalProjection::walk_to(const Vec3& point, OrderedFace start, std::size_t k,
                              Projection& hits) const {
  put(Walk(*surface_, point).from(start), k, hits);
}

void LocalProjection::stay(const Vec3& point, OrderedFace start, std::size_t k,
                           Projection& hits) const {
  const Hit hit = Walk(*surface_, point).from(start);
  const double same = hits.distances[k] * (1.0 + kRounding) + kDigits * point.cwiseAbs().maxCoeff();
  if (std::sqrt(hit.squared_distance) <= same) put(hit, k, hits);
}

void LocalProjection::put(const Hit& hit, std::size_t k, Projection& hits) const {
  hits.faces[k] = surface_->ordered().original_face(hit.face);
  hits.barycentric[k] = hit.barycentric;
  hits.positions[k] = surface_->point(hits.faces[k], hit.barycentric);
  hits.distances[k] = std::sqrt(hit.squared_distance);
}

}  // namespace dapple
