// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/sides.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/projector.hpp>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/reorder.hpp"
#include "base/sets.hpp"
#include "base/vectors.hpp"
#include "surface/opposite_points.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/sheets.hpp"

namespace dapple {
namespace {

constexpr double kThin = 0.5;       // spacings: cells rarely reach through thicker walls
constexpr double kOpposite = -0.8;  // cosine between the normals of a wall's two sides
constexpr double kWide = 0.5;       // spacings: narrower bodies are wires and ribbons
constexpr double kNarrowRim = 0.3;  // spacings: too narrow for sites of its own
constexpr double kRim = 1.0;        // spacings: wider parts are not rims
constexpr double kBends = 1e6;      // steps of a bend, which is 1 - cosine: 0.08 degrees are one
constexpr double kFewest = 10.0;  // cells on a side: fewer are less even than cells around the rim
constexpr double kFolded = 0.05;  // largest share of a side that may lie opposite the side itself
// To find out whether there may be walls, this many points per cell are distributed. On the two
// sides of a wall, some points are within this many spacings of each other, measured along the
// wall.
constexpr double kPoints = 1.5, kAside = 0.8;
constexpr double kMostPoints = 0x1p20;  // a larger number is reduced to this, with larger distances
constexpr std::int32_t kNone = -1;

/// Points that divide the faces, in their order, into parts of equal area.
LaidPoints lay_points(const Surface& surface, double count) {
  LaidPoints result;
  const double step = surface.area() / count;
  double next = 0.5 * step, sum = 0.0, along = 0.0;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    const FaceGeometry& face = surface.ordered().geometry(nth_face(f));
    for (sum += face.moments.area; next < sum; next += step) {
      // Several points on one face are spread over it (Roberts' sequence).
      along = std::fmod(along + 0.7548776662466927, 1.0);
      const double root = std::sqrt(std::fmod(0.5698402909980532 * (next / step), 1.0));
      const Vec3 weights(1.0 - root, root * (1.0 - along), root * along);
      const bool many = face.moments.area > 2.0 * step;
      result.positions.push_back(many ? surface.ordered().point(nth_face(f), weights)
                                      : face.centroid);
      result.normals.push_back(face.normal);
      result.components.push_back(surface.ordered().component(nth_face(f)));
    }
  }
  return result;
}

/// Whether any point has a point with the opposite normal behind it. The test is fast and never
/// false if a wall has sides of several cells.
bool may_have_walls(const Surface& surface, double spacing, double cells) {
  const double count = std::min(kPoints * cells, kMostPoints);
  const double apart = std::sqrt(kPoints * cells / count);
  const double reach = std::hypot(kThin, kAside * apart) * spacing;
  return has_opposite_points(lay_points(surface, count), {reach, kThin * spacing, kOpposite},
                             static_cast<std::size_t>(kFewest));
}

class Sides {
 public:
  Sides(const Surface& surface, double spacing, Context* context)
      : surface_(surface), mesh_(surface.ordered()), spacing_(spacing), context_(context) {}

  /// Per ordered face, its component; empty if the surface's components do not change.
  std::vector<std::int32_t> components(double cells) {
    find_walls();
    label_walls();
    drop_small_and_folded();
    label_rims();
    const std::vector<std::int32_t> result = divided(cells);
    return count_of(result) > mesh_.components() ? result : std::vector<std::int32_t>{};
  }

  /// Per ordered face, whether it is on the narrow rim of a side, where no site should start.
  [[nodiscard]] std::vector<bool> rims() const {
    std::vector<bool> result(label_.size());
    for (std::size_t f = 0; f < result.size(); ++f) result[f] = label_[f] != kNone && narrow_[f];
    return result;
  }

 private:
  using Pair = std::pair<std::int32_t, std::int32_t>;

  static std::int32_t count_of(const std::vector<std::int32_t>& components) {
    return 1 + *std::max_element(components.begin(), components.end());
  }

  /// Find the face behind each face.
  void find_walls() {
    const Projector projector(surface_, false, context_);
    std::vector<Ray> rays(surface_.face_count());
    for_each_vector(rays.size(), [&](std::size_t f) {
      const FaceGeometry& face = mesh_.geometry(nth_face(f));
      rays[f] = {face.centroid, -face.normal, kThin * spacing_};
    });
    const std::vector<std::int32_t> hits = projector.first_hits(rays);
    behind_.assign(rays.size(), kNone);
    for (std::size_t f = 0; f < rays.size(); ++f) {
      if (hits[f] < 0 || !mesh_.counts(nth_face(f))) continue;
      const OrderedFace other = mesh_.ordered_face(hits[f]);
      if (mesh_.component(other) == mesh_.component(nth_face(f)) &&
          mesh_.geometry(other).normal.dot(mesh_.geometry(nth_face(f)).normal) < kOpposite)
        behind_[f] = static_cast<std::int32_t>(as_index(other));
    }
  }

