// SPDX-License-Identifier: GPL-3.0-or-later
#include "rebalance/rebalance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "base/elementary.hpp"
#include "base/morton.hpp"
#include "base/progress.hpp"
#include "base/random.hpp"
#include "base/stopwatch.hpp"
#include "base/tangent_basis.hpp"
#include "optimize/objective.hpp"
#include "surface/islands.hpp"
#include "surface/ordered_surface.hpp"
#include "voronoi/local_spacing.hpp"

namespace dapple {
namespace {

constexpr std::ptrdiff_t kPatch = 8;  // sites of a neighborhood, which gets a number as a whole
// The least surplus or deficit of a neighborhood that is corrected, in samples.
constexpr double kLeastChange = 0.75;
constexpr double kRounding = 1e-9;  // of a sample
constexpr int kCandidates = 16;     // positions tried for a new site
constexpr double kAround = 0.9;     // spacings from the host within which they lie
constexpr int kRounds = 40;  // each at most doubles or halves the sites; the last one does the rest
constexpr double kWork = 15.0;       // inserting a site takes as long as this many cells
constexpr std::size_t kGrain = 128;  // changes between two checks

constexpr OrderedFace kNone{-1};

std::ptrdiff_t rounded(double x) { return static_cast<std::ptrdiff_t>(std::llround(x)); }

/// The nearest integer between 0 and `change`, or the nearest integer of all if that is far off.
std::ptrdiff_t rounded_toward(double x, std::ptrdiff_t change) {
  const std::ptrdiff_t inside = std::clamp(rounded(x), std::min<std::ptrdiff_t>(0, change),
                                           std::max<std::ptrdiff_t>(0, change));
  return std::abs(x - static_cast<double>(inside)) <= kLeastChange ? inside : rounded(x);
}

/// Integers close to the given real numbers, with the same sum. Changes are rounded toward 0 unless
/// the sum requires more, or the errors of two differ by more than `most`: with 1 they are the
/// largest remainders.
std::vector<std::ptrdiff_t> whole_changes(const std::vector<double>& wanted, double most) {
  std::vector<std::ptrdiff_t> result;
  std::set<std::pair<double, std::size_t>> rest;
  double sum = 0.0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    result.push_back(static_cast<std::ptrdiff_t>(wanted[k]));
    rest.emplace(wanted[k] - static_cast<double>(result[k]), k);
    sum += wanted[k] - static_cast<double>(result[k]);
  }
  const auto change = [&](auto which, int by) {
    const auto [left, k] = *which;
    rest.erase(which);
    result[k] += by;
    rest.emplace(left - by, k);
  };
  std::ptrdiff_t owed = rounded(sum);
  for (; owed > 0; --owed) change(std::prev(rest.end()), 1);
  for (; owed < 0; ++owed) change(rest.begin(), -1);
  while (std::prev(rest.end())->first - rest.begin()->first > most) {
    change(std::prev(rest.end()), 1);
    change(rest.begin(), -1);
  }
  return result;
}

/// The cost of changes in evaluations of one cell; removals are cheap.
double work_of(std::ptrdiff_t change) {
  return change > 0 ? kWork * static_cast<double>(change) : -static_cast<double>(change);
}

/// The changes of one round.
struct Passed {
  std::vector<bool> alive;  // per site
  Sites fresh;
  bool complete = true;     // every neighborhood has its target number
  std::size_t lacking = 0;  // number still to insert if only some sites are balanced
};

/// The sites to balance, and the targets.
struct Rule {
  std::size_t count = 0;               // target number of all sites
  std::size_t most_come = kAnyNumber;  // limit of further insertions
  std::size_t most_go = kAnyNumber;    // limit of further removals
  std::vector<bool> free = {};         // per site; empty: all are
  double capacity = 0.0;               // target capacity of each free site, if not all are free
};

/// One pass over all sites, which at most doubles and at most halves the number of sites of each
/// neighborhood.
class Round {
 public:
  Round(const Surface& surface, const Islands& islands, const Domain& domain, const Sites& sites,
        const Rule& rule, RestrictedVoronoi diagram, bool limited, Random& random, Context* context)
      : surface_(surface),
        islands_(islands),
        domain_(domain),
        sites_(sites),
        rule_(rule),
        limited_(limited),
        random_(random),
        context_(context),
        diagram_(std::move(diagram)),
        fill_(sites.size(), 0.0),
        patch_(sites.size(), 0),
        inserted_(sites.size()) {
    passed_.alive.assign(sites.size(), true);
  }

