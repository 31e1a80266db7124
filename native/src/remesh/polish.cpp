// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/polish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "base/progress.hpp"
#include "base/segment.hpp"
#include "base/sort_unique.hpp"
#include "base/triangle.hpp"
#include "lines/line_sites.hpp"
#include "remesh/measure.hpp"
#include "remesh/mesh_editor.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/walk.hpp"

namespace dapple {
namespace {

constexpr double kGoal = 36.0;        // degrees: triangles with smaller angles are thin
constexpr double kGoalBeside = 38.0;  // the same beside added vertices
// Triangles between lines may be this much thinner than others, up to so many degrees.
constexpr double kBetween = 1.5, kMostBetween = 8.0;
constexpr double kBesideLine = 0.5;  // of the room for a vertex: at each end that is on a line
constexpr double kGain = 0.5;        // degrees: the least that a step is worth
constexpr double kLittle = 0.0001;   // degrees: after less, the next step of a vertex is shorter
constexpr double kOfVertex = 3.0;    // degrees: what a vertex is worth
constexpr int kRounds = 8;
constexpr double kShort = 0.6;    // of the mean edge around: edges that may collapse
constexpr double kBulge = 0.1;    // of the same: how far a step may move the mesh
constexpr double kFacing = 0.6;   // cosine of the largest turn of a triangle
constexpr double kMeaning = 5.0;  // degrees: normals of thinner triangles mean nothing
constexpr double kFirstStep = 0.4, kLastStep = 0.04;  // of the mean edge around: moves
constexpr int kDirections = 8;

/// The places of a chain by their length from its start.
class ChainPlaces {
 public:
  ChainPlaces(const OrderedSurface& mesh, const LineChain& chain) : mesh_(mesh), chain_(chain) {
    for (const std::int32_t h : chain.half_edges) ends_.push_back(total() + length(h));
  }

  [[nodiscard]] double total() const { return ends_.empty() ? 0.0 : ends_.back(); }

  /// The length at the place that is nearest to a point.
  [[nodiscard]] double nearest(const Vec3& point) const {
    double least = std::numeric_limits<double>::infinity(), found = 0.0;
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      const Vec3 &a = mesh_.vertex(chain_.vertices[e]), &b = mesh_.vertex(chain_.vertices[e + 1]);
      const double share = nearest_share(point, a, b);
      const double distance = (a + share * (b - a) - point).squaredNorm();
      if (distance < least) found = start(e) + share * (b - a).norm();
      least = std::min(least, distance);
    }
    return found;
  }

  /// The place at a length; none beyond the ends of an open chain.
  [[nodiscard]] std::optional<Sites> at(double length) const {
    if (chain_.closed) length -= total() * std::floor(length / total());
    if (!(length > 0.0 && length < total())) return std::nullopt;
    const auto e =
        std::min(static_cast<std::size_t>(std::ranges::lower_bound(ends_, length) - ends_.begin()),
                 ends_.size() - 1);
    const double part = ends_[e] - start(e);
    const double share = part > 0.0 ? std::clamp((length - start(e)) / part, 0.0, 1.0) : 0.0;
    return point_on_chain(mesh_, chain_, {e, share});
  }

 private:
  [[nodiscard]] double start(std::size_t e) const { return e > 0 ? ends_[e - 1] : 0.0; }
  [[nodiscard]] double length(std::int32_t h) const {
    return (mesh_.vertex(end_of(mesh_, h)) - mesh_.vertex(start_of(mesh_, h))).norm();
  }

  const OrderedSurface& mesh_;
  const LineChain& chain_;
  std::vector<double> ends_;
};

/// A way to make a triangle wider.
struct Step {
  enum class Kind : std::uint8_t { kNone, kFlip, kCollapse, kMove } kind = Kind::kNone;
  std::int32_t a = -1, b = -1;
  MeshChange change;
  Sites place;        // kMove
  double gain = 0.0;  // degrees
};

/// A vertex somewhere else.
struct At {
  std::int32_t vertex = -1;
  Vec3 position = Vec3::Zero();
  std::int32_t face = -1;
};

class Polisher {
 public:
  Polisher(const Surface& surface, const FeatureLines& lines, RemeshSites& sites, const Dual& dual,
           const Context* context)
      : surface_(surface),
        lines_(lines),
        sites_(sites),
        mesh_(sites, dual.triangles, dual.lines),
        context_(context) {}

