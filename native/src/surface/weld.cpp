// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/weld.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "base/elementary.hpp"
#include "base/progress.hpp"
#include "surface/places.hpp"

namespace dapple {
namespace {

constexpr double kTouching = 1e-3;  // radians between faces that lie on each other
constexpr double kFlat = 1e-9;      // height of a face over its side, below which it has no angle

// Shares of the progress.
constexpr double kBordersSettled = 0.35, kSettled = 0.4, kSidesFound = 0.7;

std::size_t as_size(std::int32_t k) { return static_cast<std::size_t>(k); }

/// A half-edge, seen along its edge from the lower position.
struct Side {
  std::int32_t low, high;  // places
  std::int32_t half_edge;
  bool forward;        // whether it runs from the lower place to the higher one
  bool border;         // no other face shares its vertices
  double angle = 0.0;  // of its face about the edge; NaN for a face without area
  auto operator<=>(const Side& other) const {
    return std::tie(low, high, half_edge) <=> std::tie(other.low, other.high, other.half_edge);
  }
};

class Welder {
 public:
  Welder(std::span<const Vec3> vertices, double tolerance, std::span<const Face> faces,
         const std::vector<bool>& left_out, std::vector<std::int32_t>& next_around,
         Context* context)
      : vertices_(vertices),
        faces_(faces),
        left_out_(left_out),
        next_around_(next_around),
        context_(context),
        welded_(vertices.size()) {
    std::iota(welded_.begin(), welded_.end(), 0);
    border_ = border_vertices();
    if (std::find(border_.begin(), border_.end(), true) != border_.end()) find_places(tolerance);
  }

  std::vector<std::int32_t> run() {
    std::vector<Side> sides = crowded_sides();
    Stretch connecting(context_, kSidesFound, 1.0);
    std::size_t edges = 0;
    for (auto first = sides.begin(); first != sides.end();) {
      if (edges++ % 1024 == 0)
        report_at(connecting.context(), static_cast<std::size_t>(first - sides.begin()),
                  sides.size(), 1);
      const auto last = std::find_if(first, sides.end(), [&](const Side& side) {
        return side.low != first->low || side.high != first->high;
      });
      connect({first, last});
      first = last;
    }
    for (std::size_t v = 0; v < welded_.size(); ++v)
      welded_[v] = root(static_cast<std::int32_t>(v));
    return std::move(welded_);
  }

 private:
  [[nodiscard]] std::int32_t start(std::int32_t h) const {
    return faces_[as_size(h / 3)][as_size(h % 3)];
  }
  [[nodiscard]] std::int32_t end(std::int32_t h) const {
    return faces_[as_size(h / 3)][as_size((h % 3 + 1) % 3)];
  }
  [[nodiscard]] std::int32_t opposite(std::int32_t h) const {
    return faces_[as_size(h / 3)][as_size((h % 3 + 2) % 3)];
  }
  [[nodiscard]] bool is_border(std::int32_t h) const {
    return next_around_[as_size(h)] == h && !is_left_out(h);
  }
  [[nodiscard]] bool is_left_out(std::int32_t h) const {
    return !left_out_.empty() && left_out_[as_size(h / 3)];
  }
  [[nodiscard]] std::int32_t half_edges() const {
    return static_cast<std::int32_t>(3 * faces_.size());
  }

  [[nodiscard]] std::vector<bool> border_vertices() const {
    std::vector<bool> result(vertices_.size(), false);
    for (std::int32_t h = 0; h < half_edges(); ++h) {
      check_at(context_, as_size(h));
      if (is_border(h)) result[as_size(start(h))] = result[as_size(end(h))] = true;
    }
    return result;
  }

  /// For each vertex, find the lowest vertex at the same place; only places with a vertex on a
  /// border matter.
  void find_places(double tolerance) {
    Places places(vertices_, tolerance);
    places_.resize(vertices_.size());
    std::iota(places_.begin(), places_.end(), 0);
    const auto settle = [&](bool at_border, double from, double to) {
      Stretch settling(context_, from, to);
      for (std::size_t v = 0; v < places_.size(); ++v) {
        report_at(settling.context(), v, places_.size());
        if (border_[v] != at_border) continue;
        const std::int32_t found = places.find(vertices_[v]);
        if (found >= 0)
          places_[v] = found;
        else if (at_border)
          places.add(static_cast<std::int32_t>(v));
      }
    };
    settle(true, 0.0, kBordersSettled);
    settle(false, kBordersSettled, kSettled);
  }

  /// The half-edges of edges whose two places both have a vertex on a border, sorted by edge.
  [[nodiscard]] std::vector<Side> crowded_sides() const {
    std::vector<Side> sides;
    if (places_.empty()) return sides;
    std::vector<bool> at_border(vertices_.size(), false);  // by place
    for (std::size_t v = 0; v < border_.size(); ++v)
      if (border_[v]) at_border[as_size(places_[v])] = true;
    for (std::int32_t h = 0; h < half_edges(); ++h) {
      check_at(context_, as_size(h));
      if (is_left_out(h)) continue;
      const std::int32_t a = places_[as_size(start(h))], b = places_[as_size(end(h))];
      if (a != b && at_border[as_size(a)] && at_border[as_size(b)])
        sides.push_back({std::min(a, b), std::max(a, b), h, a < b, is_border(h)});
    }
    Stretch sorting(context_, kSettled, kSidesFound);
    sort_watched(sides, sorting.context());
    return sides;
  }

