// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/neighbors.hpp>
#include <dapple/refine.hpp>
#include <dapple/remesh.hpp>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/sets.hpp"
#include "base/sort_unique.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "density/piece_finder.hpp"
#include "lines/line_sites.hpp"
#include "remesh/adapted_density.hpp"
#include "remesh/dual.hpp"
#include "remesh/far_places.hpp"
#include "remesh/measure.hpp"
#include "remesh/polish.hpp"
#include "remesh/site_editor.hpp"
#include "sample/solve_classes.hpp"
#include "sample/surface_classes.hpp"
#include "sample/timed_call.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr int kMendings = 30;                           // rounds of adding sites
constexpr int kPatience = 6;                            // rounds that mend nothing in total
constexpr std::size_t kMostTimes = 4, kMostMore = 500;  // most sites, by the count asked for
constexpr int kDroppings = 6;                           // times that creases are given up
constexpr int kThinnings = 6;                           // rounds of taking sites away elsewhere
constexpr int kTurnings = 4;                            // rounds for triangles that face away
constexpr int kTurnsInRow = 3;       // sites added in one, because others may turn over then
constexpr std::size_t kSkips = 4;    // sites tried to be taken away instead
constexpr int kApproaches = 60;      // rounds of adding sites at far places
constexpr int kSettlings = 4;        // of them, after which others move
constexpr double kRough = 10.0;      // times the tolerance, beside lines that changed
constexpr int kFewEvaluations = 12;  // after local changes
constexpr double kFirst = 0.6, kSecond = 0.8;  // of the progress, if it is done again
constexpr double kFiner = 0.5;                 // spacings: their edges
constexpr std::size_t kFinerFaces = 40;
constexpr std::size_t kRefinings = 1;  // times that faces are made finer still
constexpr double kFinest = 1.0 / 64;   // of the same: the shortest
constexpr double kSolved = 0.8;        // of the progress
constexpr double kMended = 0.95;
constexpr double kThinned = 0.8;  // if there is a limit of the distance
constexpr double kHalfWay = 8.0;  // rounds after which half of the rest is done
constexpr double kLearned = 0.7;  // of the progress, if the density is adapted
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr int kAdaptations = 4;       // meshes after the first, to be nearer to the surface
constexpr int kAdaptingPatience = 2;  // of them without gain
constexpr double kFlat = 1e-6;        // spacings: such a distance is rounding

/// The distance between neighbors where the density is 1, if `count` vertices are spaced evenly:
/// those on borders have half a cell.
double unit_spacing(const Surface& surface, double border, std::size_t count) {
  const auto n = static_cast<double>(count);
  const double half = 0.25 * border / n, area = 2.0 * surface.capacity() / std::numbers::sqrt3 / n;
  return half + std::sqrt(half * half + area);
}

ClassOptions class_options(const RemeshOptions& options) {
  ClassOptions result;
  result.sample.seed = options.seed;
  result.sample.optimizer = options.optimizer;
  result.sample.cells = options.cells;
  return result;
}

LineRules rules_of(const Surface& surface, std::size_t count, const RemeshOptions& options) {
  return {.feature_angle = options.feature_angle,
          .scale = surface.spacing(count),
          .marked = options.edges};
}

/// Finds the sites whose dual is the mesh.
class Remesher {
 public:
  /// The surface and the options must outlive it.
  /// \param start free sites of an earlier solution; none: a random start
  Remesher(const Surface& surface, std::size_t count, const RemeshOptions& options,
           FeatureLines lines, Sites start = {})
      : surface_(surface),
        count_(count),
        options_(options),
        lines_(std::move(lines)),
        solution_(std::move(start)) {}

  /// Take cells by distances along the surface, whose faces are to be smaller than the cells.
  void follow_surface() { along_ = std::make_shared<const CellsAlong>(surface_); }

  void run(Context* context) {
    const double end = options_.max_distance > 0.0 ? kThinned : 1.0;
    Stretch solving(context, 0.0, end * kSolved), mending(context, end * kSolved, end * kMended),
        thinning(context, end * kMended, end), approaching(context, end, 1.0);
    solve(solving.context());
    mend_all(mending.context());
    keep_best();
    thin_all(thinning.context());
    turn_all(thinning.context());
    approach(approaching.context());
  }