  Passed run() {
    share_out();
    if (is_spared()) spare();
    take_out();
    if (all_are_free()) put_in();
    return std::move(passed_);
  }

  /// Only the changes of these places.
  Passed run(const Exchange& places) {
    order_.resize(sites_.size());
    std::iota(order_.begin(), order_.end(), 0);
    fill(order_.begin(), order_.end(), static_cast<double>(sites_.size()));
    patch_ = places.of_sites;
    changes_ = places.changes;
    take_out();
    put_in();
    return std::move(passed_);
  }

  /// The share of the remaining work, in this and later rounds, that is done.
  [[nodiscard]] double progress() const {
    const auto cells = static_cast<double>(sites_.size());
    return (cells + made_) / (cells + wanted_);
  }

 private:
  using Place = std::vector<std::int32_t>::const_iterator;
  using Queue = std::set<std::pair<double, std::size_t>>;

  [[nodiscard]] std::size_t island_of(std::int32_t face) const {
    return islands_.at(surface_.ordered().ordered_face(face));
  }
  [[nodiscard]] std::size_t island(std::int32_t site) const {
    return island_of(sites_.faces[static_cast<std::size_t>(site)]);
  }

  // Islands do not exchange sites, so each gets its own number.
  void share_out() {
    order_ = morton_order(sites_.positions);
    std::erase_if(order_, [this](std::int32_t s) { return !is_free(static_cast<std::size_t>(s)); });
    std::vector<std::vector<std::int32_t>> by_island(islands_.count());
    for (const std::int32_t s : order_) by_island[static_cast<std::size_t>(island(s))].push_back(s);
    order_.clear();
    for (const std::vector<std::int32_t>& members : by_island)
      order_.insert(order_.end(), members.begin(), members.end());
    const std::vector<std::ptrdiff_t> held = count_held();
    const std::vector<std::ptrdiff_t> changes =
        whole_changes(all_are_free() ? lacking(held) : lacking_among_free(held),
                      is_spared() ? 2.0 * kLeastChange : 1.0 + kRounding);
    auto first = order_.begin();
    for (std::size_t c = 0; c < changes.size(); ++c) {
      const auto last = first + held[c];
      fill(first, last, static_cast<double>(held[c] + changes[c]));
      if (held[c] > 0) split(first, last, changes[c]);
      if (held[c] == 0 && changes[c] > 0) settle(largest_[c], changes[c]);
      first = last;
    }
  }

  [[nodiscard]] std::vector<std::ptrdiff_t> count_held() const {
    std::vector<std::ptrdiff_t> held(islands_.count(), 0);
    for (const std::int32_t site : order_) ++held[island(site)];
    return held;
  }

  /// Per island, how many sites it lacks.
  [[nodiscard]] std::vector<double> lacking(const std::vector<std::ptrdiff_t>& held) {
    std::vector<double> result(held.size(), 0.0);
    largest_.assign(held.size(), kNone);
    double sum = 0.0;
    for (std::size_t k = 0; k < surface_.face_count(); ++k) {
      const OrderedFace f = nth_face(k);
      const std::size_t c = islands_.at(f);
      result[c] += capacity(f);
      sum += capacity(f);
      if (largest_[c] == kNone || capacity(f) > capacity(largest_[c])) largest_[c] = f;
    }
    for (std::size_t c = 0; c < held.size(); ++c)
      result[c] = static_cast<double>(rule_.count) * result[c] / sum - static_cast<double>(held[c]);
    return result;
  }

  /// Per island, how many sites it lacks by the capacity of its free sites.
  [[nodiscard]] std::vector<double> lacking_among_free(
      const std::vector<std::ptrdiff_t>& held) const {
    std::vector<double> result(held.size(), 0.0);
    for (const std::int32_t site : order_)
      result[island(site)] +=
          diagram_.cells[static_cast<std::size_t>(site)].capacity / rule_.capacity;
    for (std::size_t c = 0; c < held.size(); ++c) result[c] -= static_cast<double>(held[c]);
    return result;
  }

  [[nodiscard]] double capacity(OrderedFace face) const {
    return surface_.ordered().geometry(face).moments.capacity;
  }