  template <typename Visit>
  void for_each_neighbor(std::size_t f, const Visit& visit) const {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = half_edge(nth_face(f), k);
      for (std::int32_t g = mesh_.next_around(h); g != h; g = mesh_.next_around(g))
        visit(as_index(face_of(g)), h, g);
    }
  }

  /// Sets of faces connected over edges for which `joins(face, neighbor)` holds.
  template <typename Joins>
  [[nodiscard]] Sets joined(const Joins& joins) const {
    Sets sets(behind_.size());
    for (std::size_t f = 0; f < behind_.size(); ++f)
      for_each_neighbor(f, [&](std::size_t other, std::int32_t h, std::int32_t g) {
        if (g > h && joins(f, other))
          sets.join(static_cast<std::int32_t>(f), static_cast<std::int32_t>(other));
      });
    return sets;
  }

  /// Label the connected parts of walls; a sharp rim separates parts.
  void label_walls() {
    Sets sets = joined([this](std::size_t f, std::size_t other) {
      return behind_[f] != kNone && behind_[other] != kNone &&
             mesh_.geometry(nth_face(f)).normal.dot(mesh_.geometry(nth_face(other)).normal) > 0.0;
    });
    label_.assign(behind_.size(), kNone);
    for (std::size_t f = 0; f < behind_.size(); ++f)
      if (behind_[f] != kNone) label_[f] = sets.find(static_cast<std::int32_t>(f));
  }

  struct Part {
    double area = 0.0, around = 0.0, folded = 0.0;
    [[nodiscard]] double width() const { return around > 0.0 ? 2.0 * area / around : 1e300; }
  };

  /// The measurements of the parts, by label.
  [[nodiscard]] std::vector<Part> measure(const std::vector<std::int32_t>& label) const {
    std::vector<Part> parts(label.size());
    for (std::size_t f = 0; f < label.size(); ++f) {
      if (label[f] == kNone) continue;
      Part& part = parts[static_cast<std::size_t>(label[f])];
      part.area += mesh_.geometry(nth_face(f)).moments.area;
      const std::int32_t other = behind_[f];
      if (other != kNone && label[static_cast<std::size_t>(other)] == label[f])
        part.folded += mesh_.geometry(nth_face(f)).moments.area;
      for_each_neighbor(f, [&](std::size_t next, std::int32_t h, std::int32_t) {
        if (label[next] != label[f]) part.around += edge_length(mesh_, h);
      });
    }
    return parts;
  }

  void drop_small_and_folded() {
    const auto parts = measure(label_);
    for (std::int32_t& label : label_) {
      if (label == kNone) continue;
      const Part& part = parts[static_cast<std::size_t>(label)];
      if (part.width() < kWide * spacing_ || part.folded > kFolded * part.area) label = kNone;
    }
  }

  /// Assigns narrow parts between walls to the nearer wall, by number of faces.
  void label_rims() {
    Sets sets = joined([this](std::size_t f, std::size_t other) {
      return label_[f] == kNone && label_[other] == kNone;
    });
    std::vector<std::int32_t> rest(label_.size(), kNone);
    for (std::size_t f = 0; f < rest.size(); ++f)
      if (label_[f] == kNone && mesh_.counts(nth_face(f)))
        rest[f] = sets.find(static_cast<std::int32_t>(f));
    const auto parts = measure(rest);
    narrow_.assign(rest.size(), false);
    for (std::size_t f = 0; f < rest.size(); ++f)
      if (rest[f] != kNone)
        narrow_[f] = parts[static_cast<std::size_t>(rest[f])].width() < kNarrowRim * spacing_;
    spread([&](std::size_t f) { return narrow_[f]; });
    spread_over_bends([&](std::size_t f) {
      return rest[f] != kNone && parts[static_cast<std::size_t>(rest[f])].width() < kRim * spacing_;
    });
  }

  template <typename IsRim>
  void spread(const IsRim& is_rim) {
    std::vector<std::size_t> front;
    for (std::size_t f = 0; f < label_.size(); ++f)
      if (label_[f] != kNone) front.push_back(f);
    while (!front.empty()) {
      std::map<std::size_t, std::int32_t> reached;
      for (const std::size_t f : front)
        for_each_neighbor(f, [&](std::size_t other, std::int32_t, std::int32_t) {
          if (label_[other] != kNone || !is_rim(other)) return;
          const auto [at, fresh] = reached.try_emplace(other, label_[f]);
          at->second = std::min(at->second, label_[f]);
        });
      front.clear();
      for (const auto& [f, label] : reached) {
        label_[f] = label;
        front.push_back(f);
      }
    }
  }

