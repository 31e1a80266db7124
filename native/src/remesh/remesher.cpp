// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/remesher.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <limits>
#include <numbers>

#include "base/progress.hpp"
#include "lines/line_places.hpp"
#include "lines/line_sites.hpp"
#include "remesh/cut_apart.hpp"
#include "remesh/measure.hpp"
#include "remesh/polish.hpp"
#include "sample/surface_classes.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr int kMendings = 30;                      // rounds of adding sites
constexpr int kPatience = 7, kDensePatience = 14;  // of them that mend nothing in total
constexpr int kStalled = 2;                        // the same, before many are added at a time
constexpr int kHalvings = 3;      // rounds in which cells in space must lose half of their flaws
constexpr std::size_t kFew = 10;  // flaws that need not be halved
constexpr std::size_t kHopeless = 4;  // flaws a site: cells reach through walls everywhere
constexpr std::size_t kMostTimes = 4, kMostMore = 500;  // most sites, by the count asked for
constexpr int kDroppings = 6;                           // times that creases are given up
constexpr int kThinnings = 16;                          // rounds of taking sites away elsewhere
constexpr int kShortThinnings = 6;                      // the same, if they take few
constexpr std::size_t kLeastThinned = 32;               // that are not few
constexpr int kTurnings = 4;                            // rounds for triangles that face away
constexpr int kTurnsInRow = 3;        // sites added in one, because others may turn over then
constexpr std::size_t kSkips = 4;     // sites tried to be taken away instead
constexpr int kApproaches = 60;       // rounds of adding sites at far places
constexpr int kSettlings = 4;         // of them, after which others move
constexpr double kRough = 10.0;       // times the tolerance, of sites that were even before
constexpr int kFewEvaluations = 12;   // after local changes
constexpr double kFinest = 1.0 / 64;  // of the same: the shortest
constexpr double kSolved = 0.8;       // of the progress
constexpr double kMended = 0.95;
constexpr double kThinned = 0.8;  // if there is a limit of the distance
constexpr double kHalfWay = 8.0;  // rounds after which half of the rest is done
constexpr double kOnLine = 1e-6;  // of the spacing, a distance that is rounding

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

/// How long adding sites has mended nothing.
class Stalls {
 public:
  explicit Stalls(std::size_t sites) : sites_(sites) {}

  void add(std::size_t flaws) {
    since_ = flaws < least_ ? 0 : since_ + 1;
    least_ = std::min(least_, flaws);
    since_half_ = 2 * flaws < half_ ? 0 : since_half_ + 1;
    if (since_half_ == 0) half_ = flaws;
  }

  [[nodiscard]] int since() const { return since_; }

  /// Whether cells in space cannot have the topology: they reach through walls in too many places.
  [[nodiscard]] bool are_hopeless() const {
    return (since_half_ >= kHalvings && least_ > kFew) || least_ > kHopeless * sites_;
  }

 private:
  std::size_t sites_;
  int since_ = 0, since_half_ = 0;
  std::size_t least_ = std::numeric_limits<std::size_t>::max(), half_ = least_;
};

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

}  // namespace

LineRules rules_of(const Surface& surface, std::size_t count, const RemeshOptions& options) {
  return {.feature_angle = options.feature_angle,
          .scale = surface.spacing(count),
          .marked = options.edges};
}

double line_spacing(const Surface& surface, const FeatureLines& lines, std::size_t count) {
  const double border = metric_length(surface, lines, /*borders_only=*/true);
  return std::max(
      unit_spacing(surface, border, count),
      metric_length(surface, lines, /*borders_only=*/false) / static_cast<double>(count));
}

void name_lines(const Surface& surface, const FeatureLines& lines, RemeshSites& sites) {
  const LinePlaces places(surface, lines);
  const double tolerance = kOnLine * surface.spacing(sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) {
    if (sites.is_free(k)) continue;
    const LinePlace place = places.find(sites.sites.faces[k], sites.sites.positions[k], tolerance);
    sites.chains[k] = place.chain;
    sites.kinds[k] = place.corner >= 0  ? SiteKind::kCorner
                     : place.chain >= 0 ? SiteKind::kLine
                                        : SiteKind::kFree;
  }
}