  /// Set the number of samples that each cell should hold if all of them should hold `total`.
  void fill(Place first, Place last, double total) {
    const auto capacity = [this](std::int32_t s) {
      return diagram_.cells[static_cast<std::size_t>(s)].capacity;
    };
    double sum = 0.0;
    for (Place s = first; s != last; ++s) sum += capacity(*s);
    if (sum > 0.0)
      for (Place s = first; s != last; ++s)
        fill_[static_cast<std::size_t>(*s)] = total * capacity(*s) / sum;
  }

  [[nodiscard]] double worth(Place first, Place last) const {
    return std::accumulate(first, last, 0.0, [this](double sum, std::int32_t s) {
      return sum + fill_[static_cast<std::size_t>(s)];
    });
  }

  void split(Place first, Place last, std::ptrdiff_t change) {
    if (last - first <= kPatch) return add_patch(first, last, change);
    const Place middle = first + (last - first) / 2;
    const double left = worth(first, middle) - static_cast<double>(middle - first);
    const double right = worth(middle, last) - static_cast<double>(last - middle);
    const double missed = static_cast<double>(change) - left - right;
    const std::ptrdiff_t part = std::clamp(rounded_toward(left + 0.5 * missed, change),
                                           first - middle, change + (last - middle));
    split(first, middle, part);
    split(middle, last, change - part);
  }

  void add_patch(Place first, Place last, std::ptrdiff_t change) {
    const std::ptrdiff_t size = last - first;
    if (!all_are_free() && change > 0) {  // the caller inserts the sites
      passed_.lacking += static_cast<std::size_t>(change);
      change = 0;
    }
    const bool half = worth(first, last) >= 0.5;  // no site remains where the target is 0
    const std::ptrdiff_t possible =
        limited_ ? std::clamp(change, half ? -((size + 1) / 2) : -size, size) : change;
    passed_.complete = passed_.complete && possible == change;
    wanted_ += work_of(change);
    for (Place s = first; s != last; ++s) patch_[static_cast<std::size_t>(*s)] = changes_.size();
    changes_.push_back(possible);
    lacks_.push_back(worth(first, last) - static_cast<double>(size));
  }

  /// Whether insertions and removals are limited.
  [[nodiscard]] bool is_spared() const { return rule_.most_come != kAnyNumber; }

  /// Skip the neighborhoods with the smallest errors until the limits hold. If islands get their
  /// first sites, all other changes wait for the next round, because until then the nearest cells
  /// own these islands.
  void spare() {
    const bool waits = passed_.fresh.size() > 0;
    leave_all_but(1, waits ? 0 : rule_.most_come);
    leave_all_but(-1, waits ? 0 : rule_.most_go);
    passed_.complete = passed_.complete && !waits;
  }

  void leave_all_but(int sign, std::size_t most) {
    std::size_t sum = 0;
    for (const std::ptrdiff_t change : changes_)
      if (sign * change > 0) sum += static_cast<std::size_t>(sign * change);
    for (Queue patches = by_urgency(sign); sum > most; --sum) leave_one(patches, sign);
  }

  /// The neighborhoods that gain samples (sign 1) or lose them (-1), sorted by their error with one
  /// change fewer.
  [[nodiscard]] Queue by_urgency(int sign) const {
    Queue result;
    for (std::size_t patch = 0; patch < changes_.size(); ++patch)
      if (sign * changes_[patch] > 0) result.emplace(urgency(patch, sign), patch);
    return result;
  }

  [[nodiscard]] double urgency(std::size_t patch, int sign) const {
    return sign * (lacks_[patch] - static_cast<double>(changes_[patch]));
  }

  void leave_one(Queue& patches, int sign) {
    const std::size_t patch = patches.extract(patches.begin()).value().second;
    changes_[patch] -= sign;
    if (changes_[patch] != 0) patches.emplace(urgency(patch, sign), patch);
  }

  /// Insert the first site on an island without sites; the next round adds the rest.
  void settle(OrderedFace ordered_face, std::ptrdiff_t change) {
    const Vec3 middle = Vec3::Constant(1.0 / 3.0);
    const std::int32_t face = surface_.ordered().original_face(ordered_face);
    const Sites first{{surface_.point(face, middle)}, {face}, {middle}};
    for (std::ptrdiff_t k = 0; k < (limited_ ? 1 : change); ++k) add(first, 0);
    wanted_ += work_of(change);
    passed_.complete = passed_.complete && (!limited_ || change == 1);
  }