  /// Drop creases and marked edges where nothing else helps, after run() has left flaws.
  void give_up(Context* context) {
    best_sites_ = {};  // it holds a mesh that keeps all lines
    distance_ = 0.0;
    dense_ = false;
    Stretch mending(context, 0.0, kMended), thinning(context, kMended, 1.0);
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (int k = 0; k < kDroppings && !dual_.violations.empty() && drop_hopeless(); ++k) {
      solve(mending.context());
      mend_all(mending.context());
      if (dual_.violations.size() >= least) break;
      least = dual_.violations.size();
    }
    keep_best();
    thin_all(thinning.context());
    turn_all(thinning.context());
    approach(thinning.context());
  }

  /// Add many sites at a time, where nothing else has helped.
  void insist(Context* context) {
    Stretch mending(context, 0.0, kMended), thinning(context, kMended, 1.0);
    dense_ = true;
    sites_ = best_sites_;
    dual_ = best_;
    mend_densely(mending.context());
    keep_best();
    thin_all(thinning.context());
    turn_all(thinning.context());
    approach(thinning.context());
  }

  /// The best mesh, with its thin triangles made wider.
  [[nodiscard]] RemeshResult result(Context* context) const;
  [[nodiscard]] std::size_t flaws() const { return best_.violations.size(); }

  /// Per face the longest edge with which cells that are flawed have faces smaller than themselves.
  [[nodiscard]] std::vector<double> finer_edges() const;

  /// The sites of the last solution that are on no line.
  [[nodiscard]] Sites free_sites() const { return without_first(solution_, solved_lines_); }

 private:
  /// Drop creases at which the topology cannot be reached, such as two that touch; then marked
  /// edges.
  bool drop_hopeless() {
    std::vector<bool> hopeless(lines_.chains().size(), false);
    const auto mark = [&](std::int32_t chain) {
      if (chain >= 0) hopeless[as_index(chain)] = true;
    };
    for (const Violation& violation : dual_.violations) {
      mark(sites_.chains[as_index(violation.site)]);
      if (violation.place.half_edge >= 0) mark(lines_.chain_of(violation.place.half_edge));
    }
    std::size_t dropped = lines_.drop_chains(surface_, hopeless, LineKind::kCrease,
                                             rules_of(surface_, count_, options_));
    if (dropped == 0)
      dropped = lines_.drop_chains(surface_, hopeless, LineKind::kMarked,
                                   rules_of(surface_, count_, options_));
    dropped_lines_ += dropped;
    return dropped > 0;
  }

  /// The spacing along lines where the density is 1. Where it varies, lines may lie where it is
  /// largest; they get no more sites than all together.
  [[nodiscard]] double line_spacing(std::size_t count) const {
    const double border = metric_length(surface_, lines_, /*borders_only=*/true);
    return std::max(
        unit_spacing(surface_, border, count),
        metric_length(surface_, lines_, /*borders_only=*/false) / static_cast<double>(count));
  }

  void solve(Context* context) {
    const LineSites on_lines = sites_on_lines(surface_, lines_, line_spacing(count_));
    const SampleClass all{.count = std::max(count_, on_lines.sites.size()),
                          .locked = on_lines.sites};
    const Sites start = solution_beside(on_lines.sites, all.count - on_lines.sites.size());
    const bool again = start.size() > 0;
    const ClassMinimum found =
        again ? solve_from(on_lines.sites, start, context) : solve_anew(all, context);
    evaluations_ += found.minimum.evaluations;
    converged_ = found.minimum.converged;
    solution_ = found.minimum.state.sites;
    solved_lines_ = on_lines.sites.size();
    sites_ = {};
    sites_.add(found.minimum.state.sites, SiteKind::kFree, -1, false);
    for (std::size_t k = 0; k < on_lines.sites.size(); ++k) {
      sites_.kinds[k] = k < on_lines.corners ? SiteKind::kCorner : SiteKind::kLine;
      sites_.chains[k] = on_lines.chains[k];
    }
  }

