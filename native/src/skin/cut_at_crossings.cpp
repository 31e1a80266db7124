// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/cut_at_crossings.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/triangle.hpp"
#include "density/pieces.hpp"
#include "skin/crossings.hpp"
#include "skin/cut_face.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/places.hpp"

namespace dapple {
namespace {

constexpr double kFound = 0.5;  // share of the progress when all crossings are known
constexpr double kSnap = 1e-7;  // of the diagonal: points this close are one
constexpr std::int32_t kNew = -1;

/// A point of a cut face.
struct LocalPoint {
  std::int32_t crossing = kNew;  // kNew for a corner and where lines cross
  std::int32_t side = kNew;      // of the face, kNew within it and for a corner
  Vec3 weights = Vec3::Zero();   // barycentric coordinates in the face
};

/// A face with its crossings, in a plane of its own.
struct LocalFace {
  std::int32_t parent = 0;  // the caller's index
  std::vector<LocalPoint> points;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Two places with a number for the edge between them.
class EdgeNumbers {
 public:
  explicit EdgeNumbers(std::int32_t first) : next_(first) {}

  /// Equal numbers for equal ends, except for an edge that ends where it starts.
  std::int32_t between(std::int32_t a, std::int32_t b) {
    if (a == b) return next_++;
    const auto [found, added] = numbers_.try_emplace(std::minmax(a, b), next_);
    if (added) ++next_;
    return found->second;
  }

 private:
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> numbers_;
  std::int32_t next_;
};

class Cutter {
 public:
  Cutter(const Surface& surface, const Crossings& crossings, Context* context)
      : surface_(surface),
        mesh_(surface.ordered()),
        crossings_(crossings),
        context_(context),
        vertices_(surface.vertices()),
        faces_(surface.faces()),
        welded_(welded_vertices(surface)),
        result_{surface, surface, {}, {}, {}, {}, true} {}

  Refined run() {
    cut_faces();
    find_places();
    build();
    return finish();
  }

 private:
  [[nodiscard]] const Crossing& crossing(std::int32_t k) const {
    return crossings_.points[static_cast<std::size_t>(k)];
  }

  /// The crossings on an edge, by their indices.
  [[nodiscard]] std::pair<std::int32_t, std::int32_t> on_edge(std::int32_t edge) const {
    const auto [first, last] =
        std::equal_range(crossings_.points.begin(), crossings_.points.end(), Crossing{.edge = edge},
                         [](const Crossing& a, const Crossing& b) { return a.edge < b.edge; });
    return {static_cast<std::int32_t>(first - crossings_.points.begin()),
            static_cast<std::int32_t>(last - crossings_.points.begin())};
  }

  [[nodiscard]] std::span<const CrossingLine> lines_in(OrderedFace face) const {
    const auto [first, last] = std::equal_range(
        crossings_.lines.begin(), crossings_.lines.end(), CrossingLine{.face = face},
        [](const CrossingLine& a, const CrossingLine& b) { return a.face < b.face; });
    return {first, last};
  }

  [[nodiscard]] bool is_cut(OrderedFace face) const {
    if (!lines_in(face).empty()) return true;
    for (std::int32_t k = 0; k < 3; ++k) {
      const auto [first, last] = on_edge(edge_of(mesh_, half_edge(face, k)));
      if (first != last) return true;
    }
    return false;
  }

  void cut_faces() {
    std::vector<std::int32_t> cut;
    for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces_.size()); ++f) {
      check_at(context_, static_cast<std::size_t>(f));
      const OrderedFace face = mesh_.ordered_face(f);
      if (mesh_.counts(face) && mesh_.geometry(face).moments.area > 0.0 && is_cut(face))
        cut.push_back(f);
    }
    cut_.resize(cut.size());
    parallel_chunks(cut.size(), 16, [&](std::size_t begin, std::size_t end) {
      check_context(context_);
      for (std::size_t k = begin; k < end; ++k) cut_[k] = cut_one(cut[k]);
    });
  }