  void add(const Sites& found, std::size_t which) {
    passed_.fresh.positions.push_back(found.positions[which]);
    passed_.fresh.faces.push_back(found.faces[which]);
    passed_.fresh.barycentric.push_back(found.barycentric[which]);
  }

  [[nodiscard]] bool all_are_free() const { return rule_.free.empty(); }
  [[nodiscard]] bool is_free(std::size_t site) const { return all_are_free() || rule_.free[site]; }

  /// The sites of neighborhoods in which changes of that sign remain, sorted by `sign` times the
  /// number of samples that their cells should hold.
  [[nodiscard]] Queue queue(int sign) const {
    Queue result;
    for (std::size_t s = 0; s < fill_.size(); ++s)
      if (is_free(s) && passed_.alive[s] && sign * changes_[patch_[s]] < 0)
        result.emplace(sign * fill_[s], s);
    return result;
  }

  /// Distribute `worth` equally to the site's remaining neighbors.
  void hand_out(std::size_t site, double worth, int sign, Queue& waiting) {
    std::vector<std::size_t> near;
    for (const CellBoundary& side : diagram_.boundary(site))
      if (passed_.alive[static_cast<std::size_t>(side.neighbor)])
        near.push_back(static_cast<std::size_t>(side.neighbor));
    for (const std::size_t n : near) {
      const bool waits = waiting.erase({sign * fill_[n], n}) > 0;
      fill_[n] += worth / static_cast<double>(near.size());
      if (waits) waiting.emplace(sign * fill_[n], n);
    }
  }

  void note(std::ptrdiff_t change) {
    made_ += work_of(change);
    if (!context_ || changed_++ % kGrain != 0) return;
    context_->check();
    context_->advance(progress());
  }

  void take_out() {
    for (Queue waiting = queue(1); !waiting.empty();) {
      const std::size_t site = waiting.extract(waiting.begin()).value().second;
      if (changes_[patch_[site]] == 0) continue;
      ++changes_[patch_[site]];
      note(-1);
      passed_.alive[site] = false;
      hand_out(site, fill_[site], 1, waiting);
    }
  }

  // A new site takes the worth of one sample, half of it from its host and half from the neighbors.
  void put_in() {
    for (Queue waiting = queue(-1); !waiting.empty();) {
      const std::size_t host = waiting.extract(waiting.begin()).value().second;
      if (changes_[patch_[host]] == 0) continue;
      --changes_[patch_[host]];
      note(1);
      place_beside(host);
      fill_[host] -= 0.5;
      hand_out(host, -0.5, -1, waiting);
      waiting.emplace(-fill_[host], host);
    }
  }

  /// Insert a site at the one of several positions around the host that is farthest from all sites.
  /// The distance is in spacings at the position; otherwise all sites would go to the side of lower
  /// density at a jump. Positions on other islands do not count: their sites are not near the host.
  void place_beside(std::size_t host) {
    const std::vector<Vec3> near = near_positions(host);
    const std::vector<Vec3> places = places_around(host);
    const std::vector<std::int32_t> hints(places.size(), sites_.faces[host]);
    const Sites found = domain_.project(places, hints, context_);
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (island_of(found.faces[k]) != island(static_cast<std::int32_t>(host))) continue;
      if (is_spared() && !is_in_cell(host, found.positions[k])) continue;
      const double room = density_at(found, k) * squared_distance(found.positions[k], near);
      if (room <= most) continue;
      most = room;
      best = k;
    }
    inserted_[host].push_back(passed_.fresh.size());
    add(found, best);
  }

  /// Whether a point is in the host's cell. If few sites are inserted, cells beside empty regions
  /// stay long and narrow, and positions near the host may belong to sites beyond its neighbors.
  [[nodiscard]] bool is_in_cell(std::size_t host, const Vec3& point) const {
    const Vec3 way = point - sites_.positions[host];
    const auto sides = diagram_.boundary(host);
    return std::all_of(sides.begin(), sides.end(), [&](const CellBoundary& side) {
      return 2.0 * way.dot(side.offset) <= side.offset.squaredNorm();
    });
  }