  void run(std::size_t count) {
    const std::size_t before = sites_.size(), enough = std::min(count, before);
    improve_all();
    may_collapse_ = false;
    while (sites_.size() - removed_ < enough && add_vertices(enough + removed_)) {
    }
  }

  [[nodiscard]] const MeshEditor& mesh() const { return mesh_; }

 private:
  [[nodiscard]] const Vec3& position(std::int32_t v, const At& at) const {
    return v == at.vertex ? at.position : sites_.sites.positions[as_index(v)];
  }
  [[nodiscard]] std::array<Vec3, 3> corners(const Face& t, const At& at) const {
    return {position(t[0], at), position(t[1], at), position(t[2], at)};
  }
  [[nodiscard]] Vec3 area(const Face& t, const At& at) const {
    const auto [a, b, c] = corners(t, at);
    return (b - a).cross(c - a);
  }

  /// The smallest angle of a triangle, and more between lines; less than 0 if it faces away from
  /// the surface.
  [[nodiscard]] double quality(const Face& t, const At& at = {}) const {
    const auto [a, b, c] = corners(t, at);
    const double angle = smallest_angle(a, b, c);
    if (faces_away(t, at)) return -angle;
    const bool between = std::ranges::all_of(t, [&](std::int32_t v) { return is_on_line(v); });
    return between ? std::min(kBetween * angle, angle + kMostBetween) : angle;
  }

  [[nodiscard]] bool is_on_line(std::int32_t v) const {
    return sites_.kinds[as_index(v)] != SiteKind::kFree;
  }

  [[nodiscard]] bool faces_away(const Face& t, const At& at) const {
    const OrderedSurface& old = surface_.ordered();
    const Vec3 normal = area(t, at);
    bool free = false;
    for (const std::int32_t v : t) {
      const std::int32_t on = v == at.vertex ? at.face : sites_.sites.faces[as_index(v)];
      const OrderedFace face = old.counted_face(on);
      if (lines_.sign(face) * normal.dot(old.geometry(face).normal) >= 0.0) return false;
      free = free || !is_on_line(v);
    }
    return free;  // those of lines may be said to be on faces of other sheets
  }

  [[nodiscard]] double worst(std::span<const std::int32_t> triangles) const {
    double least = 180.0;
    for (const std::int32_t t : triangles) least = std::min(least, quality(mesh_.triangle(t)));
    return least;
  }

  /// The smallest angle after a change; -180 if it turns triangles too far.
  [[nodiscard]] double worst(const MeshChange& change, const At& at = {}) const {
    double least = 180.0;
    for (const Face& t : change.made) least = std::min(least, quality(t, at));
    return least > 0.0 && turns(change, at) ? -180.0 : least;
  }

  /// Whether triangles turn far from the mean normal of their sheet, and farther than before.
  [[nodiscard]] bool turns(const MeshChange& change, const At& at) const {
    const auto sheets = static_cast<std::size_t>(1 + *std::ranges::max_element(change.gone_sheets));
    std::vector<Vec3> means(sheets, Vec3::Zero());
    for (std::size_t k = 0; k < change.gone.size(); ++k)
      means[as_index(change.gone_sheets[k])] += area(mesh_.triangle(change.gone[k]), {});
    for (Vec3& mean : means) mean.normalize();
    std::vector<double> limits(sheets, kFacing);
    for (std::size_t k = 0; k < change.gone.size(); ++k) {
      const Face& t = mesh_.triangle(change.gone[k]);
      const auto sheet = as_index(change.gone_sheets[k]);
      if (std::abs(quality(t)) < kMeaning) continue;
      limits[sheet] = std::min(limits[sheet], area(t, {}).normalized().dot(means[sheet]));
    }
    for (std::size_t k = 0; k < change.made.size(); ++k) {
      const auto sheet = as_index(change.made_sheets[k]);
      if (area(change.made[k], at).normalized().dot(means[sheet]) < limits[sheet]) return true;
    }
    return false;
  }

