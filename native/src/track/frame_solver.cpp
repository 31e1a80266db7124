// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/frame_solver.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <optional>

#include "base/hexagonal.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "optimize/reinsertion.hpp"
#include "rebalance/lead_to_density.hpp"
#include "rebalance/rebalance.hpp"
#include "sample/outcome.hpp"
#include "sample/solve_classes.hpp"
#include "sample/surface_classes.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"
#include "track/move_apart.hpp"
#include "voronoi/cell_surface.hpp"

namespace dapple {
namespace {

constexpr double kThin = 0.05;  // of the largest density: lower values have no defined spacing
constexpr double kMovingVariation = 0.02,
                 kMovingAlpha = 0.5;  // sufficient evenness if the density moves
constexpr int kRounds = 3;            // of the search while discs overlap
constexpr int kMoveRounds = 6;        // of moving sites apart
constexpr int kLimitedRounds = 3;     // of them in which the slide of sites is limited
constexpr double kHarder = 10.0;  // factor by which the weight of discs that still overlap grows
constexpr double kRoomy = 1.7,
                 kCrowded = 0.4;  // of the mean capacity: space for one more, or one too many
constexpr double kPiled = 0.6;    // of a spacing: sites closer to each other are crowded
constexpr double kApart = 0.62;   // of a spacing: distance to which crowded sites are moved apart

/// The classes with their numbers of samples; a single class if none is given.
std::vector<SampleClass> counted(std::vector<SampleClass> classes,
                                 std::span<const std::int32_t> class_of) {
  if (classes.empty()) return {{.count = class_of.size()}};
  for (SampleClass& member : classes) member.count = 0;
  for (std::size_t k = 0; k < class_of.size(); ++k) {
    const std::int32_t c = class_of[k];
    if (c < 0 || static_cast<std::size_t>(c) >= classes.size())
      throw ArgumentError(entry("samples.classes", k) + " is " + std::to_string(c) +
                          ", outside 0.." + std::to_string(classes.size() - 1));
    ++classes[static_cast<std::size_t>(c)].count;
  }
  return classes;
}

/// The classes on another frame of the surface.
std::vector<SampleClass> on_frame(const Surface& surface, std::vector<SampleClass> classes) {
  for (SampleClass& member : classes)
    if (member.surface) member.surface = member.surface->deformed(surface.vertices());
  return classes;
}

bool overlaps(const Evaluation& state, const Restoration& aim) {
  return worst_overlap(state.discs) > aim.overlap;
}

bool overlaps_more(const Evaluation& state, const Evaluation& than) {
  return worst_overlap(state.discs) > worst_overlap(than.discs);
}

/// The energy of one frame, over domains that it owns.
struct Frame {
  Frame(const Surface& surface, std::vector<SampleClass> members,
        const std::vector<std::int32_t>& class_of, const TrackerOptions& options,
        const KnownSides& sides)
      : classes(std::move(members)),
        problem(surface_classes(surface, classes, options.cells, sides)),
        objective(make_objective(
            problem, classes.size() > 1 ? class_of : std::vector<std::int32_t>(class_of.size(), 0),
            {.union_weight = options.union_weight, .sample = {.optimizer = options.optimizer}})) {
    objective.holds_discs = !objective.discs.empty();
  }

  /// The optimization of the sites, in which discs stay apart as far as possible.
  [[nodiscard]] Minimum search(const Sites& start, const OptimizerOptions& options,
                               const Tracked& tracked, Context* context) {
    if (!objective.holds_discs) return minimize(objective, start, options, context, tracked);
    Minimum found = apart(start, options, tracked, context);
    for (int round = 1; round < kRounds && overlaps(found.state, *tracked.restoration); ++round) {
      objective.discs_weight *= kHarder;
      Minimum next = apart(found.state.sites, options, {.home = tracked.home}, nullptr);
      found.evaluations += next.evaluations;
      if (!overlaps_more(next.state, found.state)) found.state = std::move(next.state);
    }
    return found;
  }

  [[nodiscard]] Minimum apart(const Sites& start, const OptimizerOptions& options,
                              const Tracked& tracked, Context* context) const {
    Minimum found =
        minimize(objective, discs_apart(objective, start, context), options, context, tracked);
    end_apart(objective, options, found, context);
    return found;
  }

