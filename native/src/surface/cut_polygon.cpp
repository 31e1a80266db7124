// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cut_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "surface/constrained_triangulation.hpp"

namespace dapple {
namespace {

using Point = PlaneKernel::Point_2;
using Triangulation = ConstrainedTriangulation;
using Vertex = Triangulation::Vertex_handle;

using Cut = std::array<std::int32_t, 3>;
using Cuts = std::vector<Cut>;

constexpr double kStraight = 1e-9;          // sine of a straight corner
constexpr double kFlat = 1e-9;              // distance from the plane, as a share of the size
constexpr double kNoPlane = 1e-12;          // area, as a share of the squared size
constexpr std::size_t kMostSearched = 200;  // corners: the search takes cubic time

bool all_finite(std::span<const Vec3> corners) {
  return std::all_of(corners.begin(), corners.end(), [](const Vec3& p) { return p.allFinite(); });
}

/// Scales the corners into the unit ball by a power of two, which changes no digits.
std::vector<Vec3> scaled(std::span<const Vec3> corners) {
  double most = 0.0;
  for (const Vec3& p : corners) most = std::max(most, p.cwiseAbs().maxCoeff());
  const double scale = most > 0.0 ? std::ldexp(1.0, -std::clamp(std::ilogb(most), -1000, 1000)) : 1;
  std::vector<Vec3> result;
  result.reserve(corners.size());
  for (const Vec3& p : corners) result.emplace_back(scale * p);
  return result;
}

/// The normal with twice the area as its length (Newell's method).
Vec3 newell(std::span<const Vec3> corners) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < corners.size(); ++k)
    sum += (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]);
  return sum;
}

double size_of(std::span<const Vec3> corners) {
  double size = 0.0;
  for (const Vec3& p : corners) size = std::max(size, (p - corners[0]).norm());
  return size;
}

/// The largest distance of a corner from the plane through the first one.
double off_plane(std::span<const Vec3> corners, const Vec3& normal) {
  double most = 0.0;
  for (const Vec3& p : corners) most = std::max(most, std::abs((p - corners[0]).dot(normal)));
  return most;
}

Cuts fan(std::size_t corners) {
  Cuts cuts;
  for (std::size_t k = 2; k < corners; ++k)
    cuts.push_back({0, static_cast<std::int32_t>(k - 1), static_cast<std::int32_t>(k)});
  return cuts;
}

/// Whether c is clearly to the left of the line from a to b, looking against the normal.
bool left(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  const Vec3 along = b - a, across = c - a;
  return along.cross(across).dot(normal) > kStraight * along.norm() * across.norm();
}

bool convex(std::span<const Vec3> corners, const Vec3& normal) {
  const std::size_t n = corners.size();
  for (std::size_t k = 0; k < n; ++k)
    if (!left(corners[k], corners[(k + 1) % n], corners[(k + 2) % n], normal)) return false;
  for (std::size_t k = 2; k < n; ++k)
    if (!left(corners[0], corners[1], corners[k], normal) ||
        !left(corners[0], corners[k - 1], corners[k], normal))
      return false;
  return true;
}

/// Drops the coordinate along which the projection is largest. The others keep their digits, so
/// collinear points stay collinear.
std::vector<Point> dropped(std::span<const Vec3> corners, const Vec3& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0.0) std::swap(u, v);
  std::vector<Point> points;
  for (const Vec3& p : corners) points.emplace_back(p[u], p[v]);
  return points;
}

/// Projects into the plane perpendicular to the normal.
std::vector<Point> projected(std::span<const Vec3> corners, const Vec3& normal) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Point> points;
  for (const Vec3& p : corners)
    points.emplace_back((p - corners[0]).dot(u), (p - corners[0]).dot(v));
  return points;
}

/// A polygon in the plane whose edges may touch, but not cross.
class FlatPolygon {
 public:
  /// \param places the positions of the corners in space
  /// \return none if edges cross, the polygon has no inside, or different positions coincide in the
  /// plane
  std::optional<Cuts> cut(const std::vector<Point>& corners, std::span<const Vec3> places) {
    for (const Point& p : corners) insert(p);
    const std::size_t n = at_.size();
    for (std::size_t k = 0; k < n; ++k)
      if (places[k] != places[static_cast<std::size_t>(at_[k]->info())]) return std::nullopt;
    try {
      for (std::size_t k = 0; k < n; ++k)
        if (at_[k] != at_[(k + 1) % n]) mesh_.insert_constraint(at_[k], at_[(k + 1) % n]);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      return std::nullopt;
    }
    if (mesh_.dimension() < 2) return std::nullopt;
    for (std::size_t k = 0; k < n; ++k)
      if (!count_edges(at_[k], at_[(k + 1) % n])) return std::nullopt;
    mark_inside(mesh_, [this](Triangulation::Face_handle face, int k) { return crosses(face, k); });
    Cuts cuts = inner();
    return cuts.empty() ? std::nullopt : std::optional(std::move(cuts));  // empty if loops cancel
  }