  /// Sites stand on these rims. Two sides that met within a flat part would keep the sites beside
  /// their border from knowing each other, so the sides meet where the rim turns the most.
  template <typename IsRim>
  void spread_over_bends(const IsRim& is_rim) {
    using Reached = std::tuple<std::int64_t, std::int32_t, std::size_t>;  // bend, label, face
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
    const auto push_around = [&](std::size_t f, std::int64_t bend) {
      for_each_neighbor(f, [&](std::size_t other, std::int32_t, std::int32_t) {
        if (label_[other] == kNone && is_rim(other))
          front.emplace(bend + bend_between(f, other), label_[f], other);
      });
    };
    for (std::size_t f = 0; f < label_.size(); ++f)
      if (label_[f] != kNone) push_around(f, 0);
    while (!front.empty()) {
      const auto [bend, label, f] = front.top();
      front.pop();
      if (label_[f] != kNone) continue;
      label_[f] = label;
      push_around(f, bend);
    }
  }

  /// A whole number, so that rounding errors of flat parts decide nothing.
  [[nodiscard]] std::int64_t bend_between(std::size_t f, std::size_t other) const {
    const double cosine =
        mesh_.geometry(nth_face(f)).normal.dot(mesh_.geometry(nth_face(other)).normal);
    return std::llround(kBends * (1.0 - cosine));
  }

  [[nodiscard]] std::set<Pair> opposite_pairs() const {
    std::set<Pair> result;
    for (std::size_t f = 0; f < label_.size(); ++f) {
      if (behind_[f] == kNone || label_[f] == kNone) continue;
      const std::int32_t other = label_[static_cast<std::size_t>(behind_[f])];
      if (other != kNone && other != label_[f]) result.insert(std::minmax(label_[f], other));
    }
    return result;
  }

  /// Components in which opposite sides are not connected. A component is unchanged if its sides
  /// are connected over parts that are not walls, or if a side would have too few cells.
  std::vector<std::int32_t> divided(double cells) {
    const std::set<Pair> pairs = opposite_pairs();
    const auto parts = [&](std::size_t f, std::size_t other) {
      return label_[f] != kNone && label_[other] != kNone && label_[f] != label_[other] &&
             pairs.contains(std::minmax(label_[f], label_[other]));
    };
    Sets sets = joined([&](std::size_t f, std::size_t other) { return !parts(f, other); });
    const std::vector<bool> whole = undivided(sets, pairs, cells);
    std::vector<std::int32_t> result(label_.size(), kNone);
    std::vector<std::int32_t> of_body(whole.size(), kNone), of_set(label_.size(), kNone);
    std::int32_t count = 0;
    for (std::size_t f = 0; f < result.size(); ++f) {
      if (!mesh_.counts(nth_face(f))) continue;
      const auto body = static_cast<std::size_t>(mesh_.component(nth_face(f)));
      const auto set = static_cast<std::size_t>(sets.find(static_cast<std::int32_t>(f)));
      std::int32_t& number = whole[body] ? of_body[body] : of_set[set];
      if (number == kNone) number = count++;
      result[f] = number;
    }
    return result;
  }

  /// Per component of the surface, whether it is not split.
  std::vector<bool> undivided(Sets& sets, const std::set<Pair>& pairs, double cells) {
    std::vector<bool> whole(static_cast<std::size_t>(mesh_.components()), false);
    const auto body = [&](std::int32_t f) {
      return static_cast<std::size_t>(mesh_.component(nth_face(static_cast<std::size_t>(f))));
    };
    for (const auto& [a, b] : pairs)  // a label is the index of one of its faces
      if (sets.find(a) == sets.find(b)) whole[body(a)] = true;
    std::vector<double> capacities(label_.size(), 0.0);  // of sets
    std::vector<int> parts(whole.size(), 0);             // of bodies
    const auto set = [&](std::size_t f) {
      return static_cast<std::size_t>(sets.find(static_cast<std::int32_t>(f)));
    };
    for (std::size_t f = 0; f < label_.size(); ++f) {
      if (set(f) == f && mesh_.counts(nth_face(f))) ++parts[body(static_cast<std::int32_t>(f))];
      capacities[set(f)] += mesh_.geometry(nth_face(f)).moments.capacity;
    }
    for (std::size_t f = 0; f < label_.size(); ++f)
      if (set(f) == f && parts[body(static_cast<std::int32_t>(f))] > 1 &&
          mesh_.counts(nth_face(f)) && capacities[f] * cells < kFewest * mesh_.unit_capacity())
        whole[body(static_cast<std::int32_t>(f))] = true;
    return whole;
  }