  std::vector<SampleClass> classes;
  ClassProblem problem;
  Objective objective;
};

/// The start of a frame's optimization, and the positions that hold its sites.
struct Beginning {
  Sites start;
  std::optional<Sites> home;                 // none: the start of the search
  std::vector<std::int32_t> elsewhere = {};  // sites that start far from their previous position
  std::vector<std::int32_t> displaced = {};  // these, and sites whose previous one has no density
};

/// The spacing at each site by its density, which counts as at least kThin times the largest
/// density.
std::vector<double> spacings_at(const Surface& surface, const Sites& sites) {
  const std::vector<double> all = surface.density();
  const double most = all.empty() ? 1.0 : *std::max_element(all.begin(), all.end());
  std::vector<double> result;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const OrderedFace face = surface.ordered().ordered_face(sites.faces[k]);
    const double density = sites.barycentric[k].dot(surface.ordered().densities(face));
    result.push_back(hexagonal_spacing(surface.capacity() / (std::max(density, kThin * most) *
                                                             static_cast<double>(sites.size()))));
  }
  return result;
}

/// Per site its part of the distance that two sites keep.
std::vector<double> least_distances(const Surface& own, const Domain& domain, const Sites& sites) {
  const double mean = domain.spacing(sites.size());
  std::vector<double> result = spacings_at(own, sites);
  for (double& spacing : result) spacing = 0.5 * kApart * std::min(spacing, mean);
  return result;
}

/// The number of surplus sites: sites that moved far to the border of the density, and one of each
/// two that are too close to each other.
std::size_t count_piled(const Surface& own, const Sites& before, const Sites& now) {
  const std::vector<double> spacings = spacings_at(own, now);
  const Neighbors tree(now.positions);
  std::vector<Neighbor> found;
  std::size_t far = 0, near = 0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    far += (now.positions[k] - before.positions[k]).norm() > spacings[k] ? 1 : 0;
    tree.nearest(now.positions[k], 2, found);
    if (found.size() < 2) continue;
    const auto other = static_cast<std::size_t>(
        found[0].index == static_cast<std::int32_t>(k) ? found[1].index : found[0].index);
    const double apart = kPiled * std::min(spacings[k], spacings[other]);
    near += found[1].squared_distance < apart * apart ? 1 : 0;
  }
  return std::max(far, (near + 1) / 2);
}

/// Whether one more site fits somewhere, or one is surplus. If new faces represent the same shape,
/// sites stay in place, because moving one elsewhere would make it jump.
bool is_unfilled(const Domain& domain, const Sites& sites, Context* context) {
  const RestrictedVoronoi diagram = domain.cells(sites, context);
  const double mean =
      domain.capacity() / static_cast<double>(std::max<std::size_t>(sites.size(), 1));
  return std::any_of(diagram.cells.begin(), diagram.cells.end(), [mean](const Moments& cell) {
    return cell.capacity > kRoomy * mean || cell.capacity < kCrowded * mean;
  });
}

/// Sites pushed by a moving density crowd at its border; the surplus moves to free areas. On new
/// faces free areas may be anywhere.
/// \return the sites that moved
std::vector<std::int32_t> spread(const Surface& own, const Domain& domain,
                                 std::span<const std::int32_t> mine, const Sites& before,
                                 Moved what, Sites& sites, Context* context) {
  const Sites now = select(sites, mine);
  const std::size_t piled =
      what == Moved::kFaces ? kAnyNumber : count_piled(own, select(before, mine), now);
  if (piled == 0 || (what == Moved::kFaces && !is_unfilled(domain, now, context))) return {};
  const Rebalanced found = rebalance(domain, now, mine.size(), mine.size(), context, piled);
  std::vector<bool> stays(mine.size(), false);
  for (const std::size_t k : found.stay) stays[k] = true;
  std::vector<std::int32_t> moved;
  for (std::size_t k = 0; k < mine.size(); ++k)
    if (!stays[k]) moved.push_back(mine[k]);
  put(sites, moved, found.fresh);
  return moved;
}