  /// The mean length of the edges at a vertex.
  [[nodiscard]] double mean_edge(std::int32_t v) const {
    double sum = 0.0;
    const std::vector<std::int32_t> around = mesh_.neighbors(v);
    for (const std::int32_t w : around) sum += (position(w, {}) - position(v, {})).norm();
    return around.empty() ? 0.0 : sum / static_cast<double>(around.size());
  }

  void improve_all() {
    for (int round = 0; round < kRounds; ++round) {
      check_context(context_);
      std::vector<std::int32_t> all;
      for (std::size_t t = 0; t < mesh_.triangle_count(); ++t)
        all.push_back(static_cast<std::int32_t>(t));
      if (!improve(all, kGoal)) break;
    }
  }

  /// Make the thin ones of some triangles wider, the thinnest first.
  bool improve(std::span<const std::int32_t> triangles, double goal) {
    std::vector<std::pair<double, std::int32_t>> thin;
    for (const std::int32_t t : triangles)
      if (mesh_.exists(t))
        if (const double found = quality(mesh_.triangle(t)); found < goal)
          thin.push_back({found, t});
    std::ranges::sort(thin);
    bool improved = false;
    for (const auto& [_, t] : thin)
      if (mesh_.exists(t) && quality(mesh_.triangle(t)) < goal) improved |= widen(t);
    return improved;
  }

  bool widen(std::int32_t t) {
    const Face face = mesh_.triangle(t);
    if (sites_.stay(face)) return false;
    Step best;
    best.gain = kGain;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = face[k], b = face[(k + 1) % 3];
      try_flip(a, b, best);
      if (!may_collapse_) continue;
      try_collapse(a, b, best);
      try_collapse(b, a, best);
    }
    for (const std::int32_t v : face) try_move(v, best);
    take(best);
    return best.kind != Step::Kind::kNone;
  }

  void take(const Step& step) {
    switch (step.kind) {
      case Step::Kind::kNone:
        break;
      case Step::Kind::kFlip:
        mesh_.apply(step.change);
        break;
      case Step::Kind::kCollapse:
        mesh_.collapse(step.change, step.a, step.b);
        ++removed_;
        break;
      case Step::Kind::kMove:
        sites_.move(as_index(step.a), step.place, sites_.kinds[as_index(step.a)],
                    sites_.chains[as_index(step.a)]);
        break;
    }
  }

  void try_flip(std::int32_t a, std::int32_t b, Step& best) const {
    MeshChange change = mesh_.flipped(a, b);
    if (change.gone.empty()) return;
    const std::int32_t c = change.made[0][2], d = change.made[0][1];
    const Vec3 along = position(b, {}) - position(a, {}),
               across = position(d, {}) - position(c, {});
    const Vec3 normal = along.cross(across).normalized();
    const double bulge = std::abs(normal.dot(position(c, {}) - position(a, {})));
    const double gain = worst(change) - worst(change.gone);
    if (gain <= best.gain || bulge > kBulge * std::max(along.norm(), across.norm())) return;
    best = {Step::Kind::kFlip, a, b, std::move(change), {}, gain};
  }

  void try_collapse(std::int32_t a, std::int32_t b, Step& best) const {
    if (sites_.origins[as_index(a)].stays) return;
    const double edge = mean_edge(b);
    if ((position(a, {}) - position(b, {})).norm() > kShort * edge) return;
    MeshChange change = mesh_.collapsed(a, b);
    if (change.made.empty()) return;
    const double gain = worst(change) - worst(change.gone) - kOfVertex;
    if (gain <= best.gain || bulge(change, position(a, {})) > kBulge * edge) return;
    best = {Step::Kind::kCollapse, a, b, std::move(change), {}, gain};
  }

