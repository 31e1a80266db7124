// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/crossings.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "base/triangle.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

using SpaceKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Pair = std::pair<OrderedFace, OrderedFace>;

constexpr double kPaired = 0.4;  // share of the progress when all pairs of boxes are known

/// The bounding box of a face, as CGAL's search wants it.
struct FaceBox {
  using NT = double;
  using ID = std::size_t;

  FaceBox(const OrderedSurface& mesh, OrderedFace of) : face(of) {
    for (const std::int32_t v : mesh.welded_corners(of)) box.extend(mesh.vertex(v));
  }
  static int dimension() { return 3; }
  [[nodiscard]] ID id() const { return as_index(face); }
  [[nodiscard]] double min_coord(int axis) const { return box.min()[axis]; }
  [[nodiscard]] double max_coord(int axis) const { return box.max()[axis]; }

  OrderedFace face;
  Eigen::AlignedBox3d box;
};

/// Pairs of faces without a common vertex whose boxes overlap, sorted.
std::vector<Pair> near_pairs(const OrderedSurface& mesh, Context* context) {
  std::vector<FaceBox> boxes;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    check_at(context, f);
    if (mesh.counts(nth_face(f)) && mesh.geometry(nth_face(f)).moments.area > 0.0)
      boxes.emplace_back(mesh, nth_face(f));
  }
  std::vector<Pair> pairs;
  std::size_t calls = 0;
  CGAL::box_self_intersection_d(
      boxes.begin(), boxes.end(), [&](const FaceBox& a, const FaceBox& b) {
        check_at(context, calls++);
        if (!share_vertex(mesh.welded_corners(a.face), mesh.welded_corners(b.face)))
          pairs.push_back(std::minmax(a.face, b.face));
      });
  parallel_sort(pairs);
  return pairs;
}

/// Tests edges against faces.
///
/// Where a predicate is zero the sign is taken as positive for the vertices in ascending order.
/// So of the two faces at an edge that another edge touches exactly one is passed through.
class EdgeTest {
 public:
  explicit EdgeTest(const OrderedSurface& mesh) : mesh_(mesh) {}

  /// The two ends of the segment that faces have in common; empty if they do not cross.
  [[nodiscard]] std::vector<Crossing> common(OrderedFace a, OrderedFace b) const {
    std::vector<Crossing> found;
    add(a, b, found);
    add(b, a, found);
    if (found.size() < 2) return {};
    // More than two only if a vertex or an edge of one lies in the other.
    std::pair<std::size_t, std::size_t> farthest{0, 1};
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = i + 1; k < found.size(); ++k)
        if (length(found[i], found[k]) > length(found[farthest.first], found[farthest.second]))
          farthest = {i, k};
    return {found[farthest.first], found[farthest.second]};
  }

 private:
  static double length(const Crossing& a, const Crossing& b) {
    return (a.position - b.position).squaredNorm();
  }

  [[nodiscard]] int orientation(std::int32_t a, std::int32_t b, std::int32_t c,
                                std::int32_t d) const {
    const auto point = [&](std::int32_t v) {
      const Vec3& p = mesh_.vertex(v);
      return SpaceKernel::Point_3(p.x(), p.y(), p.z());
    };
    const auto sign = CGAL::orientation(point(a), point(b), point(c), point(d));
    return sign == CGAL::NEGATIVE ? -1 : 1;
  }

  /// Where edges of one face pass through the other.
  void add(OrderedFace edges_of, OrderedFace face, std::vector<Crossing>& found) const {
    const Face corners = mesh_.welded_corners(edges_of);
    const Face through = mesh_.welded_corners(face);
    std::array<int, 3> sides{};
    for (std::size_t k = 0; k < 3; ++k)
      sides[k] = orientation(through[0], through[1], through[2], corners[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [p, q] = std::minmax(corners[k], corners[(k + 1) % 3]);
      if (sides[k] == sides[(k + 1) % 3] || !passes_inside(p, q, through)) continue;
      const double share = share_at(p, q, through);
      found.push_back({edge_of(mesh_, half_edge(edges_of, static_cast<std::int32_t>(k))), face,
                       share, between(mesh_.vertex(p), mesh_.vertex(q), share)});
    }
  }

  /// Whether the line through two vertices passes through a face.
  [[nodiscard]] bool passes_inside(std::int32_t p, std::int32_t q, const Face& face) const {
    int sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = face[k], b = face[(k + 1) % 3];
      sum += a < b ? orientation(p, q, a, b) : -orientation(p, q, b, a);
    }
    return std::abs(sum) == 3;
  }

  /// Where the edge between two vertices meets the plane of a face.
  [[nodiscard]] double share_at(std::int32_t p, std::int32_t q, const Face& face) const {
    const Vec3& corner = mesh_.vertex(face[0]);
    const Vec3 normal =
        (mesh_.vertex(face[1]) - corner).cross(mesh_.vertex(face[2]) - corner).stableNormalized();
    const double from = (mesh_.vertex(p) - corner).dot(normal);
    const double to = (mesh_.vertex(q) - corner).dot(normal);
    return from == to ? 0.5 : std::clamp(from / (from - to), 0.0, 1.0);
  }

  const OrderedSurface& mesh_;
};

/// Per pair of faces, the ends of the segment that they have in common.
std::vector<std::vector<Crossing>> common_segments(const OrderedSurface& mesh,
                                                   const std::vector<Pair>& pairs,
                                                   Context* context) {
  const EdgeTest test(mesh);
  std::vector<std::vector<Crossing>> ends(pairs.size());
  parallel_chunks(pairs.size(), 256, [&](std::size_t begin, std::size_t end) {
    check_context(context);
    for (std::size_t k = begin; k < end; ++k)
      ends[k] = test.common(pairs[k].first, pairs[k].second);
  });
  return ends;
}

}  // namespace

bool share_vertex(const Face& a, const Face& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](std::int32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

Crossings find_crossings(const Surface& surface, Context* context) {
  Stretch pairing(context, 0.0, kPaired);
  const std::vector<Pair> pairs = near_pairs(surface.ordered(), pairing.context());
  Stretch testing(context, kPaired, 1.0);
  const auto ends = common_segments(surface.ordered(), pairs, testing.context());
  Crossings result;
  for (const auto& segment : ends)
    result.points.insert(result.points.end(), segment.begin(), segment.end());
  sort_unique(result.points);
  const auto index = [&](const Crossing& crossing) {
    return static_cast<std::int32_t>(
        std::lower_bound(result.points.begin(), result.points.end(), crossing) -
        result.points.begin());
  };
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (ends[k].empty()) continue;
    const std::array segment{index(ends[k][0]), index(ends[k][1])};
    result.lines.push_back({pairs[k].first, segment});
    result.lines.push_back({pairs[k].second, segment});
  }
  std::stable_sort(result.lines.begin(), result.lines.end(),
                   [](const auto& a, const auto& b) { return a.face < b.face; });
  return result;
}

}  // namespace dapple