  const Surface& surface_;
  const OrderedSurface& mesh_;
  double spacing_;
  Context* context_;
  std::vector<std::int32_t> behind_;  // per ordered face
  std::vector<std::int32_t> label_;   // per ordered face: the first face of its side
  std::vector<bool> narrow_;          // per ordered face, whether it belongs to a narrow rim
};

/// Per ordered vertex, its place. Doubled faces connect nothing, so their corners are not welded to
/// those of the faces that they lie on.
std::vector<std::int32_t> places_of(const Connectivity& mesh) {
  Sets sets(mesh.welded_vertex.size());
  for (std::size_t v = 0; v < mesh.welded_vertex.size(); ++v)
    sets.join(static_cast<std::int32_t>(v), mesh.welded_vertex[v]);
  for (const DoubledFace& doubled : mesh.doubled)
    for (std::size_t k = 0; k < 3; ++k)
      sets.join(mesh.faces[as_index(doubled.face)][k],
                mesh.faces[as_index(doubled.counted)][doubled.corners[k]]);
  std::vector<std::int32_t> result(mesh.welded_vertex.size());
  for (std::size_t v = 0; v < result.size(); ++v)
    result[v] = sets.find(static_cast<std::int32_t>(v));
  return result;
}

/// The surface with these components.
Surface divide(const Surface& surface, const std::vector<std::int32_t>& components,
               Context* context) {
  const OrderedSurface& mesh = surface.ordered();
  const Connectivity& known = mesh.connectivity();
  std::vector<std::int32_t> edges(3 * surface.face_count());
  for (std::size_t f = 0; f < surface.face_count(); ++f)
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = half_edge(nth_face(f), k);
      std::int32_t first = h;
      for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g))
        if (components[as_index(face_of(g))] == components[f]) first = std::min(first, g);
      edges[3 * static_cast<std::size_t>(known.original_face[f]) + static_cast<std::size_t>(k)] =
          first;
    }
  const std::vector<std::int32_t> places =
      scatter<std::int32_t>(places_of(known), known.original_vertex);
  return {surface.vertices(),
          surface.faces(),
          Density{surface.density_at(), surface.density()},
          Joints{edges, places},
          surface.sharp_angle(),
          surface.merge_doubled(),
          context};
}

Surface without_rims(const Surface& surface, const std::vector<bool>& rims) {
  std::vector<double> density(3 * surface.face_count(), 0.0);
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    if (rims[f]) continue;
    const Vec3 values = surface.ordered().densities(nth_face(f));
    const auto face = static_cast<std::size_t>(surface.ordered().original_face(nth_face(f)));
    for (std::size_t k = 0; k < 3; ++k)
      density[3 * face + k] = values[static_cast<Eigen::Index>(k)];
  }
  return surface.with_density({DensityAt::kCorners, density});
}

/// The surface whose walls have two sides; null where there is no wall.
std::shared_ptr<const SidedSurface> with_walls(const Surface& surface, std::size_t count,
                                               Context* context) {
  const auto cells = static_cast<double>(count);
  const double spacing = surface.spacing(count);
  if (!may_have_walls(surface, spacing, cells)) return nullptr;
  Sides sides(surface, spacing, context);
  const std::vector<std::int32_t> components = sides.components(cells);
  if (components.empty()) return nullptr;
  const Surface all = divide(surface, components, context);
  const std::vector<bool> rims = sides.rims();
  return std::make_shared<const SidedSurface>(all, rims, without_rims(all, rims));
}

}  // namespace

std::shared_ptr<const SidedSurface> with_sides(const Surface& surface, std::size_t count,
                                               Context* context) {
  const auto cells = static_cast<double>(count);
  if (cells < 2.0 * kFewest) return nullptr;
  const std::vector<std::int32_t> sheets = components_of_sheets(surface, cells, context);
  if (sheets.empty()) return with_walls(surface, count, context);
  const Surface apart = divide(surface, sheets, context);
  const auto walls = with_walls(apart, count, context);
  return walls ? walls : std::make_shared<const SidedSurface>(apart, std::vector<bool>{}, apart);
}

std::shared_ptr<const SidedSurface> with_sides_of(const SidedSurface& known,
                                                  const Surface& surface) {
  const Surface all = known.all.deformed(surface.vertices())
                          .with_density(Density{surface.density_at(), surface.density()});
  return std::make_shared<const SidedSurface>(
      all, known.rims, known.rims.empty() ? all : without_rims(all, known.rims));
}

}  // namespace dapple
