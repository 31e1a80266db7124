// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/dual.hpp"

#include <algorithm>
#include <limits>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/segment.hpp"
#include "base/sort_unique.hpp"
#include "remesh/cell_sides.hpp"
#include "surface/ordered_surface.hpp"
#include "voronoi/cell_builder.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 64;  // cells
constexpr double kShort = 1e-4;     // of the distance of the sites: a side that counts as a point
constexpr double kUnmatchedPart = 1e-2;  // the same, of a side that the neighbor does not know
constexpr double kSamePoint = 1e-6;
constexpr double kCellsPart = 0.7;  // of the progress

/// The sides of all cells, and the mesh of their neighbors.
class SideGraph {
 public:
  /// \param near where two sites on lines meet twice, another is wanted as near as can be: farther
  ///             away its cell would reach the lines
  SideGraph(const CellPieces& pieces, const Sites& sites, std::span<const SiteKind> kinds,
            std::span<const CellSides> cells, bool near)
      : pieces_(pieces), sites_(sites), kinds_(kinds), near_(near) {
    rows_.reserve(cells.size() + 1);
    for (const CellSides& cell : cells) add(cell);
    rows_.push_back(static_cast<std::int32_t>(sides_.size()));
  }

  void match() {
    for (std::int32_t s = 0; s < count(); ++s)
      if (at(s).neighbor >= 0) at(s).twin = twin_of(s);
    for (std::int32_t s = 0; s < count(); ++s)
      if (at(s).twin >= 0 && at(at(s).twin).twin != s) at(s).twin = -1;
  }

  void drop_short(std::vector<Violation>& violations) {
    for (std::int32_t s = 0; s < count(); ++s) {
      Side& side = at(s);
      if (side.neighbor == Side::kLine) continue;
      const double apart =
          side.neighbor >= 0 ? (position(side.neighbor) - position(side.site)).norm() : side.length;
      const double length =
          side.twin >= 0 ? std::max(side.length, at(side.twin).length) : side.length;
      if (side.twin < 0 && length > kUnmatchedPart * apart)
        violations.push_back({side.site, Flaw::kUnmatched, end_of(s), {}});
      side.dropped =
          side.twin < 0 || (length < kShort * apart && !beside_line(s) && !beside_line(side.twin));
    }
  }

  /// Neighbors that meet more than once.
  void find_repeated(std::vector<Violation>& violations) const {
    std::vector<std::array<std::int32_t, 2>> met;  // neighbor, side
    for (std::size_t site = 0; site + 1 < rows_.size(); ++site) {
      met.clear();
      for (std::int32_t s = rows_[site]; s < rows_[site + 1]; ++s)
        if (counts(s)) met.push_back({at(s).neighbor, s});
      std::ranges::sort(met);
      for (std::size_t k = 1; k < met.size(); ++k)
        if (met[k][0] == met[k - 1][0] && !same_edge(met[k - 1][1], met[k][1]))
          violations.push_back({static_cast<std::int32_t>(site),
                                Flaw::kMetTwice,
                                farther_end(met[k - 1][1], met[k][1]),
                                {}});
    }
  }

  /// The neighbors that meet on lines.
  [[nodiscard]] std::vector<std::array<std::int32_t, 2>> edges_on_lines() const {
    std::vector<std::array<std::int32_t, 2>> result;
    for (std::int32_t s = 0; s < count(); ++s)
      if (counts(s) && beside_line(s))
        result.push_back(
            {std::min(at(s).site, at(s).neighbor), std::max(at(s).site, at(s).neighbor)});
    sort_unique(result);
    return result;
  }

  /// The cells around each point where three or more meet.
  template <typename Visit>
  void for_each_corner(std::vector<Violation>& violations, const Visit& visit) const {
    std::vector<bool> seen(sides_.size(), false);
    std::vector<std::int32_t> around;
    for (std::int32_t s = 0; s < count(); ++s) {
      if (seen[as_index(s)] || !is_corner(s)) continue;
      around.clear();
      bool closed = true;
      for (std::int32_t c = s; !seen[as_index(c)];) {
        seen[as_index(c)] = true;
        around.push_back(at(c).site);
        c = before(at(c).twin);
        closed = counts(c) && is_corner(c) && (!seen[as_index(c)] || c == s);
        if (!closed) break;
      }
      if (!closed || around.size() < 3)
        violations.push_back({at(s).site, Flaw::kUnmatched, end_of(s), {}});
      else
        visit(around, corner_of(s));
    }
  }