  [[nodiscard]] ClassMinimum solve_anew(const SampleClass& all, Context* context) const {
    ClassProblem problem = problem_of(all);
    problem.classes[0].locked_among = [this](std::size_t count) {
      return sites_on_lines(surface_, lines_, line_spacing(count)).sites;
    };
    return dapple::solve(problem, class_options(options_), context);
  }

  /// So many sites of the last solution: those farthest from places on lines, which may be their
  /// own; none if there are too few.
  [[nodiscard]] Sites solution_beside(const Sites& places, std::size_t count) const {
    if (solution_.size() < count || places.size() == 0) return {};
    const Neighbors tree(places.positions);
    std::vector<Neighbor> nearest;
    std::vector<std::pair<double, std::int32_t>> order;  // farthest first, then the lower index
    for (std::size_t k = 0; k < solution_.size(); ++k) {
      tree.nearest(solution_.positions[k], 1, nearest);
      order.emplace_back(-nearest[0].squared_distance, static_cast<std::int32_t>(k));
    }
    std::ranges::sort(order);
    std::vector<std::int32_t> members;
    for (std::size_t k = 0; k < count; ++k) members.push_back(order[k].second);
    std::ranges::sort(members);
    return select(solution_, members);
  }

  /// Space free sites evenly among those on lines, from where they are.
  [[nodiscard]] ClassMinimum solve_from(const Sites& on_lines, const Sites& start,
                                        Context* context) const {
    Sites sites = on_lines;
    append(sites, start);
    const SampleClass all{.count = sites.size()};
    const ClassProblem problem = problem_of(all);
    std::vector<bool> locked(sites.size(), false);
    std::fill_n(locked.begin(), on_lines.size(), true);
    OptimizerOptions optimizer = options_.optimizer;
    optimizer.tolerance *= kRough;
    return dapple::solve(
        make_objective(problem, class_of_sites(problem), class_options(options_), locked), sites,
        optimizer, context);
  }

  /// Sites on the edges of thin walls belong to both sides, which are not taken apart then.
  [[nodiscard]] ClassProblem problem_of(const SampleClass& all) const {
    return surface_classes(surface_, {&all, 1}, options_.cells,
                           lines_.chains().empty() ? KnownSides() : KnownSides(nullptr));
  }

  /// Space the free sites among the marked ones evenly again.
  void settle(const std::vector<bool>& moving, Context* context) {
    const SampleClass all{.count = sites_.size()};
    const ClassProblem problem = problem_of(all);
    std::vector<bool> locked(sites_.size());
    for (std::size_t k = 0; k < locked.size(); ++k)
      locked[k] = sites_.kinds[k] != SiteKind::kFree || !moving[k];
    OptimizerOptions optimizer = options_.optimizer;
    optimizer.max_evaluations = std::min(optimizer.max_evaluations, kFewEvaluations);
    ClassMinimum found = dapple::solve(
        make_objective(problem, class_of_sites(problem), class_options(options_), locked),
        sites_.sites, optimizer, context);
    evaluations_ += found.minimum.evaluations;
    sites_.sites = std::move(found.minimum.state.sites);
  }

  void look(Context* context) {
    const StageSpan looking(context, Stage::kCells);
    dual_ = along_ ? dual_of(surface_, lines_, sites_.sites, sites_.kinds, *along_, context)
                   : dual_of(surface_, lines_, sites_.sites, sites_.kinds, options_.cells, context);
  }

  /// Add sites until the dual has the topology of the surface.
  void mend_all(Context* context) {
    if (!add_sites(false, context) && dense_) mend_densely(context);
  }

  /// Where walls are thinner than cells, as of fingers, new sites bring new flaws for a while: if
  /// few at a time mend nothing, many at a time may.
  void mend_densely(Context* context) {
    RemeshSites sites = sites_;
    Dual dual = dual_;
    std::size_t least = dual.violations.size() / 2;  // more sites are worth no less
    const auto look_back = [&] {
      if (dual_.violations.size() > least) return;
      least = dual_.violations.size();
      sites = sites_;
      dual = dual_;
    };
    if (add_sites(true, context, look_back)) return;
    sites_ = std::move(sites);
    dual_ = std::move(dual);
  }