  [[nodiscard]] double density_at(const Sites& sites, std::size_t k) const {
    return sites.barycentric[k].dot(
        surface_.ordered().densities(surface_.ordered().ordered_face(sites.faces[k])));
  }

  static double squared_distance(const Vec3& point, const std::vector<Vec3>& others) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& x : others) least = std::min(least, (x - point).squaredNorm());
    return least;
  }

  [[nodiscard]] std::vector<Vec3> places_around(std::size_t host) {
    const Moments& cell = diagram_.cells[host];
    const double spacing =
        cell.mass > 0.0 ? local_spacing(cell, cell.capacity) : surface_.spacing(rule_.count);
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(domain_.normal(sites_.faces[host]));
    const double turn = random_.uniform();
    std::vector<Vec3> result;
    for (int k = 0; k < kCandidates; ++k) {  // Vogel's spiral
      const auto [cosine, sine] = direction(turn + 0.5 * k * (3.0 - std::sqrt(5.0)));
      const double radius = kAround * spacing * std::sqrt((k + 0.5) / kCandidates);
      result.push_back(sites_.positions[host] + radius * (basis * Vec2(cosine, sine)));
    }
    if (is_spared() && cell.mass > 0.0)
      result.push_back(sites_.positions[host] + cell.first / cell.mass);
    return result;
  }

  /// The positions of the host, of the sites of the two rings around it, and of the sites inserted
  /// beside them.
  [[nodiscard]] std::vector<Vec3> near_positions(std::size_t host) const {
    std::set<std::size_t> near = {host};
    for (int ring = 0; ring < 2; ++ring) {
      const std::vector<std::size_t> inner(near.begin(), near.end());
      for (const std::size_t s : inner)
        for (const CellBoundary& side : diagram_.boundary(s))
          near.insert(static_cast<std::size_t>(side.neighbor));
    }
    std::vector<Vec3> result;
    for (const std::size_t s : near) {
      if (passed_.alive[s]) result.push_back(sites_.positions[s]);
      for (const std::size_t index : inserted_[s]) result.push_back(passed_.fresh.positions[index]);
    }
    return result;
  }

  const Surface& surface_;
  const Islands& islands_;
  const Domain& domain_;
  const Sites& sites_;
  const Rule& rule_;
  bool limited_;
  Random& random_;
  Context* context_;
  RestrictedVoronoi diagram_;
  std::vector<std::int32_t> order_;   // sites by island, each along a space-filling curve
  std::vector<OrderedFace> largest_;  // per island: the face of largest capacity
  std::vector<double> fill_;          // per site: the number of samples that its cell should hold
  std::vector<std::size_t> patch_;    // per site
  std::vector<std::ptrdiff_t> changes_;  // per patch: samples still to insert or to remove
  std::vector<double> lacks_;            // per patch: deficit in samples
  std::vector<std::vector<std::size_t>> inserted_;  // per site: the sites inserted beside it
  double made_ = 0.0, wanted_ = 0.0;                // work, apart from the cells
  std::size_t changed_ = 0;
  Passed passed_;
};

/// Sites, and per site its index at the beginning; -1 for new ones, which come last.
struct Traced {
  Sites sites;
  std::vector<std::int32_t> origin;
};

void apply(const Passed& passed, Traced& now) {
  std::vector<std::int32_t> left, origin;
  for (std::size_t k = 0; k < now.sites.size(); ++k) {
    if (!passed.alive[k]) continue;
    left.push_back(static_cast<std::int32_t>(k));
    origin.push_back(now.origin[k]);
  }
  now.sites = select(now.sites, left);
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(now.sites.positions, passed.fresh.positions);
  append(now.sites.faces, passed.fresh.faces);
  append(now.sites.barycentric, passed.fresh.barycentric);
  origin.resize(now.sites.size(), -1);
  now.origin = std::move(origin);
}

/// Subtract the insertions and removals from the limits. First sites on islands can exceed the
/// limit of insertions; then as many more sites may be removed.
void spend(const Passed& passed, Rule& rule) {
  const std::size_t came = passed.fresh.size();
  const auto gone =
      static_cast<std::size_t>(std::count(passed.alive.begin(), passed.alive.end(), false));
  rule.most_go += std::max(came, rule.most_come) - rule.most_come - gone;
  rule.most_come -= std::min(rule.most_come, came);
}