 private:
  void add(const CellSides& cell) {
    const auto first = static_cast<std::int32_t>(sides_.size());
    rows_.push_back(first);
    for (Side side : cell.sides) {
      side.before += first;
      side.after += first;
      sides_.push_back(side);
    }
  }

  [[nodiscard]] std::int32_t count() const { return static_cast<std::int32_t>(sides_.size()); }
  [[nodiscard]] Side& at(std::int32_t s) { return sides_[as_index(s)]; }
  [[nodiscard]] const Side& at(std::int32_t s) const { return sides_[as_index(s)]; }
  [[nodiscard]] const Vec3& position(std::int32_t site) const {
    return sites_.positions[as_index(site)];
  }
  [[nodiscard]] bool counts(std::int32_t s) const {
    return s >= 0 && at(s).neighbor >= 0 && !at(s).dropped;
  }

  /// The side of the neighbor at the same place.
  [[nodiscard]] std::int32_t twin_of(std::int32_t s) const {
    const Side& side = at(s);
    std::int32_t found = -1;
    int candidates = 0;
    for (std::int32_t t = rows_[as_index(side.neighbor)]; t < rows_[as_index(side.neighbor) + 1];
         ++t)
      if (at(t).neighbor == side.site) {
        found = t;
        ++candidates;
      }
    return candidates <= 1 ? found : nearest_twin(s);
  }

  /// Of several candidates the one whose ends are nearest.
  [[nodiscard]] std::int32_t nearest_twin(std::int32_t s) const {
    const Side& side = at(s);
    double least = std::numeric_limits<double>::infinity();
    std::int32_t found = -1;
    for (std::int32_t t = rows_[as_index(side.neighbor)]; t < rows_[as_index(side.neighbor) + 1];
         ++t) {
      if (at(t).neighbor != side.site) continue;
      double apart = (start(s) - finish(t)).norm() + (finish(s) - start(t)).norm();
      apart += middle(s, t);  // both sheets of a line may have the same ends
      if (apart < least) found = t;
      least = std::min(least, apart);
    }
    return found;
  }

  /// Distance between the middles of the longest edges of two sides.
  [[nodiscard]] double middle(std::int32_t s, std::int32_t t) const {
    const auto of = [&](std::int32_t k) {
      const std::int32_t e = at(k).longest;
      return Vec3(0.5 * (pieces_.from(e) + pieces_.to(e)));
    };
    return (of(s) - of(t)).norm();
  }

  [[nodiscard]] const Vec3& start(std::int32_t s) const { return pieces_.from(at(s).first); }
  [[nodiscard]] const Vec3& finish(std::int32_t s) const { return pieces_.to(at(s).last); }

  [[nodiscard]] std::int32_t before(std::int32_t s) const {
    std::int32_t b = at(s).before;
    for (std::size_t k = 0; k < sides_.size() && at(b).dropped && b != s; ++k) b = at(b).before;
    return b;
  }
  [[nodiscard]] std::int32_t after(std::int32_t s) const {
    std::int32_t a = at(s).after;
    for (std::size_t k = 0; k < sides_.size() && at(a).dropped && a != s; ++k) a = at(a).after;
    return a;
  }
  [[nodiscard]] bool beside_line(std::int32_t s) const {
    return at(at(s).before).neighbor == Side::kLine || at(at(s).after).neighbor == Side::kLine;
  }

  /// Whether another cell follows after a side: a corner of the border between two cells.
  [[nodiscard]] bool is_corner(std::int32_t s) const { return counts(s) && counts(after(s)); }

  /// Whether two sides with one neighbor lie on both sides of a line, and end at the same point of
  /// it.
  [[nodiscard]] bool same_edge(std::int32_t s, std::int32_t t) const {
    const auto ends = [&](std::int32_t k, std::vector<Vec3>& points) {
      if (at(before(k)).neighbor == Side::kLine) points.push_back(start(k));
      if (at(after(k)).neighbor == Side::kLine) points.push_back(finish(k));
    };
    std::vector<Vec3> a, b;
    ends(s, a);
    ends(t, b);
    const double tolerance = kSamePoint * (position(at(s).site) - position(at(s).neighbor)).norm();
    for (const Vec3& p : a)
      for (const Vec3& q : b)
        if ((p - q).norm() <= tolerance) return true;
    return false;
  }