  /// \param dense many at a time
  /// \param looked called after each look
  /// \return whether nothing is left to mend
  bool add_sites(bool dense, Context* context, const std::function<void()>& looked = [] {}) {
    std::size_t least = std::numeric_limits<std::size_t>::max();
    int since = 0;  // rounds without progress
    const std::size_t most = kMostTimes * count_ + kMostMore;
    for (int k = 0; k < kMendings && since < kPatience && sites_.size() < most; ++k) {
      check_context(context);
      look(nullptr);
      looked();
      since = dual_.violations.size() < least ? 0 : since + 1;
      least = std::min(least, dual_.violations.size());
      if (dual_.violations.empty()) return true;
      if (mend(surface_, lines_, dual_.violations, sites_, dense) == 0) return false;
    }
    look(nullptr);
    looked();
    return dual_.violations.empty();
  }

  void keep_best() {
    const auto worth = [](const Dual& dual, std::size_t sites) {
      return std::pair(dual.violations.size(), sites);
    };
    if (!best_sites_.kinds.empty() &&
        worth(best_, best_sites_.size()) <= worth(dual_, sites_.size()))
      return;
    best_ = dual_;
    best_sites_ = sites_;
  }

  void thin_all(Context* context) {
    for (int k = 0; k < kThinnings && best_sites_.size() > count_ && best_.violations.empty(); ++k)
      if (!thin(context)) break;
  }

  /// Take away as many sites as there are too many, where the topology does not need them.
  /// \param skipped sites that would be the first, but that did not help
  bool thin(Context* context, std::size_t skipped = 0) {
    sites_ = best_sites_;
    dual_ = best_;
    const std::vector<Face> triangles = dual_.triangles;
    const std::size_t before = sites_.size();
    if (thin_out(dual_, before - count_, sites_, skipped) == 0) return false;
    std::vector<bool> stays(sites_.size());
    look(nullptr);
    for (std::size_t k = 0; k < stays.size(); ++k) stays[k] = sites_.pinned[k];
    stays = widened(dual_.triangles, std::move(stays), 1);
    stays.flip();
    settle(stays, context);
    mend_all(context);
    const bool better = dual_.violations.empty() && sites_.size() < before;
    keep_best();
    return better;
  }

  /// Where triangles face away from the surface, as across its folds, add sites, and take as many
  /// away elsewhere.
  void turn_all(Context* context) {
    std::size_t tried = std::numeric_limits<std::size_t>::max();  // fewer where some spoil others
    for (int k = 0; k < kTurnings && best_.violations.empty(); ++k) {
      const std::vector<Violation> away = away_from_surface(best_, best_sites_);
      if (away.empty() || tried == 0 || polish_turns_all(context)) break;
      tried = std::min(tried, away.size());
      if (!turn(away, tried, context)) tried /= 2;
    }
  }

  /// Whether no triangle of the best mesh faces away any more once thin ones are wider, which costs
  /// far less than more sites.
  [[nodiscard]] bool polish_turns_all(Context* context) const {
    if (options_.max_distance > 0.0) return false;  // it may not be kept
    if (best_sites_.size() > count_) return false;  // turning may take away those too many
    RemeshSites sites = best_sites_;
    Dual dual = best_;
    polish(surface_, lines_, count_, sites, dual, context);
    return facing_away(surface_, lines_, dual.triangles, sites.sites).empty();
  }

  [[nodiscard]] std::vector<Violation> away_from_surface(const Dual& dual,
                                                         const RemeshSites& sites) const {
    std::vector<Violation> result;
    for (const std::size_t k : facing_away(surface_, lines_, dual.triangles, sites.sites))
      result.push_back({dual.triangles[k][0], Flaw::kAway, dual.corners[k], {}});
    return result;
  }

  /// \return whether fewer triangles face away, with as many sites as asked for if there were
  /// before
  bool turn(const std::vector<Violation>& away, std::size_t tried, Context* context) {
    const RemeshSites sites = best_sites_;
    const Dual dual = best_;
    sites_ = sites;
    dual_ = dual;
    std::vector<Violation> now(away.begin(), away.begin() + static_cast<std::ptrdiff_t>(tried));
    for (int k = 0; k < kTurnsInRow && !now.empty(); ++k) {  // those around may turn over then
      if (mend(surface_, lines_, now, sites_) == 0) break;
      mend_all(context);
      if (!dual_.violations.empty()) return false;
      now = away_from_surface(dual_, sites_);
      if (tried < away.size()) break;
    }
    best_sites_ = sites_;
    best_ = dual_;
    thin_all(context);
    for (std::size_t k = 1; k <= kSkips && best_sites_.size() > count_; ++k) thin(context, k);
    if ((best_sites_.size() <= count_ || sites.size() > count_) &&
        away_from_surface(best_, best_sites_).size() < away.size())
      return true;
    best_sites_ = sites;
    best_ = dual;
    return false;
  }