Traced traced(const Sites& sites) {
  Traced result{sites, std::vector<std::int32_t>(sites.size())};
  std::iota(result.origin.begin(), result.origin.end(), 0);
  return result;
}

/// What stays of the sites at the beginning, and what is new.
Rebalanced difference_of(const Traced& now, int evaluations) {
  Rebalanced result;
  std::vector<std::int32_t> fresh;
  for (std::size_t k = 0; k < now.origin.size(); ++k) {
    if (now.origin[k] >= 0)
      result.stay.push_back(static_cast<std::size_t>(now.origin[k]));
    else
      fresh.push_back(static_cast<std::int32_t>(k));
  }
  result.fresh = select(now.sites, fresh);
  result.evaluations = evaluations;
  return result;
}

std::vector<bool> left_of(const std::vector<bool>& values, const std::vector<bool>& alive) {
  std::vector<bool> result;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (alive[k]) result.push_back(values[k]);
  return result;
}

}  // namespace

double rebalancing_work(std::size_t sites, std::size_t count) {
  return static_cast<double>(sites) +
         work_of(static_cast<std::ptrdiff_t>(count) - static_cast<std::ptrdiff_t>(sites));
}

Rebalanced rebalance(const Domain& domain, const Sites& sites, std::size_t count,
                     std::uint64_t seed, Context* context, std::size_t pairs) {
  Random random(seed);
  const auto more_than = [&](std::size_t a, std::size_t b) {
    return pairs == kAnyNumber ? kAnyNumber : std::max(a, b) - b + pairs;
  };
  Rule rule{.count = count,
            .most_come = more_than(count, sites.size()),
            .most_go = more_than(sites.size(), count)};
  Traced now = traced(sites);
  int evaluations = 0;
  const Surface sided = domain.sampling_surface(count);
  const std::shared_ptr<const Islands> islands = islands_of(sided);
  double done = 0.0;
  for (bool complete = false; !complete;) {
    const bool limited = ++evaluations < kRounds;
    Stretch left(context, done, 1.0);
    const auto cells = static_cast<double>(now.sites.size());
    Stretch dividing(left.context(), 0.0, cells / rebalancing_work(now.sites.size(), count));
    RestrictedVoronoi diagram = in_stage(
        context, Stage::kCells, [&] { return domain.cells(now.sites, dividing.context()); });
    Round round(sided, *islands, domain, now.sites, rule, std::move(diagram), limited, random,
                left.context());
    const Passed passed = round.run();
    done += (1.0 - done) * round.progress();
    if (pairs != kAnyNumber) spend(passed, rule);
    apply(passed, now);
    complete = passed.complete || rule.most_come + rule.most_go == 0;
  }
  return difference_of(now, evaluations);
}

Rebalanced move_between(const Domain& domain, const Sites& sites, const RestrictedVoronoi& diagram,
                        const Exchange& places, std::uint64_t seed) {
  Random random(seed);
  const Surface sided = domain.sampling_surface(sites.size());
  const std::shared_ptr<const Islands> islands = islands_of(sided);
  const Rule rule{.count = sites.size()};
  Traced now = traced(sites);
  apply(Round(sided, *islands, domain, sites, rule, diagram, false, random, nullptr).run(places),
        now);
  return difference_of(now, 0);
}

Thinned thin_out(const Surface& surface, const Domain& domain, const Sites& sites, FreeSites part,
                 Context* context) {
  Random random(0);  // unused, because nothing is inserted
  const std::shared_ptr<const Islands> islands = islands_of(surface);
  Rule rule{.count = sites.size(), .free = std::move(part.free), .capacity = part.capacity};
  Traced now = traced(sites);
  Thinned result;
  for (bool complete = false; !complete;) {
    if (result.evaluations > 0) part.diagram = domain.cells(now.sites, nullptr);
    if (context) context->check();
    const Passed passed = Round(surface, *islands, domain, now.sites, rule, std::move(part.diagram),
                                ++result.evaluations < kRounds, random, nullptr)
                              .run();
    rule.free = left_of(rule.free, passed.alive);
    apply(passed, now);
    result.lacking = passed.lacking;
    complete = passed.complete;
  }
  --result.evaluations;
  result.stay.assign(now.origin.begin(), now.origin.end());
  return result;
}

}  // namespace dapple