  /// Where the cells around a corner meet.
  [[nodiscard]] Place corner_of(std::int32_t s) const {
    return {.position = finish(s), .face = pieces_.face_of_piece(pieces_.piece_of(at(s).last))};
  }
  [[nodiscard]] Place end_of(std::int32_t s) const {
    const std::int32_t e = at(s).longest;
    return {.position = 0.5 * (pieces_.from(e) + pieces_.to(e)),
            .face = pieces_.face_of_piece(pieces_.piece_of(e))};
  }
  /// Where a side meets a line; elsewhere its middle.
  [[nodiscard]] Place end_on_line(std::int32_t s) const {
    const Side &left = at(before(s)), &right = at(after(s));
    if (left.neighbor == Side::kLine) return place_on_line(left.last, 1.0);
    if (right.neighbor == Side::kLine) return place_on_line(right.first, 0.0);
    return end_of(s);
  }
  [[nodiscard]] Place place_on_line(std::int32_t e, double share) const {
    return {.position = pieces_.from(e) + share * (pieces_.to(e) - pieces_.from(e)),
            .face = pieces_.face_of_piece(pieces_.piece_of(e)),
            .half_edge = pieces_.half_edge(e)};
  }
  /// The place of a side that is nearest to its site.
  [[nodiscard]] Place nearest_of(std::int32_t s) const {
    const std::int32_t e = at(s).nearest;
    const Vec3 &from = pieces_.from(e), &to = pieces_.to(e);
    return {.position = from + nearest_share(position(at(s).site), from, to) * (to - from),
            .face = pieces_.face_of_piece(pieces_.piece_of(e))};
  }
  [[nodiscard]] bool is_on_line(std::int32_t site) const {
    return kinds_[as_index(site)] != SiteKind::kFree;
  }
  [[nodiscard]] Place farther_end(std::int32_t s, std::int32_t t) const {
    const bool near = near_ && is_on_line(at(s).site) && is_on_line(at(s).neighbor);
    const Place a = near ? nearest_of(s) : end_on_line(s),
                b = near ? nearest_of(t) : end_on_line(t);
    const Vec3& site = position(at(s).site);
    return (a.position - site).squaredNorm() >= (b.position - site).squaredNorm() ? a : b;
  }

  const CellPieces& pieces_;
  const Sites& sites_;
  std::span<const SiteKind> kinds_;
  bool near_;
  std::vector<Side> sides_;
  std::vector<std::int32_t> rows_;  // per site, one more
};

/// Triangles of the same three sites, as the two sides of a flat body have them.
void find_repeated_triangles(std::span<const Face> triangles, std::span<const Place> places,
                             std::vector<Violation>& violations) {
  std::vector<std::array<std::int32_t, 4>> sorted;  // sites, triangle
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    Face t = triangles[k];
    std::ranges::sort(t);
    sorted.push_back({t[0], t[1], t[2], static_cast<std::int32_t>(k)});
  }
  parallel_sort(sorted);
  for (std::size_t k = 1; k < sorted.size(); ++k)
    if (std::equal(sorted[k].begin(), sorted[k].begin() + 3, sorted[k - 1].begin()))
      violations.push_back({sorted[k][0], Flaw::kMetTwice, places[as_index(sorted[k][3])], {}});
}

/// The pieces of the cells. Thin walls keep their rims: a site on the edge of one belongs to both
/// of its sides.
std::vector<CellPolygon> polygons_of(const Surface& surface, const Sites& sites, Cells cells,
                                     Context* context) {
  CellBuilder builder(surface);
  RestrictedVoronoi diagram;
  builder.build_by_floods(sites, nullptr, cells, /*leaves_gaps=*/false, context, diagram);
  return builder.polygons(nullptr);
}

double smallest_cosine_first(const Vec3& a, const Vec3& b, const Vec3& c) {
  double most = -1.0;  // largest cosine, of the smallest angle
  const std::array<Vec3, 3> p = {a, b, c};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
    const double lengths = u.norm() * v.norm();
    most = std::max(most, lengths > 0.0 ? u.dot(v) / lengths : 1.0);
  }
  return most;
}

}  // namespace