  /// Add sites where the mesh and the surface are farther apart than they may be.
  void approach(Context* context) {
    if (options_.max_distance == 0.0 || !best_.violations.empty()) return;
    const DistanceCheck check(surface_, lines_, context);
    sites_ = best_sites_;
    dual_ = best_;
    distance_ = std::numeric_limits<double>::infinity();
    FarPlaces far = far_places(check, context);
    const std::size_t most = kMostTimes * count_ + kMostMore;
    // Some of the places may break the topology: fewer of them are tried then, down to each alone.
    std::size_t tried = far.places.size();
    for (int k = 0; k < kApproaches && !far.places.empty() && sites_.size() < most; ++k) {
      Stretch round(context, k / (k + kHalfWay), (k + 1.0) / (k + 1.0 + kHalfWay));
      tried = std::min(tried, far.places.size());
      if (mend(surface_, lines_, {far.places.data(), tried}, sites_) == 0) break;
      if (k < kSettlings) settle_others(round.context());
      mend_all(context);
      if (dual_.violations.empty()) {
        far = far_places(check, context);
        continue;
      }
      sites_ = looked_at_sites_;
      if (tried == 1) far.places.erase(far.places.begin());
      tried = std::max<std::size_t>(tried / 2, 1);
    }
  }

  /// Where the last mesh is too far from the surface; it is kept if it is the nearest so far.
  [[nodiscard]] FarPlaces far_places(const DistanceCheck& check, Context* context) {
    FarPlaces far = check.far_places(dual_, sites_.sites, options_.max_distance, context);
    looked_at_sites_ = sites_;
    if (far.largest < distance_) {
      best_ = dual_;
      best_sites_ = sites_;
      distance_ = far.largest;
    }
    return far;
  }

  /// Make thin triangles of a mesh wider, if it stays within the limit of the distance.
  /// \return the distance
  double polish_within_limit(RemeshSites& sites, Dual& dual, Context* context) const {
    const RemeshSites before = sites;
    const Dual dual_before = dual;
    polish(surface_, lines_, count_, sites, dual, context);
    if (options_.max_distance == 0.0 || distance_ == 0.0) return distance_;
    const double distance = DistanceCheck(surface_, lines_, context)
                                .far_places(dual, sites.sites, options_.max_distance, context)
                                .largest;
    if (distance <= std::max(options_.max_distance, distance_)) return distance;
    sites = before;
    dual = dual_before;
    return distance_;
  }

  /// Space those free sites evenly that were not added where they are needed.
  void settle_others(Context* context) {
    std::vector<bool> moving = sites_.pinned;
    moving.flip();
    settle(moving, context);
  }

  const Surface& surface_;
  std::size_t count_;
  const RemeshOptions& options_;
  FeatureLines lines_;
  std::shared_ptr<const CellsAlong> along_;  // null: cells in space
  Sites solution_;                           // of the last solve(), those on lines first
  std::size_t solved_lines_ = 0;             // of them
  RemeshSites sites_, best_sites_;
  Dual dual_, best_;
  std::size_t dropped_lines_ = 0;
  bool dense_ = false;           // sites may be added many at a time
  double distance_ = 0.0;        // of the best mesh; 0: it was not looked at
  RemeshSites looked_at_sites_;  // by the last far_places()
  int evaluations_ = 0;
  bool converged_ = true;
};

