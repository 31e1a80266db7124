// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/walk.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "base/triangle.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 64;
constexpr double kRounding = 1e-9;  // relative rounding error of a distance
constexpr double kDigits = 1e-14;   // relative rounding error of coordinates

/// The nearest point found so far.
struct Hit {
  double squared_distance;
  OrderedFace face;
  Vec3 barycentric;
};

/// A set of faces that is cleared in no time.
class FaceSet {
 public:
  void clear() {
    size_ = 0;
    if (++stamp_ != 0) return;
    std::fill(slots_.begin(), slots_.end(), Slot());
    stamp_ = 1;
  }

  /// Whether the face was not in the set.
  bool insert(OrderedFace face) {
    if (2 * ++size_ > slots_.size()) grow();
    Slot* const slot = place_of(face);
    if (slot->stamp == stamp_) {
      --size_;
      return false;
    }
    *slot = {stamp_, face};
    return true;
  }

 private:
  struct Slot {
    std::uint32_t stamp = 0;
    OrderedFace face = OrderedFace{0};
  };

  Slot* place_of(OrderedFace face) {
    std::size_t k = as_index(face) * 0x9e3779b1U & (slots_.size() - 1);
    while (slots_[k].stamp == stamp_ && slots_[k].face != face) k = (k + 1) & (slots_.size() - 1);
    return &slots_[k];
  }

  void grow() {
    std::vector<Slot> old(std::max<std::size_t>(64, 2 * slots_.size()));
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.stamp == stamp_) *place_of(slot.face) = slot;
  }

  std::vector<Slot> slots_;  // a power of two, at most half full
  std::size_t size_ = 0;
  std::uint32_t stamp_ = 1;
};

/// Walks from one face after another to nearest points; one object per thread.
class Walk {
 public:
  explicit Walk(const Surface& surface) : surface_(surface) {}

  /// The nearest point among the faces connected to `start` within the ball that touches it.
  Hit to(const Vec3& point, OrderedFace start) {
    point_ = point;
    seen_.clear();
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
    if (!seen_.insert(face)) return false;
    pending_.push_back(face);
    return true;
  }

  [[nodiscard]] Hit closest(OrderedFace face) const {
    const auto [a, b, c] = surface_.ordered().corners(face);
    const Vec3 weights =
        closest_barycentric(point_, surface_.ordered().vertex(a), surface_.ordered().vertex(b),
                            surface_.ordered().vertex(c));
    const Vec3 found = surface_.ordered().point(face, weights);
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
  Vec3 point_ = Vec3::Zero();
  FaceSet seen_;
  std::vector<OrderedFace> pending_;
};

}  // namespace

Projection walk_to_nearest(const Surface& surface, std::span<const Vec3> points,
                           std::span<const std::int32_t> from, const Context* context) {
  const std::size_t count = points.size();
  Projection hits{std::vector<Vec3>(count), std::vector<std::int32_t>(count),
                  std::vector<Vec3>(count), std::vector<double>(count)};
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    if (context) context->check();
    Walk walk(surface);
    for (std::size_t k = begin; k < end; ++k) {
      const Hit hit = walk.to(points[k], surface.ordered().counted_face(from[k]));
      hits.faces[k] = surface.ordered().original_face(hit.face);
      hits.barycentric[k] = hit.barycentric;
      hits.positions[k] = surface.ordered().point(hit.face, hit.barycentric);
      hits.distances[k] = std::sqrt(hit.squared_distance);
    }
  });
  return hits;
}

}  // namespace dapple