/// Sites where their class has no density start and are held at the nearest point with density;
/// otherwise max_slide would keep them off the density.
/// \param moved the difference from the last frame
Beginning on_density(const Surface& surface, const Frame& frame,
                     std::span<const std::int32_t> class_of, const Sites& start, const Sites* home,
                     Moved moved, Context* context) {
  Beginning result{start, home ? std::optional(*home) : std::nullopt};
  std::vector<std::int32_t> off_density;
  for (std::size_t c = 0; c < frame.classes.size(); ++c) {
    const std::optional<Surface>& mine = frame.classes[c].surface;
    const Surface& own = mine ? *mine : surface;
    std::vector<bool> others(start.size(), false);
    for (std::size_t k = 0; k < start.size(); ++k) {
      others[k] = frame.classes.size() > 1 && class_of[k] != static_cast<std::int32_t>(c);
      if (others[k] || !home || own.uniform()) continue;
      if (!is_on_density(own, home->faces[k], home->barycentric[k]))
        off_density.push_back(static_cast<std::int32_t>(k));
    }
    const Domain& domain = *frame.problem.classes[c].domain;
    lead_to_density(own, domain, result.start, others);
    if (moved == Moved::kNothing) continue;
    std::vector<std::int32_t> members;
    for (std::size_t k = 0; k < start.size(); ++k)
      if (!others[k]) members.push_back(static_cast<std::int32_t>(k));
    if (members.empty()) continue;
    const auto gone = spread(own, domain, members, start, moved, result.start, context);
    result.elsewhere.insert(result.elsewhere.end(), gone.begin(), gone.end());
  }
  off_density.insert(off_density.end(), result.elsewhere.begin(), result.elsewhere.end());
  if (result.home) put(*result.home, off_density, select(result.start, off_density));
  result.displaced = std::move(off_density);
  return result;
}

double alpha_min(const Minimum& found) { return measure_evenness(found.state.diagram()).alpha_min; }

/// Where a moving density or new faces left sites too near to each other, they are moved apart in
/// the end. Those that were displaced may go farther than others; in the last rounds all may, as
/// some have to make room for them.
void end_moving(const Frame& frame, const Surface& surface, OptimizerOptions options,
                const Beginning& first, const Restoration& aim, Minimum& found, Context* context) {
  if (frame.classes.size() > 1 || frame.objective.holds_discs) return;
  const std::optional<Surface>& mine = frame.classes[0].surface;
  const Domain& domain = *frame.problem.classes[0].domain;
  options.max_evaluations = 1;
  Sites sites = found.state.sites;
  // A round may bring others together, which the next one separates.
  for (int round = 0; round < kMoveRounds && alpha_min(found) < kMovingAlpha; ++round) {
    move_apart(domain, least_distances(mine ? *mine : surface, domain, sites), sites, context);
    Sites home = first.home ? *first.home : first.start;
    if (round >= kLimitedRounds) home = sites;
    put(home, first.displaced, select(sites, first.displaced));
    Minimum apart =
        minimize(frame.objective, sites, options, nullptr, {.home = &home, .restoration = &aim});
    found.evaluations += apart.evaluations;
    sites = apart.state.sites;
    if (alpha_min(apart) > alpha_min(found)) found.state = std::move(apart.state);
  }
}

/// Check that squared distances between samples are finite. A triangle without area can move its
/// samples far away although the area of the surface is finite.
void check_extent(const Surface& surface, const Sites& sites) {
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const double far = (sites.positions[k] - sites.positions[0]).norm();
    if (!std::isfinite(surface.area() * (far * far)))
      throw SurfaceError("vertices take " + entry("samples", k) +
                         " so far from samples[0] that the distance squared is not finite");
  }
}

Vectors face_normals(const Surface& surface, const Sites& sites) {
  Vectors normals(sites.size());
  for_each_vector(sites.size(), [&](std::size_t k) {
    normals[k] = surface.ordered().geometry(surface.ordered().counted_face(sites.faces[k])).normal;
  });
  return normals;
}

Vectors without(Vectors moves, std::span<const std::int32_t> which) {
  for (const std::int32_t k : which) moves[static_cast<std::size_t>(k)] = Vec3::Zero();
  return moves;
}

/// The sites after their moves; those that do not move keep their exact positions.
Sites move(Sites sites, const Vectors& moves, const Objective& objective, const Context* context) {
  std::vector<std::int32_t> moving;
  for (std::size_t k = 0; k < moves.size(); ++k)
    if (moves[k] != Vec3::Zero()) moving.push_back(static_cast<std::int32_t>(k));
  const Sites from = select(sites, moving);
  Vectors points = from.positions;
  for (std::size_t k = 0; k < moving.size(); ++k)
    points[k] += moves[static_cast<std::size_t>(moving[k])];
  put(sites, moving, objective.project(points, from.faces, moving, context));
  return sites;
}

}  // namespace