  /// Points on the sides of a face, and the segments of its border that they divide.
  void add_sides(LocalFace& local, OrderedFace face,
                 std::vector<std::array<std::int32_t, 2>>& segments) const {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = half_edge(face, k);
      auto [first, last] = on_edge(edge_of(mesh_, h));
      std::vector<std::pair<double, std::int32_t>> along;
      const Face welded = mesh_.welded_corners(face);
      const bool forward = welded[as_index(k)] < welded[as_index((k + 1) % 3)];
      for (; first < last; ++first)
        along.emplace_back(forward ? crossing(first).share : 1.0 - crossing(first).share, first);
      std::sort(along.begin(), along.end());
      std::int32_t from = k;
      for (const auto& [share, index] : along) {
        Vec3 weights = Vec3::Zero();
        weights[k] = 1.0 - share;
        weights[(k + 1) % 3] = share;
        const auto added = static_cast<std::int32_t>(local.points.size());
        local.points.push_back({index, k, weights});
        segments.push_back({from, added});
        from = added;
      }
      segments.push_back({from, (k + 1) % 3});
    }
  }

  [[nodiscard]] std::array<Vec3, 3> corners(OrderedFace face) const {
    const auto [a, b, c] = mesh_.corners(face);
    return {mesh_.vertex(a), mesh_.vertex(b), mesh_.vertex(c)};
  }

  /// The index of a crossing among the points of a face; it is added if it lies within the face.
  std::int32_t index_of(std::int32_t index, LocalFace& local, OrderedFace face) const {
    for (std::size_t k = 3; k < local.points.size(); ++k)
      if (local.points[k].crossing == index) return static_cast<std::int32_t>(k);
    const auto [a, b, c] = corners(face);
    local.points.push_back({index, kNew, closest_barycentric(crossing(index).position, a, b, c)});
    return static_cast<std::int32_t>(local.points.size() - 1);
  }

  [[nodiscard]] LocalFace cut_one(std::int32_t parent) const {
    const OrderedFace face = mesh_.ordered_face(parent);
    LocalFace local{parent, {}, {}};
    for (Eigen::Index k = 0; k < 3; ++k) local.points.push_back({kNew, kNew, Vec3::Unit(k)});
    std::vector<std::array<std::int32_t, 2>> segments;
    add_sides(local, face, segments);
    for (const CrossingLine& line : lines_in(face)) {
      const std::int32_t a = index_of(line.ends[0], local, face);
      segments.push_back({a, index_of(line.ends[1], local, face)});
    }
    triangulate(local, face, segments);
    return local;
  }

  void triangulate(LocalFace& local, OrderedFace face,
                   std::span<const std::array<std::int32_t, 2>> segments) const {
    const auto at = corners(face);
    const Vec3 x = (at[1] - at[0]).normalized();
    const Vec3 y = mesh_.geometry(face).normal.cross(x);
    const std::array<Vec2, 3> flat = {Vec2::Zero(), Vec2((at[1] - at[0]).dot(x), 0.0),
                                      Vec2((at[2] - at[0]).dot(x), (at[2] - at[0]).dot(y))};
    std::vector<Vec2> points;
    points.reserve(local.points.size());
    for (const LocalPoint& p : local.points)
      points.emplace_back(p.weights[0] * flat[0] + p.weights[1] * flat[1] + p.weights[2] * flat[2]);
    CutFace cut = cut_face(points, segments);
    for (std::size_t k = local.points.size(); k < cut.points.size(); ++k) {
      const Vec3 place = at[0] + cut.points[k].x() * x + cut.points[k].y() * y;
      local.points.push_back({kNew, kNew, closest_barycentric(place, at[0], at[1], at[2])});
    }
    local.triangles = std::move(cut.triangles);
    // Points on a side lie beside it by rounding; the slivers between have no area.
    std::erase_if(local.triangles,
                  [&](const auto& triangle) { return on_one_side(local, triangle); });
  }

  /// Whether all corners of a triangle lie on one side of its face.
  static bool on_one_side(const LocalFace& local, const std::array<std::int32_t, 3>& triangle) {
    for (std::int32_t side = 0; side < 3; ++side)
      if (std::all_of(triangle.begin(), triangle.end(), [&](std::int32_t k) {
            return k < 3 ? k == side || k == (side + 1) % 3
                         : local.points[static_cast<std::size_t>(k)].side == side;
          }))
        return true;
    return false;
  }