/// Give each fan of triangles its own vertex, connected over edges with two triangles.
void cut_apart(RemeshResult& mesh) {
  using Half = std::array<std::int32_t, 3>;  // an edge, and the corner where it starts
  std::vector<Half> halves;
  const auto corner_count = static_cast<std::int32_t>(3 * mesh.faces.size());
  const auto vertex = [&](std::int32_t corner) -> std::int32_t& {
    return mesh.faces[as_index(corner / 3)][as_index(corner % 3)];
  };
  const auto next = [](std::int32_t corner) { return corner - corner % 3 + (corner + 1) % 3; };
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto [a, b] = std::minmax(vertex(c), vertex(next(c)));
    halves.push_back({a, b, c});
  }
  std::ranges::sort(halves);
  Sets fans(as_index(corner_count));
  for (std::size_t k = 0, end = 0; k < halves.size(); k = end) {
    while (end < halves.size() && halves[end][0] == halves[k][0] && halves[end][1] == halves[k][1])
      ++end;
    const std::int32_t c = halves[k][2], d = halves[end - 1][2];
    if (end - k != 2) continue;
    const bool opposite = vertex(c) != vertex(d);
    fans.join(c, opposite ? next(d) : d);
    fans.join(next(c), opposite ? d : next(d));
  }
  std::vector<std::int32_t> root(mesh.vertices.size(), -1), made(as_index(corner_count), -1);
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto fan = fans.find(c);
    const auto v = as_index(vertex(c));
    std::int32_t& number = made[as_index(fan)];
    if (number < 0 && root[v] < 0) number = root[v] = static_cast<std::int32_t>(v);
    if (number < 0) {
      number = static_cast<std::int32_t>(mesh.vertices.size());
      mesh.vertices.push_back(Vec3(mesh.vertices[v]));
      mesh.source_faces.push_back(std::int32_t(mesh.source_faces[v]));
      mesh.barycentric.push_back(Vec3(mesh.barycentric[v]));
      mesh.features.push_back(VertexFeature(mesh.features[v]));
    }
  }
  std::vector<std::array<std::int32_t, 2>> lines;
  std::vector<bool> on_line(as_index(corner_count));
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto [a, b] = std::minmax(vertex(c), vertex(next(c)));
    on_line[as_index(c)] =
        std::ranges::binary_search(mesh.lines, std::array<std::int32_t, 2>{a, b});
  }
  for (std::int32_t c = 0; c < corner_count; ++c) vertex(c) = made[as_index(fans.find(c))];
  for (std::int32_t c = 0; c < corner_count; ++c) {
    const auto [a, b] = std::minmax(vertex(c), vertex(next(c)));
    if (on_line[as_index(c)]) lines.push_back({a, b});
  }
  sort_unique(lines);
  mesh.lines = std::move(lines);
}

/// Sort the triangles, and drop those that lie on others, which are flaws of the topology.
void sort_faces(std::vector<Face>& faces) {
  std::ranges::sort(faces, {}, [](Face t) {
    const Face turned = t;
    std::ranges::sort(t);
    return std::pair(t, turned);
  });
  const auto rest = std::ranges::unique(faces, {}, [](Face t) {
    std::ranges::sort(t);
    return t;
  });
  faces.erase(rest.begin(), rest.end());
  std::ranges::sort(faces);
}

RemeshResult Remesher::result(Context* context) const {
  RemeshSites sites = best_sites_;
  Dual dual = best_;
  const double distance = polish_within_limit(sites, dual, context);
  RemeshResult mesh;
  std::vector<std::int32_t> number(sites.size(), -1);
  for (const Face& triangle : dual.triangles)
    for (const std::int32_t v : triangle) number[as_index(v)] = 0;
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (number[k] < 0) continue;
    number[k] = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.push_back(sites.sites.positions[k]);
    mesh.source_faces.push_back(sites.sites.faces[k]);
    mesh.barycentric.push_back(sites.sites.barycentric[k]);
    mesh.features.push_back(static_cast<VertexFeature>(sites.kinds[k]));
  }
  for (const auto& [a, b, c] : dual.triangles)
    mesh.faces.push_back({number[as_index(a)], number[as_index(b)], number[as_index(c)]});
  for (const auto& [a, b] : dual.lines) {
    const std::int32_t u = number[as_index(a)], v = number[as_index(b)];
    if (u >= 0 && v >= 0) mesh.lines.push_back({u, v});
  }
  sort_faces(mesh.faces);
  if (options_.non_manifold == NonManifold::kCut) cut_apart(mesh);
  mesh.report.asked = count_;
  mesh.report.flaws = best_.violations.size();
  mesh.report.dropped_lines = dropped_lines_;
  mesh.report.distance = distance;
  mesh.report.evaluations = evaluations_;
  mesh.report.converged = converged_;
  return mesh;
}