Sites sites_of(const Samples& samples) {
  return {samples.positions, samples.faces, samples.barycentric};
}

Sites carried(const Surface& surface, Sites sites) {
  for_each_vector(sites.size(), [&](std::size_t k) {
    sites.positions[k] = surface.point(sites.faces[k], sites.barycentric[k]);
  });
  return sites;
}

FrameSolver::FrameSolver(const Surface& surface, const Samples& samples, TrackerOptions options,
                         Context* context)
    : options_(std::move(options)),
      classes_(counted(std::exchange(options_.classes, {}), samples.classes)),
      ids_(samples.ids),
      class_of_(samples.classes),
      first_(sites_of(samples)) {
  check_options(options_);
  check_extent(surface, first_);
  sides_ = sides_for(surface, first_.size(), options_.cells);
  const Frame frame(surface, classes_, class_of_, options_, sides_);
  Minimum first;
  first.state = evaluate(frame.objective, first_, context);
  const Evaluation& state = first.state;
  check_finite_energy(frame.objective, state);
  target_energy_ = normalized_energy(frame.objective, state);
  restoration_.cvt = normalized_cvt(frame.objective, state);
  restoration_.first_variation = capacity_variation(frame.objective, state);
  restoration_.alpha = std::min(restoration_.alpha, measure_evenness(state.diagram()).alpha_min);
  restoration_.overlap = std::max(restoration_.overlap, worst_overlap(state.discs));
  memory_ = PatternMemory(state.diagram());
  first.energies = {target_energy_};
  first.converged = !has_empty_cell(frame.objective, state);  // it defines the evenness to reach
  first_report_ = to_report(frame.objective, first, classes_.size(), samples.normals);
}

Vectors FrameSolver::recall(const Surface& surface, const Sites& before, const Sites& now) const {
  const Sites first = carried(surface, first_);
  const Vectors first_normals = face_normals(surface, first);
  const Vectors normals = face_normals(surface, now);
  return memory_.recall({first.positions, first_normals}, before.positions,
                        {now.positions, normals}, options_.pattern_strength);
}

bool FrameSolver::any_stranded(const Surface& surface, const Sites& sites) const {
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const auto c = static_cast<std::size_t>(classes_.size() > 1 ? class_of_[k] : 0);
    const std::optional<Surface>& own = classes_[c].surface;
    const Surface& mine = own ? *own : surface;
    if (!mine.uniform() && !is_on_density(mine, sites.faces[k], sites.barycentric[k])) return true;
  }
  return false;
}

/// If the density moves, no frame is restored to the evenness of the first one, because the next
/// frame moves the density again. If islands of the density grow and shrink while their numbers of
/// samples stay constant, no step can restore their first evenness.
Restoration FrameSolver::restoration(Moved moved, const Domain& all, const Sites& sites) const {
  Restoration aim = restoration_;
  if (classes_.size() == 1) {
    const double first = first_report_.whole_count_variation;
    const double now = std::max(whole_count_variation(all, sites), first);
    aim.variation = std::hypot(aim.variation, now);
    aim.first_variation =
        std::sqrt(aim.first_variation * aim.first_variation + now * now - first * first);
  }
  if (moved != Moved::kDensity) return aim;
  aim.variation = std::max(aim.variation, kMovingVariation);
  aim.alpha = std::min(aim.alpha, kMovingAlpha);
  return aim;
}

OptimizerOptions FrameSolver::aims() const {
  OptimizerOptions options = options_.optimizer;
  if (options.method == Method::kLineSearch)  // it does not support restoration
    options.target_energy = std::max(options.target_energy, target_energy_ + kAsEven);
  return options;
}