void Remesher::run(Context* context) {
  const double end = options_.max_distance > 0.0 ? kThinned : 1.0;
  Stretch solving(context, 0.0, end * kSolved), mending(context, end * kSolved, end * kMended),
      thinning(context, end * kMended, end), approaching(context, end, 1.0);
  solve(solving.context());
  mend_all(mending.context());
  thin_all(thinning.context());
  turn_all(thinning.context());
  approach(approaching.context());
}

void Remesher::give_up(Context* context) {
  best_sites_ = {};  // it holds a mesh that keeps all lines
  distance_ = 0.0;
  gives_up_ = true;
  Stretch mending(context, 0.0, kMended), thinning(context, kMended, 1.0);
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (int k = 0; k < kDroppings && !dual_.violations.empty() && drop_hopeless(); ++k) {
    solve(mending.context());
    mend_all(mending.context());
    if (dual_.violations.size() >= least) break;
    least = dual_.violations.size();
  }
  thin_all(thinning.context());
  turn_all(thinning.context());
  approach(thinning.context());
}

bool Remesher::drop_hopeless() {
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

void Remesher::solve_given(Context* context) {
  sites_ = given_;
  name_lines(surface_, lines_, sites_);
  settle(std::vector<bool>(sites_.size(), true), context);
}

void Remesher::solve(Context* context) {
  if (given_.size() > 0) {
    solve_given(context);
    return;
  }
  const LineSites on_lines =
      sites_on_lines(surface_, lines_, line_spacing(surface_, lines_, count_));
  const SampleClass all{.count = std::max(count_, on_lines.sites.size()), .locked = on_lines.sites};
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

ClassMinimum Remesher::solve_anew(const SampleClass& all, Context* context) const {
  ClassProblem problem = problem_of(all);
  problem.classes[0].locked_among = [this](std::size_t count) {
    return sites_on_lines(surface_, lines_, line_spacing(surface_, lines_, count)).sites;
  };
  return dapple::solve(problem, class_options(options_), context);
}

Sites Remesher::solution_beside(const Sites& places, std::size_t count) const {
  if (solution_.size() < count) return {};
  if (places.size() == 0) return solution_.size() == count ? solution_ : Sites();
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

ClassMinimum Remesher::solve_from(const Sites& on_lines, const Sites& start,
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

ClassProblem Remesher::problem_of(const SampleClass& all) const {
  return surface_classes(surface_, {&all, 1}, options_.cells,
                         lines_.chains().empty() ? KnownSides() : KnownSides(nullptr));
}

void Remesher::settle(const std::vector<bool>& moving, Context* context) {
  const SampleClass all{.count = sites_.size()};
  const ClassProblem problem = problem_of(all);
  std::vector<bool> locked(sites_.size());
  for (std::size_t k = 0; k < locked.size(); ++k) locked[k] = !sites_.is_free(k) || !moving[k];
  if (std::ranges::find(locked, false) == locked.end()) return;
  OptimizerOptions optimizer = options_.optimizer;
  optimizer.max_evaluations = std::min(optimizer.max_evaluations, kFewEvaluations);
  optimizer.tolerance *= kRough;
  ClassMinimum found = dapple::solve(
      make_objective(problem, class_of_sites(problem), class_options(options_), locked),
      sites_.sites, optimizer, context);
  evaluations_ += found.minimum.evaluations;
  sites_.sites = std::move(found.minimum.state.sites);
}

void Remesher::look(Context* context) {
  const StageSpan looking(context, Stage::kCells);
  dual_ = along_ ? dual_of(surface_, lines_, sites_.sites, sites_.kinds, *along_, context)
                 : dual_of(surface_, lines_, sites_.sites, sites_.kinds, options_.cells, context);
  kept_.put_into(sites_, dual_);
}

void Remesher::mend_all(Context* context) {
  Stalls stalls(sites_.size());
  bool dense = false;
  const std::size_t most = kMostTimes * count_ + kMostMore;
  for (int k = 0; k < kMendings; ++k) {
    check_context(context);
    if (context) context->advance(k / (k + kHalfWay));
    look(nullptr);
    keep_best();
    if (dual_.violations.empty() || sites_.size() >= most) return;
    stalls.add(dual_.violations.size());
    // Where walls are thinner than cells, as of fingers, new sites bring new flaws for a while: if
    // few at a time mend nothing, many at a time may.
    dense = dense || (along_ && !gives_up_ && stalls.since() >= kStalled);
    if (stalls.since() >= (dense ? kDensePatience : kPatience)) return;
    if (!along_ && stalls.are_hopeless()) return;
    if (mend(surface_, lines_, dual_.violations, sites_, dense) == 0) return;
  }
  look(nullptr);
  keep_best();
}

void Remesher::keep_best() {
  const auto worth = [](const Dual& dual, std::size_t sites) {
    return std::pair(dual.violations.size(), sites);
  };
  if (!best_sites_.kinds.empty() && worth(best_, best_sites_.size()) <= worth(dual_, sites_.size()))
    return;
  best_ = dual_;
  best_sites_ = sites_;
}

void Remesher::thin_all(Context* context) {
  for (int k = 0; k < kThinnings && best_sites_.size() > count_ && best_.violations.empty(); ++k) {
    const std::size_t before = best_sites_.size();
    if (!thin(context)) break;
    if (k >= kShortThinnings && before - best_sites_.size() < kLeastThinned) break;
  }
}

bool Remesher::thin(Context* context, std::size_t skipped) {
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
  return dual_.violations.empty() && sites_.size() < before;
}

void Remesher::turn_all(Context* context) {
  std::size_t tried = std::numeric_limits<std::size_t>::max();  // fewer where some spoil others
  for (int k = 0; k < kTurnings && best_.violations.empty(); ++k) {
    const std::vector<Violation> away = away_from_surface(best_, best_sites_);
    if (away.empty() || tried == 0 || polish_turns_all(context)) break;
    tried = std::min(tried, away.size());
    if (!turn(away, tried, context)) tried /= 2;
  }
}

bool Remesher::polish_turns_all(Context* context) const {
  if (options_.max_distance > 0.0) return false;  // it may not be kept
  RemeshSites sites = best_sites_;
  Dual dual = best_;
  polish(surface_, lines_, count_, sites, dual, context);
  return facing_away(surface_, lines_, dual.triangles, sites.sites).empty();
}

std::vector<Violation> Remesher::away_from_surface(const Dual& dual,
                                                   const RemeshSites& sites) const {
  std::vector<Violation> result;
  for (const std::size_t k : facing_away(surface_, lines_, dual.triangles, sites.sites))
    if (!sites.stay(dual.triangles[k]))
      result.push_back({dual.triangles[k][0], Flaw::kAway, dual.corners[k], {}});
  return result;
}

bool Remesher::turn(const std::vector<Violation>& away, std::size_t tried, Context* context) {
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

void Remesher::approach(Context* context) {
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

FarPlaces Remesher::far_places(const DistanceCheck& check, Context* context) {
  FarPlaces far = check.far_places(dual_, sites_.sites, options_.max_distance, context);
  looked_at_sites_ = sites_;
  if (far.largest < distance_) {
    best_ = dual_;
    best_sites_ = sites_;
    distance_ = far.largest;
  }
  return far;
}

double Remesher::polish_within_limit(RemeshSites& sites, Dual& dual, Context* context) const {
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

void Remesher::settle_others(Context* context) {
  std::vector<bool> moving = sites_.pinned;
  moving.flip();
  settle(moving, context);
}

TracedMesh Remesher::result(Context* context) const {
  RemeshSites sites = best_sites_;
  Dual dual = best_;
  const double distance = polish_within_limit(sites, dual, context);
  TracedMesh result;
  RemeshResult& mesh = result.mesh;
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
    result.origins.push_back(sites.origins[k]);
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
  return result;
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
    edge = std::min(edge, kFinerEdge * std::max(std::sqrt(nearest[1].squared_distance), least));
  }
  return longest;
}

}  // namespace dapple