  /// Numbers places: welded vertices first, then crossings, then points where lines cross. Points
  /// very close to an earlier one have its number.
  void find_places() {
    std::vector<Vec3> spots = vertices_;
    for (const Crossing& point : crossings_.points) spots.push_back(point.position);
    for (const LocalFace& local : cut_)
      for (const LocalPoint& point : local.points)
        if (is_new(local, point)) spots.push_back(surface_.point(local.parent, point.weights));
    Eigen::AlignedBox3d box;
    for (const Vec3& p : spots) box.extend(p);
    Places places(spots, kSnap * box.diagonal().norm());
    std::vector<bool> added(vertices_.size(), false);
    for (const LocalFace& local : cut_)
      for (const std::int32_t v : faces_[static_cast<std::size_t>(local.parent)]) {
        const std::int32_t place = welded_[static_cast<std::size_t>(v)];
        if (!added[static_cast<std::size_t>(place)]) places.add(place);
        added[static_cast<std::size_t>(place)] = true;
      }
    place_of_.resize(spots.size());
    for (std::size_t k = 0; k < vertices_.size(); ++k) place_of_[k] = welded_[k];
    for (std::size_t k = vertices_.size(); k < spots.size(); ++k) {
      check_at(context_, k);
      const std::int32_t found = places.find(spots[k]);
      place_of_[k] = found < 0 ? static_cast<std::int32_t>(k) : found;
      if (found < 0) places.add(static_cast<std::int32_t>(k));
    }
  }

  static bool is_new(const LocalFace& local, const LocalPoint& point) {
    return point.crossing == kNew && &point - local.points.data() >= 3;
  }

  void build() {
    // Numbers of whole edges are half-edges; those of parts of edges come after them.
    EdgeNumbers parts(static_cast<std::int32_t>(3 * faces_.size()));
    places_ = welded_;
    next_new_ = static_cast<std::int32_t>(vertices_.size() + crossings_.points.size());
    std::size_t next_cut = 0;
    for (std::int32_t f = 0; f < static_cast<std::int32_t>(faces_.size()); ++f) {
      check_at(context_, static_cast<std::size_t>(f));
      if (!mesh_.counts(mesh_.ordered_face(f))) continue;
      if (next_cut < cut_.size() && cut_[next_cut].parent == f)
        add_pieces(cut_[next_cut++], parts);
      else
        add_whole(f);
    }
  }

  [[nodiscard]] std::int32_t whole_edge(std::int32_t face, std::int32_t side) const {
    return edge_of(mesh_, half_edge(mesh_.ordered_face(face), side));
  }