std::vector<double> Remesher::finer_edges() const {
  std::vector<double> longest(surface_.face_count(), std::numeric_limits<double>::infinity());
  if (best_sites_.size() < 2) return longest;
  std::vector<bool> flawed(best_sites_.size(), false);
  for (const Violation& violation : best_.violations) flawed[as_index(violation.site)] = true;
  const double least = kFinest * surface_.spacing(count_);
  const Neighbors tree(best_sites_.sites.positions);
  std::vector<Neighbor> nearest;
  for (const CellPolygon& piece : along_->polygons(best_sites_.sites)) {
    const auto site = as_index(piece.site);
    if (!flawed[site]) continue;
    tree.nearest(best_sites_.sites.positions[site], 2, nearest);
    double& edge = longest[as_index(piece.face)];
    edge = std::min(edge, kFiner * std::max(std::sqrt(nearest[1].squared_distance), least));
  }
  return longest;
}

void check(std::size_t count, const RemeshOptions& options) {
  check_options(options);
  if (count == 0) throw ArgumentError("count is 0: it must be >= 1");
  check_count("count", count);
}

}  // namespace

namespace {

/// Move the vertices from finer faces to those of the surface.
void name_parents(const Refined& fine, RemeshResult& mesh) {
  const OrderedSurface& whole = fine.original.ordered();
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const auto piece = as_index(mesh.source_faces[k]);
    Vec3 weights = Vec3::Zero();
    for (int c = 0; c < 3; ++c)
      weights += mesh.barycentric[k][c] * fine.barycentric[piece][as_index(c)];
    mesh.source_faces[k] = fine.parents[piece];
    mesh.barycentric[k] = weights;
    mesh.vertices[k] = whole.point(whole.ordered_face(fine.parents[piece]), weights);
  }
}

/// Sites of a surface on its finer faces.
Sites on_pieces(const Refined& fine, const Sites& sites) {
  const PieceFinder finder(fine);
  Sites result;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const auto [face, inside] = finder.find(sites.faces[k], sites.barycentric[k]);
    result.positions.push_back(fine.surface.point(face, inside));
    result.faces.push_back(face);
    result.barycentric.push_back(inside);
  }
  return result;
}

/// Cells in space reach through walls thinner than themselves; those along the surface do not, but
/// need faces that are smaller than they are. Where flaws remain, sites are closer to each other
/// than elsewhere, and faces are made smaller again.
/// \param start free sites of a solution on the surface
RemeshResult remesh_along(const Surface& surface, std::size_t count, const RemeshOptions& options,
                          const FeatureLines& lines, const Sites& start, Context* context) {
  const std::size_t most =
      std::min(kMostRefinedFaces, kFinerFaces * (count + surface.face_count()));
  const double longest = kFiner * surface.spacing(count);
  Refined fine = refine_edges(surface, {&longest, 1}, most, nullptr);
  for (std::size_t k = 0;; ++k) {
    Stretch trying(context, k, kRefinings + 2);
    Stretch first(trying.context(), 0.0, kFirst), second(trying.context(), kFirst, kSecond),
        third(trying.context(), kSecond, 1.0);
    Remesher remesher(fine.surface, count, options,
                      FeatureLines(fine, lines, rules_of(surface, count, options)),
                      on_pieces(fine, start));
    if (k > 0) remesher.follow_surface();  // finer faces alone may help
    remesher.run(first.context());
    if (remesher.flaws() > 0 && k == 0) continue;
    if (remesher.flaws() > 0 && k <= kRefinings) {
      fine = fine.then(refine_edges(fine.surface, remesher.finer_edges(), most, nullptr));
      continue;
    }
    if (remesher.flaws() > 0) remesher.insist(second.context());
    RemeshResult made;
    if (const std::size_t flaws = remesher.flaws(); flaws > 0) {
      const Remesher whole = remesher;  // with all lines
      remesher.give_up(third.context());
      made = (remesher.flaws() < flaws ? remesher : whole).result(context);
    } else {
      made = remesher.result(context);
    }
    name_parents(fine, made);
    return made;
  }
}

