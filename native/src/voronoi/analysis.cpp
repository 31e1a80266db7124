// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/analysis.hpp>
#include <dapple/neighbors.hpp>
#include <limits>

#include "base/parallel.hpp"
#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"
#include "voronoi/local_spacing.hpp"

namespace dapple {
namespace {

// The distance is measured along the surface, because a straight line through a fold or a thin rim
// is shorter.
double nearest_touching(const RestrictedVoronoi& diagram, std::size_t i) {
  double path = std::numeric_limits<double>::infinity();
  for (const CellBoundary& side : diagram.boundary(i)) path = std::min(path, side.path_length);
  return path;
}

/// The standard deviation of the capacities divided by their mean; 0 if no cell has any area, as on
/// a part that has collapsed in a frame.
double variation(const RestrictedVoronoi& diagram, double mean) {
  if (!(mean > 0.0)) return 0.0;
  double sum = 0.0;
  for (const Moments& cell : diagram.cells) sum += (cell.capacity - mean) * (cell.capacity - mean);
  return std::sqrt(sum / static_cast<double>(diagram.cells.size())) / mean;
}

/// Neighbors whose common boundary is shorter than this, relative to their distance, touch only at
/// a corner.
constexpr double kCorner = 1e-9;
constexpr std::size_t kFewestNeighbors = 3;  // a closed polygon has at least three sides
constexpr std::size_t kGrain = 512;          // sites per chunk
constexpr double kNone = -1.0;               // not measurable

/// Measurements of each site, in the order of the sites, so that their sums do not depend on the
/// number of threads.
template <typename Measured>
std::vector<double> of_each(std::size_t count, const Measured& measured) {
  std::vector<double> result(count);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = measured(i);
  });
  return result;
}

// Multiplication of complex numbers (x, y).
Vec2 times(const Vec2& a, const Vec2& b) {
  return {a.x() * b.x() - a.y() * b.y(), a.x() * b.y() + a.y() * b.x()};
}
Vec2 squared(const Vec2& a) { return times(a, a); }

/// |mean of exp(6 i theta)| over the neighbors of a site; kNone if the site has too few neighbors
/// or lies on a face without area, which has no plane.
double order_at(const RestrictedVoronoi& diagram, std::size_t site, const Vec3& normal) {
  if (normal.isZero(0.0)) return kNone;
  const Vec3 u = normal.unitOrthogonal();
  const Vec3 v = normal.cross(u);
  Vec2 sum = Vec2::Zero();
  std::size_t count = 0;
  for (const CellBoundary& side : diagram.boundary(site)) {
    if (side.length <= kCorner * side.offset.norm()) continue;
    const Vec2 way = Vec2(side.offset.dot(u), side.offset.dot(v)).normalized();
    sum += times(squared(way), squared(squared(way)));
    ++count;
  }
  if (count < kFewestNeighbors) return kNone;
  return sum.norm() / static_cast<double>(count);
}

/// The neighbor whose cell a ray enters next, and the distance along the ray.
struct Exit {
  std::int32_t site = -1;
  double at = 1.0;
};

Exit leave_cell(const RestrictedVoronoi& diagram, std::size_t site, const Vec3& from,
                const Vec3& step) {
  Exit exit;
  for (const CellBoundary& side : diagram.boundary(site)) {
    const double speed = step.dot(side.offset);
    if (speed <= 0.0) continue;
    const double at = (0.5 * side.offset.squaredNorm() - from.dot(side.offset)) / speed;
    if (at < exit.at) exit = {side.neighbor, at};
  }
  return exit;
}

/// The sites of each component of the surface; only their cells can meet its borders.
class ComponentSites {
 public:
  ComponentSites(const Surface& surface, const Sites& sites)
      : all_(sites.positions), parts_(static_cast<std::size_t>(surface.ordered().components())) {
    for (std::size_t k = 0; k < sites.size(); ++k) {
      const std::int32_t component =
          surface.ordered().component(surface.ordered().ordered_face(sites.faces[k]));
      Part& part = parts_[static_cast<std::size_t>(component)];
      part.sites.push_back(static_cast<std::int32_t>(k));
      part.positions.push_back(sites.positions[k]);
    }
    for (Part& part : parts_)
      if (!part.sites.empty()) part.tree = std::make_unique<Neighbors>(part.positions);
  }

  /// The nearest site of a component, or of the whole surface if the component has none.
  [[nodiscard]] std::int32_t nearest(std::int32_t component, const Vec3& point) {
    const Part& part = parts_[static_cast<std::size_t>(component)];
    (part.tree ? *part.tree : all_).nearest(point, 1, found_);
    const std::int32_t index = found_[0].index;
    return part.tree ? part.sites[static_cast<std::size_t>(index)] : index;
  }

 private:
  struct Part {
    std::vector<std::int32_t> sites;
    std::vector<Vec3> positions;
    std::unique_ptr<Neighbors> tree;
  };
  Neighbors all_;
  std::vector<Part> parts_;
  std::vector<Neighbor> found_;
};