  void add_whole(std::int32_t face) {
    result_.parents.push_back(face);
    result_.barycentric.push_back({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
    new_faces_.push_back(faces_[static_cast<std::size_t>(face)]);
    for (std::int32_t k = 0; k < 3; ++k) edges_.push_back(whole_edge(face, k));
  }

  void add_pieces(const LocalFace& local, EdgeNumbers& parts) {
    std::vector<std::int32_t> vertices;
    vertices.reserve(local.points.size());
    for (const LocalPoint& point : local.points) vertices.push_back(add_vertex(local, point));
    for (const auto& triangle : local.triangles) {
      Face face{};
      std::array<Vec3, 3> weights;
      for (std::size_t k = 0; k < 3; ++k) {
        face[k] = vertices[static_cast<std::size_t>(triangle[k])];
        weights[k] = local.points[static_cast<std::size_t>(triangle[k])].weights;
        const std::int32_t a = triangle[k], b = triangle[(k + 1) % 3];
        const bool whole = a < 3 && b < 3 && b == (a + 1) % 3;
        const auto place = [&](std::int32_t point) {
          return places_[static_cast<std::size_t>(vertices[static_cast<std::size_t>(point)])];
        };
        edges_.push_back(whole ? whole_edge(local.parent, a) : parts.between(place(a), place(b)));
      }
      result_.parents.push_back(local.parent);
      result_.barycentric.push_back(weights);
      new_faces_.push_back(face);
    }
  }

  /// The vertex of a point of a cut face: one of the surface's, or an added one.
  std::int32_t add_vertex(const LocalFace& local, const LocalPoint& point) {
    const Face& face = faces_[static_cast<std::size_t>(local.parent)];
    const std::ptrdiff_t index = &point - local.points.data();
    if (index < 3) return face[static_cast<std::size_t>(index)];
    const std::int32_t spot = point.crossing == kNew
                                  ? next_new_++
                                  : static_cast<std::int32_t>(vertices_.size()) + point.crossing;
    const std::int32_t place = place_of_[static_cast<std::size_t>(spot)];
    if (point.side != kNew) {
      const auto k = static_cast<std::size_t>(point.side);
      return add_between(face[k], face[(k + 1) % 3], point.weights[(point.side + 1) % 3], place);
    }
    // Between the corner of the largest weight and the point beyond it on the opposite side.
    Eigen::Index corner = 0;
    point.weights.maxCoeff(&corner);
    const Eigen::Index next = (corner + 1) % 3, last = (corner + 2) % 3;
    const double beyond = point.weights[next] + point.weights[last];
    const std::int32_t opposite =
        add_between(face[static_cast<std::size_t>(next)], face[static_cast<std::size_t>(last)],
                    beyond > 0.0 ? point.weights[last] / beyond : 0.5, kNew);
    return add_between(face[static_cast<std::size_t>(corner)], opposite, beyond, place);
  }

  /// \param place kNew for a vertex that no face has
  std::int32_t add_between(std::int32_t a, std::int32_t b, double share, std::int32_t place) {
    const auto added = static_cast<std::int32_t>(places_.size());
    result_.ends.push_back({a, b});
    result_.shares.push_back(share);
    // A place is named by its first vertex.
    const auto first = place < 0 ? added : first_at_.try_emplace(place, added).first->second;
    const bool is_vertex = place >= 0 && place < static_cast<std::int32_t>(vertices_.size());
    places_.push_back(is_vertex ? place : first);
    return added;
  }

  /// Per new face: parts of the surface that are not connected are bodies of their own, unless the
  /// surface knows better.
  [[nodiscard]] std::vector<std::int32_t> bodies() const {
    std::vector<std::int32_t> result = carried_bodies(surface_, result_.parents);
    if (!result.empty() || mesh_.components() == 1) return result;
    result.reserve(result_.parents.size());
    for (const std::int32_t parent : result_.parents)
      result.push_back(mesh_.component(mesh_.ordered_face(parent)));
    return result;
  }

  Refined finish() {
    const std::vector<double> density = carried_density(surface_, result_, context_);
    const std::vector<std::int32_t> found = bodies();
    result_.surface =
        Surface(result_.vertices(vertices_), new_faces_, Density{DensityAt::kCorners, density},
                Joints{edges_, places_, found}, surface_.sharp_angle(), /*merge_doubled=*/false,
                context_, carried_normals(surface_, result_, context_));
    return std::move(result_);
  }

  const Surface& surface_;
  const OrderedSurface& mesh_;
  const Crossings& crossings_;
  Context* context_;
  std::vector<Vec3> vertices_;
  std::vector<Face> faces_;
  std::vector<std::int32_t> welded_;  // per vertex
  Refined result_;
  std::vector<LocalFace> cut_;          // in the order of their parents
  std::vector<std::int32_t> place_of_;  // per vertex, crossing and point where lines cross
  std::map<std::int32_t, std::int32_t> first_at_;  // per place that is no vertex's
  std::int32_t next_new_ = 0;
  std::vector<Face> new_faces_;
  std::vector<std::int32_t> edges_;   // per corner of a new face
  std::vector<std::int32_t> places_;  // per new vertex
};

}  // namespace

Refined cut_at_crossings(const Surface& surface, Context* context) {
  Stretch finding(context, 0.0, kFound);
  const Crossings crossings = find_crossings(surface, finding.context());
  Stretch cutting(context, kFound, 1.0);
  return Cutter(surface, crossings, cutting.context()).run();
}

}  // namespace dapple