 private:
  using Edge = std::pair<std::int32_t, std::int32_t>;

  void insert(const Point& point) {
    const std::size_t before = mesh_.number_of_vertices();
    const Vertex vertex = mesh_.insert(point);
    if (mesh_.number_of_vertices() > before) vertex->info() = static_cast<std::int32_t>(at_.size());
    at_.push_back(vertex);
  }

  static Edge between(Vertex a, Vertex b) { return std::minmax(a->info(), b->info()); }

  /// Count the edges on the way from one corner to the next, through all corners that touch it.
  /// Returns false if there is no way.
  bool count_edges(Vertex from, Vertex to) {
    while (from != to) {
      const Vertex next = next_on_way(from, to);
      if (next == Vertex()) return false;
      odd_[between(from, next)] ^= true;
      from = next;
    }
    return true;
  }

  Vertex next_on_way(Vertex from, Vertex to) const {
    auto edge = mesh_.incident_edges(from);
    const auto end = edge;
    do {
      if (mesh_.is_infinite(edge) || !mesh_.is_constrained(*edge)) continue;
      const auto face = edge->first;
      const int k = edge->second;
      const Vertex other = face->vertex(face->cw(k)) == from ? face->vertex(face->ccw(k))
                                                             : face->vertex(face->cw(k));
      if (other == to || CGAL::collinear_are_strictly_ordered_along_line(
                             from->point(), other->point(), to->point()))
        return other;
    } while (++edge != end);
    return {};
  }

  /// Whether the polygon runs along an edge an odd number of times.
  bool crosses(Triangulation::Face_handle face, int k) const {
    if (!face->is_constrained(k)) return false;
    const auto found = odd_.find(between(face->vertex(face->cw(k)), face->vertex(face->ccw(k))));
    return found != odd_.end() && found->second;
  }

  /// The triangles in an order that depends only on the corners.
  [[nodiscard]] Cuts inner() const {
    Cuts cuts;
    for (const auto face : mesh_.finite_face_handles()) {
      if (!face->info().value_or(false)) continue;
      Cut cut = {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
      std::rotate(cut.begin(), std::min_element(cut.begin(), cut.end()), cut.end());
      cuts.push_back(cut);
    }
    std::sort(cuts.begin(), cuts.end());
    return cuts;
  }

  Triangulation mesh_;
  std::vector<Vertex> at_;
  std::map<Edge, bool> odd_;
};

/// The triangulation of least area whose border is the polygon.
class LeastArea {
 public:
  explicit LeastArea(std::span<const Vec3> corners)
      : corners_(corners), area_(corners.size() * corners.size()), middle_(area_.size()) {
    const std::size_t n = corners.size();
    for (std::size_t length = 2; length < n; ++length)
      for (std::size_t first = 0; first + length < n; ++first) choose(first, first + length);
  }

  [[nodiscard]] Cuts cuts() const {
    Cuts found;
    add(0, corners_.size() - 1, found);
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  void choose(std::size_t first, std::size_t last) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = first + 1;
    for (std::size_t k = first + 1; k < last; ++k) {
      const double area =
          area_[at(first, k)] + area_[at(k, last)] +
          (corners_[k] - corners_[first]).cross(corners_[last] - corners_[first]).norm();
      if (area < least) {
        least = area;
        best = k;
      }
    }
    area_[at(first, last)] = least;
    middle_[at(first, last)] = best;
  }

  void add(std::size_t first, std::size_t last, Cuts& found) const {
    if (last < first + 2) return;
    const std::size_t k = middle_[at(first, last)];
    found.push_back({static_cast<std::int32_t>(first), static_cast<std::int32_t>(k),
                     static_cast<std::int32_t>(last)});
    add(first, k, found);
    add(k, last, found);
  }

  [[nodiscard]] std::size_t at(std::size_t first, std::size_t last) const {
    return first * corners_.size() + last;
  }

  std::span<const Vec3> corners_;
  std::vector<double> area_;
  std::vector<std::size_t> middle_;
};

Cuts least_area(std::span<const Vec3> corners) {
  return corners.size() <= kMostSearched ? LeastArea(corners).cuts() : fan(corners.size());
}

}  // namespace

Cuts cut_polygon(std::span<const Vec3> given) {
  if (given.size() <= 3 || !all_finite(given)) return fan(given.size());
  const std::vector<Vec3> corners = scaled(given);
  const Vec3 doubled = newell(corners);
  const double size = size_of(corners);
  if (!(doubled.norm() > kNoPlane * size * size)) return least_area(corners);
  const Vec3 normal = doubled.normalized();
  if (convex(corners, normal)) return fan(corners.size());
  const bool flat = off_plane(corners, normal) <= kFlat * size;
  for (const bool drop : {flat, !flat}) {
    const auto points = drop ? dropped(corners, normal) : projected(corners, normal);
    if (const auto cuts = FlatPolygon().cut(points, corners)) return *cuts;
  }
  return least_area(corners);
}

}  // namespace dapple