constexpr double kInLine = 1.25;  // spacings of the cell: nearest neighbors on a plane are closer
constexpr double kOpposite =
    -0.5;  // cosine of the angle between two neighbors: at a corner it is larger

/// Whether a site has only one neighbor, or two on opposite sides, and they are farther away than
/// its cell is wide.
bool is_in_line(const RestrictedVoronoi& diagram, std::size_t i) {
  const CellBoundary *before = nullptr, *behind = nullptr;
  for (const CellBoundary& side : diagram.boundary(i)) {
    if (!before || side.neighbor == before->neighbor)
      before = &side;
    else if (!behind || side.neighbor == behind->neighbor)
      behind = &side;
    else
      return false;
  }
  if (!before) return false;
  if (behind && before->offset.dot(behind->offset) >
                    kOpposite * before->offset.norm() * behind->offset.norm())
    return false;
  const Moments& cell = diagram.cells[i];
  return nearest_touching(diagram, i) > kInLine * local_spacing(cell, cell.capacity);
}

/// The distance from a site to its nearest neighbor, in local spacings. It is infinite for the only
/// site of a component, and kNone on a thin part.
double alpha_at(const RestrictedVoronoi& diagram, std::size_t i, double mean) {
  // An empty cell belongs to a site that coincides with another one, so alpha is 0.
  if (is_in_line(diagram, i)) return kNone;
  const double spacing = local_spacing(diagram.cells[i], mean);
  return spacing > 0.0 ? nearest_touching(diagram, i) / spacing : 0.0;
}

/// The half-edges of all borders.
std::vector<std::int32_t> border_half_edges(const Surface& surface) {
  std::vector<std::int32_t> result;
  const auto half_edges = static_cast<std::int32_t>(3 * surface.face_count());
  for (std::int32_t h = 0; h < half_edges; ++h)
    if (surface.ordered().is_border(h)) result.push_back(h);
  return result;
}

}  // namespace

Evenness measure_evenness(const RestrictedVoronoi& diagram) {
  Evenness result;
  if (diagram.cells.size() == 0) return result;
  double capacity = 0.0;
  for (const Moments& cell : diagram.cells) capacity += cell.capacity;
  capacity /= static_cast<double>(diagram.cells.size());
  result.capacity_variation = variation(diagram, capacity);
  double sum = 0.0;
  std::size_t counted = 0, in_line = 0;
  result.alpha_min = std::numeric_limits<double>::infinity();
  const std::vector<double> alphas =
      of_each(diagram.cells.size(), [&](std::size_t i) { return alpha_at(diagram, i, capacity); });
  for (const double alpha : alphas) {
    if (alpha == kNone) ++in_line;
    if (alpha == kNone || !std::isfinite(alpha)) continue;
    result.alpha_min = std::min(result.alpha_min, alpha);
    sum += alpha;
    ++counted;
  }
  result.alpha_mean = counted > 0 ? sum / static_cast<double>(counted) : 0.0;
  if (counted == 0) result.alpha_min = 0.0;
  result.thin_share = static_cast<double>(in_line) / static_cast<double>(alphas.size());
  return result;
}

std::vector<bool> cells_on_border(const Surface& surface, const Sites& sites,
                                  const RestrictedVoronoi& diagram) {
  check_sites(surface, sites);
  check_same_length("the diagram", diagram.cells.size(), "positions", sites.size());
  std::vector<bool> result(sites.size(), false);
  const std::vector<std::int32_t> border = border_half_edges(surface);
  if (sites.size() == 0 || border.empty()) return result;
  ComponentSites tree(surface, sites);
  for (const std::int32_t h : border) {
    const Face& corners = surface.ordered().corners(face_of(h));
    const Vec3& a = surface.ordered().vertex(corners[static_cast<std::size_t>(h % 3)]);
    const Vec3 step = surface.ordered().vertex(corners[static_cast<std::size_t>((h + 1) % 3)]) - a;
    // Each site lies farther along the edge than the previous one, so the walk ends.
    for (std::int32_t site = tree.nearest(surface.ordered().component(face_of(h)), a); site >= 0;) {
      const auto i = static_cast<std::size_t>(site);
      result[i] = true;
      site = leave_cell(diagram, i, a - sites.positions[i], step).site;
    }
  }
  return result;
}

double bond_order(const RestrictedVoronoi& diagram, std::span<const Vec3> normals,
                  const std::vector<bool>& left_out) {
  check_same_length("normals", normals.size(), "the diagram", diagram.cells.size());
  if (!left_out.empty())
    check_same_length("left_out", left_out.size(), "the diagram", diagram.cells.size());
  double sum = 0.0;
  std::size_t counted = 0;
  const std::vector<double> orders = of_each(diagram.cells.size(), [&](std::size_t i) {
    return !left_out.empty() && left_out[i] ? kNone : order_at(diagram, i, normals[i]);
  });
  for (const double order : orders) {
    if (order == kNone) continue;
    sum += order;
    ++counted;
  }
  return counted > 0 ? sum / static_cast<double>(counted) : 0.0;
}

}  // namespace dapple