FrameSolver::Restored FrameSolver::restore(const Surface& surface, const Sites& start,
                                           const Vectors& moves, const Sites* home, bool idle,
                                           Context* context, Moved moved) const {
  check_extent(surface, start);
  Frame frame(surface, on_frame(surface, classes_), class_of_, options_, sides_);
  OptimizerOptions options = aims();
  if (idle) options.max_evaluations = std::min(options.max_evaluations, 1);
  const Beginning first = on_density(surface, frame, class_of_, start, home, moved, context);
  const Restoration aim = restoration(moved, *frame.problem.all, first.start);
  const Sites begin = move(first.start, without(moves, first.elsewhere), frame.objective, context);
  const Tracked tracked{.home = first.home ? &*first.home : nullptr, .restoration = &aim};
  Minimum found = idle ? minimize(frame.objective, begin, options, context, tracked)
                       : frame.search(begin, options, tracked, context);
  if (moved != Moved::kNothing) end_moving(frame, surface, options, first, aim, found, context);
  const StageSpan reporting(context, Stage::kReporting);
  Samples samples = to_samples(surface, frame.objective, found, classes_.size(), ids_);
  samples.classes = class_of_;
  return {std::move(samples), found.settled};
}

FrameSolver::Passed FrameSolver::pass(const Surface& surface, const Sites& start,
                                      const Vectors& moves, const Sites& home, Context* context,
                                      Moved moved) const {
  check_extent(surface, start);
  Frame frame(surface, on_frame(surface, classes_), class_of_, options_, sides_);
  const Beginning first = on_density(surface, frame, class_of_, start, &home, moved, context);
  const Restoration aim = restoration(moved, *frame.problem.all, first.start);
  Minimum found = frame.search(
      move(first.start, without(moves, first.elsewhere), frame.objective, context), aims(),
      {.home = first.home ? &*first.home : nullptr, .restoration = &aim}, context);
  return {std::move(found.state.sites), found.evaluations};
}

/// The same targets for other samples, without a remembered pattern.
FrameSolver FrameSolver::with(const Samples& now) const {
  FrameSolver result = *this;
  result.ids_ = now.ids;
  result.class_of_ = now.classes;
  if (classes_.size() == 1)
    result.classes_[0].count = now.size();
  else
    result.classes_ = counted(classes_, now.classes);
  result.first_ = sites_of(now);
  return result;
}

FrameSolver FrameSolver::replaced(const Samples& now, Sites first, PatternMemory memory) const {
  FrameSolver result = with(now);
  result.first_ = std::move(first);
  result.memory_ = std::move(memory);
  return result;
}

FrameSolver FrameSolver::on_ground(const Surface& surface, const Samples& now, Sites first,
                                   std::vector<SampleClass> classes, Context* context) const {
  FrameSolver result = *this;
  result.classes_ = counted(std::move(classes), now.classes);
  check_same_length("classes", result.classes_.size(), "the previous ones", classes_.size());
  if (!sides_ || *sides_)  // a body without walls stays without walls
    result.sides_ = sides_for(surface, now.size(), options_.cells, context);
  result.first_ = std::move(first);
  return result;
}

FrameSolver FrameSolver::exchanged(std::span<const std::int32_t> origin, const Samples& now) const {
  FrameSolver result = with(now);
  for (std::size_t k = 0; k < origin.size(); ++k) {
    if (origin[k] < 0) continue;
    const auto o = static_cast<std::size_t>(origin[k]);
    result.first_.faces[k] = first_.faces[o];
    result.first_.barycentric[k] = first_.barycentric[o];
  }
  result.memory_ = memory_.exchanged(origin);
  return result;
}

FrameSolver FrameSolver::transplanted(std::span<const std::int32_t> origin, const Samples& now,
                                      const Surface& before, const Transfer& transfer,
                                      const Context* context) const {
  FrameSolver result = with(now);
  result.sides_ = std::nullopt;
  const Transferred found = transfer.find(carried(before, first_), context);
  std::vector<std::int32_t> place(first_.size(), -1);  // index among the transferred sites
  for (std::size_t k = 0; k < found.which.size(); ++k)
    place[static_cast<std::size_t>(found.which[k])] = static_cast<std::int32_t>(k);
  std::vector<std::int32_t> remembered(origin.size(), -1);
  for (std::size_t k = 0; k < origin.size(); ++k) {
    const std::int32_t p = origin[k] < 0 ? -1 : place[static_cast<std::size_t>(origin[k])];
    if (p < 0) continue;
    remembered[k] = origin[k];
    result.first_.faces[k] = found.sites.faces[static_cast<std::size_t>(p)];
    result.first_.barycentric[k] = found.sites.barycentric[static_cast<std::size_t>(p)];
  }
  result.memory_ = memory_.exchanged(remembered);
  return result;
}

}  // namespace dapple