  /// Connect the faces that meet at one edge.
  void connect(std::span<Side> sides) {
    const auto borders = std::count_if(sides.begin(), sides.end(), std::mem_fn(&Side::border));
    if (borders == 0 || sides.size() < 2) return;
    measure_angles(sides);
    if (static_cast<std::size_t>(borders) != sides.size() || !connect_walls(sides))
      connect_all(sides);
  }

  /// Measure the angles of the faces around their edge, starting from the first face that has an
  /// area.
  void measure_angles(std::span<Side> sides) const {
    const Vec3& origin = vertices_[as_size(sides[0].low)];
    const Vec3 along = (vertices_[as_size(sides[0].high)] - origin).normalized();
    std::optional<Vec3> first;
    for (Side& side : sides) {
      const Vec3 to = vertices_[as_size(opposite(side.half_edge))] - origin;
      const Vec3 across = to - to.dot(along) * along;
      side.angle = std::numeric_limits<double>::quiet_NaN();
      if (across.norm() <= kFlat * to.norm()) continue;
      if (!first) first = across;
      side.angle = angle_of(along.dot(first->cross(across)), first->dot(across));
      if (side.angle < -0.5 * kTouching) side.angle += 2.0 * std::numbers::pi;
    }
  }

  /// Pair the sides that bound the same material: each wedge of material lies between two faces
  /// whose normals point away from it. Returns false and changes nothing if the faces are oriented
  /// differently.
  bool connect_walls(std::span<const Side> sides) {
    std::vector<Side> around = in_turn(sides);
    const std::optional<std::size_t> first = first_wedge(around);
    if (!first) return false;
    std::rotate(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(*first), around.end());
    std::vector<Side> opened, closed;
    for (const Side& side : around) (side.forward ? closed : opened).push_back(side);
    for (std::size_t k = 0; k < opened.size(); ++k)
      if (touch(opened[k], closed[k])) return false;
    for (std::size_t k = 0; k < opened.size(); ++k) make_ring(std::array{opened[k], closed[k]});
    return true;
  }

  /// The sides sorted by angle. Of faces that lie on each other, those that end a wedge come first.
  static std::vector<Side> in_turn(std::span<const Side> sides) {
    std::vector<Side> around(sides.begin(), sides.end());
    for (Side& side : around)
      if (std::isnan(side.angle)) side.angle = 0.0;
    std::sort(around.begin(), around.end(), [](const Side& a, const Side& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.half_edge < b.half_edge;
    });
    for (std::size_t k = 1; k < around.size(); ++k)
      if (around[k].angle - around[k - 1].angle <= kTouching) around[k].angle = around[k - 1].angle;
    std::stable_sort(around.begin(), around.end(), [](const Side& a, const Side& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.forward && !b.forward;
    });
    return around;
  }

  /// The start for which no wedge ends before it begins; none if the numbers of ends and beginnings
  /// differ.
  static std::optional<std::size_t> first_wedge(std::span<const Side> around) {
    std::ptrdiff_t depth = 0, least = 0;
    std::size_t first = 0;
    for (std::size_t k = 0; k < around.size(); ++k) {
      depth += around[k].forward ? -1 : 1;
      if (depth < least) {
        least = depth;
        first = k + 1;
      }
    }
    if (depth != 0) return std::nullopt;
    return first;
  }

  static bool touch(const Side& a, const Side& b) {
    const double turn = std::abs(a.angle - b.angle);
    return turn <= kTouching || turn >= 2.0 * std::numbers::pi - kTouching;
  }

  /// Make one ring of all sides except borders of faces that lie on another face.
  void connect_all(std::span<const Side> sides) {
    std::vector<Side> ring;
    for (const Side& side : sides)
      if (!side.border || std::none_of(sides.begin(), sides.end(), [&](const Side& other) {
            return other.half_edge != side.half_edge && touch(side, other);
          }))
        ring.push_back(side);
    if (ring.size() > 1 && std::any_of(ring.begin(), ring.end(), std::mem_fn(&Side::border)))
      make_ring(ring);
  }

  template <typename Sides>
  void make_ring(const Sides& sides) {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const std::int32_t a = sides[k].half_edge, b = sides[(k + 1) % sides.size()].half_edge;
      next_around_[as_size(a)] = b;
      const bool same = sides[k].forward == sides[(k + 1) % sides.size()].forward;
      unite(start(a), same ? start(b) : end(b));
      unite(end(a), same ? end(b) : start(b));
    }
  }

  [[nodiscard]] std::int32_t root(std::int32_t v) {
    while (welded_[as_size(v)] != v)
      v = welded_[as_size(v)] = welded_[as_size(welded_[as_size(v)])];
    return v;
  }
  void unite(std::int32_t a, std::int32_t b) {
    const std::int32_t p = root(a), q = root(b);
    welded_[as_size(std::max(p, q))] = std::min(p, q);
  }

  std::span<const Vec3> vertices_;
  std::span<const Face> faces_;
  const std::vector<bool>& left_out_;  // per face, or empty
  std::vector<std::int32_t>& next_around_;
  Context* context_;
  std::vector<std::int32_t> welded_;  // parent links toward the lowest vertex of each set
  std::vector<bool> border_;          // per vertex
  std::vector<std::int32_t> places_;  // per vertex; empty if there is no border
};

}  // namespace

std::vector<std::int32_t> weld_borders(std::span<const Vec3> vertices, double tolerance,
                                       std::span<const Face> faces,
                                       const std::vector<bool>& left_out,
                                       std::vector<std::int32_t>& next_around, Context* context) {
  return Welder(vertices, tolerance, faces, left_out, next_around, context).run();
}

}  // namespace dapple