  /// The distance of a place from the triangles made.
  [[nodiscard]] double bulge(const MeshChange& change, const Vec3& place, const At& at = {}) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Face& t : change.made) {
      const auto [a, b, c] = corners(t, at);
      const Vec3 weights = closest_barycentric(place, a, b, c);
      least = std::min(least, (combined({a, b, c}, weights) - place).norm());
    }
    return least;
  }

  void try_move(std::int32_t v, Step& best) {
    const SiteKind kind = sites_.kinds[as_index(v)];
    if (kind == SiteKind::kCorner || sites_.origins[as_index(v)].stays) return;
    MeshChange ring = mesh_.moved(v);
    if (ring.gone.empty()) return;
    const double before = worst(ring.gone);
    const auto [place, after] =
        kind == SiteKind::kLine ? slide(v, ring, before) : shift(v, ring, before);
    if (place.size() == 0 || after - before <= best.gain) return;
    best = {Step::Kind::kMove, v, v, {}, place, after - before};
  }

  /// The best of some places for a vertex, if it is better than what was found.
  void look_at(std::int32_t v, const MeshChange& ring, const Sites& places,
               std::pair<Sites, double>& found) const {
    for (std::size_t k = 0; k < places.size(); ++k) {
      const At at = {v, places.positions[k], places.faces[k]};
      const double after = worst(ring, at);
      // The tip of a horn stays.
      if (after <= found.second || bulge(ring, position(v, {}), at) > kBulge * mean_edge(v))
        continue;
      found = {{{places.positions[k]}, {places.faces[k]}, {places.barycentric[k]}}, after};
    }
  }

  [[nodiscard]] std::pair<Sites, double> slide(std::int32_t v, const MeshChange& ring,
                                               double before) {
    std::pair<Sites, double> found = {{}, before};
    const std::vector<std::int32_t> along = mesh_.along_lines(v);
    const std::int32_t number = sites_.chains[as_index(v)];
    if (along.size() != 2 || number < 0) return found;
    const ChainPlaces& chain = places_of(number);
    double at = chain.nearest(position(v, {}));
    const double reach = std::max((position(along[0], {}) - position(v, {})).norm(),
                                  (position(along[1], {}) - position(v, {})).norm());
    for (double step = kFirstStep; step >= kLastStep;) {
      const double least = found.second;
      double next = at;
      for (const double sign : {-1.0, 1.0}) {
        const double there = at + sign * step * reach, so_far = found.second;
        if (const std::optional<Sites> place = chain.at(there)) look_at(v, ring, *place, found);
        if (found.second > so_far) next = there;
      }
      at = next;
      if (found.second <= least + kLittle) step *= 0.5;
    }
    return found;
  }

  [[nodiscard]] const ChainPlaces& places_of(std::int32_t chain) {
    const auto found = chains_.find(chain);
    if (found != chains_.end()) return found->second;
    return chains_.emplace(chain, ChainPlaces(surface_.ordered(), lines_.chains()[as_index(chain)]))
        .first->second;
  }

  [[nodiscard]] std::pair<Sites, double> shift(std::int32_t v, const MeshChange& ring,
                                               double before) const {
    std::pair<Sites, double> found = {{}, before};
    Vec3 at = position(v, {});
    std::int32_t face = sites_.sites.faces[as_index(v)];
    const double reach = mean_edge(v);
    for (double step = kFirstStep; step >= kLastStep;) {
      const double least = found.second;
      look_at(v, ring, places_around(at, face, step * reach), found);
      if (found.second > least) {
        at = found.first.positions[0];
        face = found.first.faces[0];
      }
      // Out of a fold, steps of any length end close to where they began.
      if (found.second <= least + kLittle) step *= 0.5;
    }
    return found;
  }

  [[nodiscard]] Sites places_around(const Vec3& place, std::int32_t face, double reach) const {
    const OrderedSurface& old = surface_.ordered();
    const Vec3 normal = old.geometry(old.counted_face(face)).normal;
    const Vec3 u = normal.unitOrthogonal(), w = normal.cross(u);
    std::vector<Vec3> points;
    for (int k = 0; k < kDirections; ++k) {
      const auto [x, y] = direction(k);
      points.push_back(place + reach * (x * u + y * w));
    }
    const std::vector<std::int32_t> from(points.size(), face);
    Projection found = walk_to_nearest(surface_, points, from, context_);
    return {std::move(found.positions), std::move(found.faces), std::move(found.barycentric)};
  }

  /// One of eight directions in a plane.
  static std::pair<double, double> direction(int k) {
    constexpr double kDiagonal = 0.70710678118654752;
    constexpr std::array<std::pair<double, double>, kDirections> kAll = {{{1, 0},
                                                                          {kDiagonal, kDiagonal},
                                                                          {0, 1},
                                                                          {-kDiagonal, kDiagonal},
                                                                          {-1, 0},
                                                                          {-kDiagonal, -kDiagonal},
                                                                          {0, -1},
                                                                          {kDiagonal, -kDiagonal}}};
    return kAll[static_cast<std::size_t>(k)];
  }

  /// Add vertices where triangles are largest, until there are so many sites.
  /// \return whether any was added
  bool add_vertices(std::size_t enough) {
    struct Edge {
      double room;
      std::int32_t a, b;
    };
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < mesh_.triangle_count(); ++k) {
      const auto t = static_cast<std::int32_t>(k);
      for (std::size_t c = 0; c < 3 && mesh_.exists(t); ++c) {
        const std::int32_t a = mesh_.triangle(t)[c], b = mesh_.triangle(t)[(c + 1) % 3];
        if (a < b) edges.push_back({room(a, b), a, b});
      }
    }
    std::ranges::stable_sort(edges, std::greater(), &Edge::room);
    bool added = false;
    std::vector<bool> changed(sites_.size(), false);  // around those added
    for (const Edge& edge : edges) {
      if (sites_.size() >= enough || edge.room <= 0.0) break;
      if (changed[as_index(edge.a)] || changed[as_index(edge.b)] || !split(edge.a, edge.b))
        continue;
      added = true;
      changed.resize(sites_.size(), true);
      for (const std::int32_t t : triangles_near(static_cast<std::int32_t>(sites_.size()) - 1))
        for (const std::int32_t v : mesh_.triangle(t)) changed[as_index(v)] = true;
    }
    return added;
  }

  /// How much room there is on an edge for another vertex: the capacity of its triangles, and less
  /// at lines.
  [[nodiscard]] double room(std::int32_t a, std::int32_t b) const {
    const MeshChange change = mesh_.split(a, b, -1);
    const OrderedSurface& old = surface_.ordered();
    double sum = 0.0;
    for (const std::int32_t t : change.gone) sum += area(mesh_.triangle(t), {}).norm();
    for (const std::int32_t v : {a, b})
      if (is_on_line(v)) sum *= kBesideLine;
    return sum * old.densities(old.counted_face(sites_.sites.faces[as_index(a)])).mean();
  }

  bool split(std::int32_t a, std::int32_t b) {
    const std::vector<Vec3> middle = {0.5 * (position(a, {}) + position(b, {}))};
    const std::vector<std::int32_t> from = {sites_.sites.faces[as_index(a)]};
    const Projection place = walk_to_nearest(surface_, middle, from, context_);
    const auto v = static_cast<std::int32_t>(sites_.size());
    const MeshChange change = mesh_.split(a, b, v);
    if (change.made.empty()) return false;
    sites_.add({place.positions, place.faces, place.barycentric}, SiteKind::kFree, -1, false);
    mesh_.apply(change);
    for (int round = 0; round < kRounds; ++round)
      if (!improve(triangles_near(v), kGoalBeside)) break;
    return true;
  }

  /// The triangles within two edges of a vertex.
  [[nodiscard]] std::vector<std::int32_t> triangles_near(std::int32_t v) const {
    std::vector<std::int32_t> result;
    for (const std::int32_t w : mesh_.neighbors(v))
      result.insert(result.end(), mesh_.around(w).begin(), mesh_.around(w).end());
    sort_unique(result);
    return result;
  }

  const Surface& surface_;
  const FeatureLines& lines_;
  RemeshSites& sites_;
  MeshEditor mesh_;
  const Context* context_;
  std::map<std::int32_t, ChainPlaces> chains_;
  std::size_t removed_ = 0;
  bool may_collapse_ = true;
};

}  // namespace

void polish(const Surface& surface, const FeatureLines& lines, std::size_t count,
            RemeshSites& sites, Dual& dual, const Context* context) {
  Polisher polisher(surface, lines, sites, dual, context);
  polisher.run(count);
  dual.triangles = polisher.mesh().triangles();
  dual.lines = polisher.mesh().lines();
}

}  // namespace dapple