/// \param lines of the surface, with any density
RemeshResult best_remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                         const FeatureLines& lines, Context* context) {
  Stretch first(context, 0.0, kFirst), second(context, kFirst, 1.0);
  Remesher remesher(surface, count, options, lines);
  remesher.run(first.context());
  const std::size_t flaws = remesher.flaws();
  RemeshResult made;
  if (flaws > 0)
    made = remesh_along(surface, count, options, lines, remesher.free_sites(), second.context());
  if (flaws == 0 || flaws < made.report.flaws) made = remesher.result(context);
  const StageSpan reporting(context, Stage::kReporting);
  measure_mesh(surface, lines, made);
  return made;
}

/// A density at corners, and the evaluations by which it was found.
struct Adapted {
  std::vector<double> density;  // empty: the surface's own
  int evaluations = 0;
};

Surface with_values(const Surface& surface, const std::vector<double>& density) {
  return density.empty() ? surface : surface.with_density({DensityAt::kCorners, density});
}

/// The density by which a mesh is nearest to the surface. It is learned from meshes that
/// are not solved to their end, each denser where the one before was far from the surface.
Adapted adapted_density(const Surface& surface, std::size_t count, const RemeshOptions& options,
                        const FeatureLines& lines, Context* context) {
  RemeshOptions rough = options;
  rough.max_distance = 0.0;
  rough.optimizer.tolerance *= kRough;
  const DistanceCheck check(surface, lines, context);
  AdaptedDensity density(surface, count);
  Adapted best;
  std::vector<double> now;
  Sites start;
  auto least = std::tuple(kNone, kNone, 0.0);  // flaws, vertices, distance
  for (int k = 0, since = 0; k <= kAdaptations && since < kAdaptingPatience; ++k) {
    Stretch round(context, k / (kAdaptations + 1.0), (k + 1.0) / (kAdaptations + 1.0));
    const Surface dense = with_values(surface, now);
    Remesher remesher(dense, count, rough, lines, start);
    remesher.run(round.context());
    start = remesher.free_sites();
    const RemeshResult mesh = remesher.result(context);
    best.evaluations += mesh.report.evaluations;
    const MeshDistances far = check.distances(mesh, context);
    const auto worth = std::tuple(mesh.report.flaws, mesh.vertices.size(), far.largest);
    since = worth < least ? 0 : since + 1;
    if (worth < least) best.density = now;
    least = std::min(least, worth);
    if (far.largest <= kFlat * surface.spacing(count)) break;
    density.learn(mesh.vertices, far.of_vertices);
    now = density.values();
  }
  return best;
}

RemeshResult adapted_remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                            const FeatureLines& lines, Context* context) {
  Stretch learning(context, 0.0, kLearned), last(context, kLearned, 1.0);
  const Adapted adapted = adapted_density(surface, count, options, lines, learning.context());
  RemeshResult mesh =
      best_remesh(with_values(surface, adapted.density), count, options, lines, last.context());
  mesh.density = adapted.density;
  mesh.report.evaluations += adapted.evaluations;
  mesh.report.distance = DistanceCheck(surface, lines, context).distances(mesh, context).largest;
  return mesh;
}

RemeshResult remesh_by(const Surface& surface, std::size_t count, const RemeshOptions& options,
                       Context* context) {
  const FeatureLines lines(surface, rules_of(surface, count, options), context);
  return options.adaptive ? adapted_remesh(surface, count, options, lines, context)
                          : best_remesh(surface, count, options, lines, context);
}

}  // namespace

RemeshResult remesh(const Surface& surface, std::size_t count, const RemeshOptions& options,
                    Context* context) {
  TimedCall call(context);
  check(count, options);
  if (context) context->check();
  RemeshResult mesh = with_threads(
      options.threads, [&] { return remesh_by(surface, count, options, call.context()); });
  Report times;
  call.write(times);
  mesh.report.seconds = times.seconds;
  mesh.report.profile = times.profile;
  if (context) context->advance(1.0);
  return mesh;
}

}  // namespace dapple