void find_repeated_edges(std::span<const Face> triangles, std::span<const Place> places,
                         std::span<const Vec3> positions, std::span<const SiteKind> kinds,
                         std::vector<Violation>& violations) {
  std::vector<std::array<std::int32_t, 3>> edges;  // from, to, triangle
  for (std::size_t k = 0; k < triangles.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      edges.push_back({triangles[k][c], triangles[k][(c + 1) % 3], static_cast<std::int32_t>(k)});
  parallel_sort(edges);
  for (std::size_t k = 1; k < edges.size(); ++k) {
    const auto& [from, to, triangle] = edges[k - 1];
    if (from != edges[k][0] || to != edges[k][1]) continue;
    if (kinds[as_index(from)] != SiteKind::kFree && kinds[as_index(to)] != SiteKind::kFree)
      continue;
    const Place &one = places[as_index(triangle)], &other = places[as_index(edges[k][2])];
    const Vec3& site = positions[as_index(from)];
    const bool nearer = (one.position - site).norm() < (other.position - site).norm();
    violations.push_back({from, Flaw::kMetTwice, nearer ? other : one, {}});
  }
}

void add_triangles(std::span<const std::int32_t> polygon, std::span<const Vec3> positions,
                   std::vector<Face>& triangles) {
  const std::size_t n = polygon.size();
  if (n == 3) return triangles.push_back({polygon[0], polygon[1], polygon[2]});
  const auto point = [&](std::size_t k) -> const Vec3& { return positions[as_index(polygon[k])]; };
  // worst[i][j]: the largest cosine within the part from i to j, if it is divided best
  std::vector<double> worst(n * n, -1.0);
  std::vector<std::size_t> middle(n * n, 0);
  for (std::size_t width = 2; width < n; ++width)
    for (std::size_t i = 0; i + width < n; ++i) {
      const std::size_t j = i + width;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t m = i + 1; m < j; ++m) {
        const double cosine = std::max({worst[i * n + m], worst[m * n + j],
                                        smallest_cosine_first(point(i), point(m), point(j))});
        if (cosine < best) middle[i * n + j] = m;
        best = std::min(best, cosine);
      }
      worst[i * n + j] = best;
    }
  std::vector<std::array<std::size_t, 2>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const std::size_t m = middle[i * n + j];
    triangles.push_back({polygon[i], polygon[m], polygon[j]});
    open.push_back({i, m});
    open.push_back({m, j});
  }
}

namespace {

/// Free the memory of many polygons, which takes as long as to make them.
void release(std::vector<CellPolygon>& polygons) {
  parallel_chunks(polygons.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) polygons[p] = {};
  });
}

Dual dual_of(const Surface& surface, const FeatureLines& lines, const Sites& sites,
             std::span<const SiteKind> kinds, std::vector<CellPolygon> polygons, bool near,
             Context* context) {
  const CellPieces pieces(surface, lines, polygons, sites.size());
  release(polygons);
  std::vector<CellSides> of_cells(sites.size());
  parallel_chunks(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    CellWalk walk(surface, lines, pieces, sites, kinds);
    for (std::size_t k = begin; k < end; ++k) of_cells[k] = walk.sides_of(k);
  });
  Dual result;
  for (const CellSides& cell : of_cells)
    result.violations.insert(result.violations.end(), cell.violations.begin(),
                             cell.violations.end());
  SideGraph graph(pieces, sites, kinds, of_cells, near);
  graph.match();
  graph.drop_short(result.violations);
  graph.find_repeated(result.violations);
  graph.for_each_corner(result.violations,
                        [&](std::span<const std::int32_t> around, const Place& place) {
                          add_triangles(around, sites.positions, result.triangles);
                          result.corners.resize(result.triangles.size(), place);
                        });
  find_repeated_triangles(result.triangles, result.corners, result.violations);
  result.lines = graph.edges_on_lines();
  if (result.violations.empty())
    find_repeated_edges(result.triangles, result.corners, sites.positions, kinds,
                        result.violations);
  if (context) context->advance(1.0);
  return result;
}

}  // namespace

Dual dual_of(const Surface& surface, const FeatureLines& lines, const Sites& sites,
             std::span<const SiteKind> kinds, Cells cells, Context* context) {
  Stretch cutting(context, 0.0, kCellsPart);
  return dual_of(surface, lines, sites, kinds,
                 polygons_of(surface, sites, cells, cutting.context()), false, context);
}

Dual dual_of(const Surface& surface, const FeatureLines& lines, const Sites& sites,
             std::span<const SiteKind> kinds, const CellsAlong& cells, Context* context) {
  Stretch cutting(context, 0.0, kCellsPart);
  return dual_of(surface, lines, sites, kinds, cells.polygons(sites, cutting.context()), true,
                 context);
}

}  // namespace dapple
