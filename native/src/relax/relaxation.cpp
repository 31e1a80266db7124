// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax/relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "optimize/energy.hpp"
#include "rebalance/among_locked.hpp"
#include "rebalance/lead_to_density.hpp"
#include "rebalance/rebalance.hpp"
#include "rebalance/widest_gaps.hpp"
#include "sample/outcome.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr int kFreeRings = 2;     // around the cells that contain changed faces
constexpr double kUneven = 0.02;  // of the capacity: a border cell that is off by more is freed,
constexpr double kPushed = 0.01;  // of the capacity: but only if it is now off by this much more
constexpr int kGrowths = 16;
constexpr std::size_t kHole = 256;  // most faces of a hole that is filled
constexpr int kFewSites = 16;       // sites: too few to determine the capacity
constexpr double kNear = 0.5;       // spacings: a site this close to a face with density is kept
// Share of the free sites that may be surplus or missing for the capacity around them; if more are,
// further sites are freed.
constexpr double kYield = 0.01;
constexpr double kRounding = 0.5;  // samples: smaller differences do not count
constexpr std::size_t kHalf = 2;   // if more than 1 / kHalf of all sites would be freed, all are
// Cells within these shares of the capacity even out without insertions and removals.
constexpr double kSmallest = 0.2, kLargest = 3.0;
constexpr double kSettled =
    0.1;  // of the capacity: one of several classes is not changed if it is this even
constexpr double kFewMore = 1.25;  // of the sites: up to this count, all sites are rebalanced
// Shares of the progress: the region is known, it has its number of sites, it is even for the first
// time; each further round takes half of the rest.
constexpr double kFound = 0.1, kBalanced = 0.25, kFirst = 0.7, kGrown = 0.5;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

std::vector<std::size_t> which_are(const std::vector<bool>& values) {
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (values[k]) result.push_back(k);
  return result;
}

/// The energy of the relaxed class, without the classes around it.
const Energy& own_energy(const Minimum& found) { return found.state.parts.back().energy; }

/// \param members one per cell; no site is inserted beside a fixed one
/// \throw ArgumentError if that capacity needs too many samples
template <typename Member>
void check_wanted(std::span<const Member> members, const RestrictedVoronoi& diagram,
                  double capacity) {
  double sum = 0.0;
  for (std::size_t k = 0; k < members.size(); ++k)
    if (members[k].open) sum += diagram.cells[k].capacity;
  if (!(sum <= capacity * static_cast<double>(kMostSamples)))
    throw ArgumentError("the changed region needs " + number(sum / capacity) +
                        " samples to be as dense as around it: at most " +
                        std::to_string(kMostSamples) + " are possible");
}

}  // namespace

void measure_members(const MeasuredCells& cells, Quality& quality) {
  RestrictedVoronoi measured;
  std::vector<Vec3> normals;
  double energy = 0.0;
  for (std::size_t k = 0; k < cells.chosen.size(); ++k) {
    if (!cells.chosen[k]) continue;
    const Moments& cell = cells.diagram.cells[k];
    measured.cells.push_back(cell);
    measured.rows.push_back(cells.diagram.rows[k]);
    normals.push_back(cells.normals[k]);
    energy += (cell.second / cells.share +
               cells.capacity_weight * cell.capacity * (cell.capacity / cells.share)) /
              cells.share;
  }
  if (normals.empty()) return;  // the other faces are far away
  measured.boundaries = cells.diagram.boundaries;
  quality.evenness = measure_evenness(measured);
  quality.bond_order = bond_order(measured, normals);
  quality.energy = energy / static_cast<double>(normals.size()) - cells.capacity_weight;
}

Relaxation::Relaxation(const Surface& surface, Sites sites, std::vector<bool> locked,
                       const RelaxOptions& options, const Participants* participants)
    : surface_(surface),
      options_(options),
      others_(participants),
      given_(sites.size()),
      sites_(std::move(sites)),
      alive_(given_, true),
      locked_(std::move(locked)),
      free_(given_, false),
      rings_(surface_, sites_) {}

void Relaxation::run(std::span<const OrderedFace> changed, Context* context) {
  Stretch finding(context, 0.0, kFound), balancing(context, kFound, kBalanced);
  Stretch first(context, kBalanced, kFirst);
  changed_ = changed;
  owners_ = region_ = rings_.owners(changed, context);
  for (int k = 0; k < (others_ ? 1 : kFreeRings); ++k) region_ = rings_.grown(region_, context);
  std::vector<OrderedFace> faces = faces_around(context);
  if (is_void(faces) && !options_.count) return empty();
  for (; is_void(faces); faces = faces_around(context)) widen(context);
  Region region = cut_out(faces, finding.context());
  balance(region, balancing.context());
  if (region.members.empty() || is_settled(region)) return;
  Indices uneven = even_out(region, first.context());
  double done = kFirst;
  for (int k = 0; !others_ && k < kGrowths && !uneven.empty(); ++k) {
    const double before = std::exchange(done, done + kGrown * (1.0 - done));
    Stretch step(context, before, done);
    uneven = grow_at(uneven, step.context());
  }
}

/// Whether no site was inserted or removed and cells have about their target size. If other classes
/// adapt to this one, a small change is not worth moving all of their samples.
bool Relaxation::is_settled(const Region& region) const {
  if (!others_ || sites_.size() > given_ ||
      std::find(alive_.begin(), alive_.end(), false) != alive_.end() ||
      discs_overlap(region, *others_))
    return false;
  return std::all_of(region.members.begin(), region.members.end(), [&](const auto& member) {
    const double off = first_capacities_.at(member.site) / share_ - 1.0;
    return member.fixed || std::abs(off) < kSettled;
  });
}

/// The changed faces, and those of the cells of the region and of two fixed rings around it; the
/// second ring makes the cells of the first one complete. Sorted.
std::vector<OrderedFace> Relaxation::faces_around(const Context* context) {
  for (const std::int32_t s : region_) free_[at(s)] = !locked_[at(s)];
  if (is_everything()) {
    border_ = region_;
    return all_faces();
  }
  border_ = rings_.grown(region_, context);
  const Indices all = rings_.grown(border_, context);
  const std::vector<OrderedFace> cells = rings_.faces(all, context);
  std::vector<OrderedFace> faces;
  std::set_union(cells.begin(), cells.end(), changed_.begin(), changed_.end(),
                 std::back_inserter(faces));
  return without_holes(surface_, std::move(faces), kHole);
}

/// All faces, including those that no cell of the given sites reaches, because other cells may.
std::vector<OrderedFace> Relaxation::all_faces() const {
  std::vector<OrderedFace> result;
  for (std::size_t f = 0; f < surface_.face_count(); ++f)
    if (surface_.ordered().counts(nth_face(f))) result.push_back(nth_face(f));
  return result;
}

/// Add a ring to the region, or all sites if there is no further ring or more than half of the
/// sites would belong to the region.
void Relaxation::widen(const Context* context) {
  Indices grown = rings_.grown(region_, context);
  if (grown.size() == region_.size() || kHalf * grown.size() > given_) {
    grown.resize(given_);
    std::iota(grown.begin(), grown.end(), 0);
  }
  region_ = std::move(grown);
}

/// Sites of the region that may move.
std::size_t Relaxation::free_count() const {
  return static_cast<std::size_t>(std::count_if(
      region_.begin(), region_.end(), [this](std::int32_t s) { return !locked_[at(s)]; }));
}

/// The difference between the number of sites in the region and the number that fits the capacity
/// around it; infinite if none fit.
double Relaxation::spare_samples(const Region& region, const RestrictedVoronoi& diagram) const {
  const SharedCells shared = region.shared(diagram);
  const double fit = asked_for(shared, capacity_);
  if (!(fit > 0.0)) return std::numeric_limits<double>::infinity();
  const auto open = std::count(shared.open.begin(), shared.open.end(), true);
  return std::abs(static_cast<double>(open + lacking()) - fit);
}

/// Free more sites if those of the region would be crowded or sparse.
/// \return whether the region has grown
bool Relaxation::widen_for_count(const Region& region, const RestrictedVoronoi& diagram,
                                 const Context* context) {
  if (!options_.count || is_everything()) return false;
  const auto unlocked = static_cast<std::size_t>(
      std::count(locked_.begin(), locked_.begin() + static_cast<std::ptrdiff_t>(given_), false));
  const double spare = spare_samples(region, diagram);
  const bool nowhere = std::isinf(spare);
  const auto is_tight = [&] {
    return free_count() < unlocked &&
           spare - kRounding > kYield * static_cast<double>(free_count());
  };
  if (!nowhere && !is_tight()) return false;
  do widen(context);
  while (!is_everything() && !nowhere && is_tight());
  return true;
}

bool Relaxation::is_void(const std::vector<OrderedFace>& faces) const {
  return std::none_of(faces.begin(), faces.end(), [this](OrderedFace face) {
    return surface_.ordered().geometry(face).moments.capacity > 0.0;
  });
}

/// Remove all free sites if the target count is 0.
void Relaxation::empty() {
  for (std::size_t s = 0; s < sites_.size(); ++s) alive_[s] = alive_[s] && !free_[s];
}

/// The given faces as a separate surface, with their sites.
Region Relaxation::cut_out(const std::vector<OrderedFace>& faces, Context* context) {
  faces_ = faces;
  Region region{SurfacePart(surface_, faces, context)};
  for (std::size_t s = 0; s < sites_.size(); ++s) {
    const std::int32_t face = region.part.inside(sites_.faces[s]);
    if (face < 0 || !alive_[s]) continue;
    const auto site = static_cast<std::int32_t>(s);
    const auto is_in = [&](const Indices& sites) {
      return s >= given_ || std::binary_search(sites.begin(), sites.end(), site);
    };
    region.add({site, !free_[s], is_in(region_), is_in(border_)}, sites_, s, face);
  }
  return region;
}

/// Move free sites on density 0 to positive density if that is near, or remove them. One site
/// always stays, because new ones are inserted beside others.
void Relaxation::lead_to_density(Region& region, const Context* context) {
  const auto& domain = region.part.domain();
  const auto is_open = [&](std::size_t k) {
    const Region::Member& member = region.members[k];
    return member.open &&
           (member.fixed || is_on_density(region.part.surface(), region.sites.faces[k],
                                          region.sites.barycentric[k]));
  };
  bool any_open = false;
  for (std::size_t k = 0; k < region.members.size(); ++k) any_open = any_open || is_open(k);
  const std::vector<std::size_t> stay =
      lead_near_ones(region.part.surface(), *domain, region.sites,
                     {region.fixed(), kNear * surface_.spacing(given_), !any_open}, context);
  store(region, region.sites);
  take_out(stay, region);
}

/// Insert and remove sites so that new samples match their neighbors' capacity.
void Relaxation::balance(Region& region, Context* context) {
  lead_to_density(region, context);
  RestrictedVoronoi diagram = first_cells(region, context);
  while (widen_for_count(region, diagram, context)) {
    region = cut_out(faces_around(context), context);
    lead_to_density(region, context);
    diagram = first_cells(region, context);
  }
  for (std::size_t k = 0; k < region.members.size(); ++k)
    first_capacities_[region.members[k].site] = diagram.cells[k].capacity;
  const SharedCells shared = region.shared(diagram);
  const double wanted = options_.count ? capacity_for_count(region, shared) : capacity_;
  if (wanted == 0.0) return take_out(which_are(region.fixed()), region);
  check_wanted(std::span<const Region::Member>(region.members), diagram, wanted);
  if (options_.count && lacking() == 0 && is_spread(region, diagram, wanted)) return;
  const double most = kFewMore * static_cast<double>(region.members.size());
  if (options_.count && free_count() == given_ && static_cast<double>(*options_.count) <= most)
    return rebalance_all(region, context);
  const std::size_t beside_locked = lacking_beside_locked(shared, wanted);
  const auto& domain = region.part.domain();
  Thinned found = thin_out(region.part.surface(), *domain, region.sites,
                           {region.free(), wanted, std::move(diagram)}, context);
  report_.evaluations += found.evaluations;
  found.lacking += beside_locked;
  if (options_.count) keep_to_count(*options_.count, region, found);
  take_out(found.stay, region);
  if (found.lacking > 0) put_in(found.lacking, wanted, region, context);
}

/// Whether the cells are close enough to the capacity that sites need only move. Relaxing without a
/// change of the count then returns the same samples in the same order.
bool Relaxation::is_spread(const Region& region, const RestrictedVoronoi& diagram,
                           double capacity) {
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    const double share = diagram.cells[k].capacity / capacity;
    if (!region.members[k].fixed && !(share > kSmallest && share < kLargest)) return false;
  }
  return true;
}

/// All sites may move, and each neighborhood gets its number of sites, as in resampling.
void Relaxation::rebalance_all(Region& region, Context* context) {
  const auto& domain = region.part.domain();
  const Rebalanced found =
      rebalance(*domain, region.sites, options_.count.value_or(0), options_.seed, context);
  report_.evaluations += found.evaluations;
  take_out(found.stay, region);
  add(found.fresh, region);
}

/// The cells before insertions and removals; stores the target capacity.
RestrictedVoronoi Relaxation::first_cells(const Region& region, Context* context) {
  const auto& domain = region.part.domain();
  RestrictedVoronoi diagram =
      in_stage(context, Stage::kCells, [&] { return domain->cells(region.sites, context); });
  ++report_.evaluations;
  capacity_ = capacity_around(region, diagram);
  if (capacity_ == 0.0)
    capacity_ = capacity_elsewhere() * (domain->density_unit() / surface_.ordered().density_unit());
  share_ = capacity_;
  return diagram;
}

/// Thinning in several rounds can miss the count because of rounding. Then the smallest cells are
/// removed, or sites are inserted.
void Relaxation::keep_to_count(std::size_t count, const Region& region, Thinned& found) {
  const auto alive = static_cast<std::size_t>(std::count(alive_.begin(), alive_.end(), true));
  const std::size_t others = alive - region.members.size();
  found.lacking = count - std::min(count, others + found.stay.size());
  const auto room = [&](std::size_t k) {
    const Region::Member& member = region.members[k];
    return member.fixed ? std::numeric_limits<double>::infinity()
                        : first_capacities_.at(member.site);
  };
  while (others + found.stay.size() > count) {
    const auto least =
        std::min_element(found.stay.begin(), found.stay.end(),
                         [&](std::size_t a, std::size_t b) { return room(a) < room(b); });
    if (std::isinf(room(*least))) return;
    found.stay.erase(least);
  }
}

/// The mean capacity of complete cells outside the change; locked samples count only if there are
/// no others. 0 if there are no complete cells.
double Relaxation::capacity_around(const Region& region, const RestrictedVoronoi& diagram) const {
  double sum[2] = {}, count[2] = {};  // unlocked, locked
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    const Region::Member& member = region.members[k];
    if (!member.measured || std::binary_search(owners_.begin(), owners_.end(), member.site))
      continue;
    const std::size_t kind = locked_[at(member.site)] ? 1 : 0;
    sum[kind] += diagram.cells[k].capacity;
    ++count[kind];
  }
  const std::size_t kind = sum[0] > 0.0 ? 0 : 1;
  return count[kind] > 0.0 ? sum[kind] / count[kind] : 0.0;
}

/// The mean capacity on unchanged faces; on all faces if these have too few sites. The unit is that
/// of cells of the whole surface.
double Relaxation::capacity_elsewhere() const {
  double capacity = 0.0;
  std::vector<bool> is_changed(surface_.face_count(), false);
  for (const OrderedFace face : changed_) {
    is_changed[as_index(face)] = true;
    capacity += surface_.ordered().geometry(face).moments.capacity;
  }
  const auto left = std::count_if(sites_.faces.begin(), sites_.faces.end(), [&](std::int32_t f) {
    return !is_changed[as_index(surface_.ordered().ordered_face(f))];
  });
  const double all = surface_.ordered().unit_capacity();
  return left >= kFewSites && all > capacity ? (all - capacity) / static_cast<double>(left)
                                             : all / static_cast<double>(given_);
}

/// The target capacity of the open sites, chosen so that the count is reached; 0 if there are no
/// open sites.
double Relaxation::capacity_for_count(const Region& region, const SharedCells& shared) {
  double sum = 0.0;
  std::int64_t open = 0, free = 0;
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    if (!region.members[k].open) continue;
    sum += shared.cells[k].capacity;
    ++open;
    free += region.members[k].fixed ? 0 : 1;
  }
  const auto given = static_cast<std::int64_t>(given_);
  const std::int64_t more = lacking();
  const auto refuse = [&](std::int64_t some, const char* why) {
    throw ArgumentError("count is " + std::to_string(*options_.count) + " and there are " +
                        std::to_string(given) + " samples, " + std::to_string(some) + why);
  };
  if (free + more < 0) refuse(given - free, " of which stay: they are locked");
  if (open + more < 1) return 0.0;
  if (!(sum > 0.0)) refuse(free, " of which may be removed, but their cells have no capacity");
  share_ = sum / static_cast<double>(open + more);
  return capacity_for(shared, static_cast<std::size_t>(open + more));
}

/// The target count minus the current count.
std::int64_t Relaxation::lacking() const {
  return static_cast<std::int64_t>(options_.count.value_or(0)) -
         std::count(alive_.begin(), alive_.end(), true);
}

void Relaxation::take_out(const std::vector<std::size_t>& stay, Region& region) {
  if (stay.size() == region.members.size()) return;
  for (const Region::Member& member : region.members) alive_[at(member.site)] = false;
  Region left{std::move(region.part)};
  for (const std::size_t k : stay) {
    alive_[at(region.members[k].site)] = true;
    left.add(region.members[k], region.sites, k, region.sites.faces[k]);
  }
  region = std::move(left);
}

/// \param capacity the target capacity of each new site
void Relaxation::put_in(std::size_t count, double capacity, Region& region,
                        const Context* context) {
  const Sites fresh = widest_gaps(region.part.surface(), {region.sites, region.open(), capacity},
                                  count, options_.seed, context);
  if (options_.count && fresh.size() < count)
    throw ArgumentError("count is " + std::to_string(*options_.count) +
                        ", but the region has places for only " + std::to_string(fresh.size()) +
                        " of " + std::to_string(count) + " new samples");
  add(fresh, region);
}

void Relaxation::add(const Sites& fresh, Region& region) {
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    region.add({static_cast<std::int32_t>(sites_.size()), false, true, true}, fresh, k,
               fresh.faces[k]);
    sites_.positions.push_back(fresh.positions[k]);
    sites_.faces.push_back(region.part.outside(fresh.faces[k]));
    sites_.barycentric.push_back(fresh.barycentric[k]);
  }
  alive_.resize(sites_.size(), true);
  free_.resize(sites_.size(), true);
  locked_.resize(sites_.size(), false);
}

/// Minimize over the free sites of a region.
/// \return the sites at its border whose cells are uneven afterward
Relaxation::Indices Relaxation::even_out(const Region& region, Context* context) {
  const auto& domain = region.part.domain();
  const Minimum found = minimum(region, domain, context);
  store(region, found.state.sites);
  note(region, found);
  return uneven(region, own_energy(found).diagram);
}

Minimum Relaxation::minimum(const Region& region, std::shared_ptr<const SurfaceDomain> domain,
                            Context* context) const {
  const OptimizerOptions& optimizer = options_.optimizer;
  if (others_) {
    const FreeClass own{&region, std::move(domain), share_};
    return minimize_free({&own, 1}, *others_, optimizer, context);
  }
  const Objective objective{.capacity_weight = optimizer.capacity_weight,
                            .terms = {{.domain = domain.get(),
                                       .repulsion_radius = optimizer.repulsion_radius,
                                       .repulsion_weight = optimizer.repulsion_weight,
                                       .site_capacity = share_}},
                            .locked = region.fixed()};
  Sites start = region.sites;
  dapple::lead_to_density(region.part.surface(), *domain, start, objective.locked);
  return minimize(objective, start, optimizer, context);
}

void Relaxation::store(const Region& region, const Sites& found) {
  region.put_free(found, 0, sites_);
}

Relaxation::Indices Relaxation::uneven(const Region& region,
                                       const RestrictedVoronoi& diagram) const {
  Indices result;
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    const std::int32_t s = region.members[k].site;
    if (!region.members[k].measured || at(s) >= given_ ||
        std::binary_search(region_.begin(), region_.end(), s))
      continue;
    const auto off = [this](double capacity) { return std::abs(capacity / capacity_ - 1.0); };
    const auto first = first_capacities_.find(s);
    const double before = first == first_capacities_.end() ? 0.0 : off(first->second);
    const double now = off(diagram.cells[k].capacity);
    if (now > kUneven && now > before + kPushed) result.push_back(s);
  }
  return result;
}

/// \return as even_out()
Relaxation::Indices Relaxation::grow_at(const Indices& uneven, Context* context) {
  Stretch finding(context, 0.0, kFound), evening(context, kFound, 1.0);
  const Indices around = rings_.grown(uneven, context);
  Indices grown;
  std::set_union(region_.begin(), region_.end(), around.begin(), around.end(),
                 std::back_inserter(grown));
  region_ = std::move(grown);
  return even_out(cut_out(faces_around(context), finding.context()), evening.context());
}

/// Measure the result as analyze() does.
void Relaxation::measure_all(const Region& region, const Minimum& found) {
  Indices mine(region.members.size()), faces;
  std::iota(mine.begin(), mine.end(), 0);
  const Sites sites = select(found.state.sites, mine);
  for (const std::int32_t face : sites.faces) faces.push_back(region.part.outside(face));
  const auto& domain = region.part.domain();
  const Energy& energy = own_energy(found);  // in units of the part's share
  static_cast<Quality&>(report_) =
      measure(*domain, energy, sites, surface_.normals(faces, sites.barycentric));
  const double owned = domain->capacity() * owned_share(energy.diagram, domain->capacity());
  report_.energy = static_cast<double>(sites.size()) * energy.total / owned / owned -
                   options_.optimizer.capacity_weight;
}

/// Note the result of the last round; its evaluations and iterations are added to the previous
/// ones.
void Relaxation::note(const Region& region, const Minimum& found) {
  if (is_everything()) {
    measure_all(region, found);
  } else {
    const std::span<const Vec3> normals(found.state.normals);
    measure_members({own_energy(found).diagram, normals.first(region.members.size()),
                     region.measured(), share_, options_.optimizer.capacity_weight},
                    report_);
  }
  report_.evaluations += found.evaluations;
  report_.iterations += found.iterations;
  report_.converged = found.converged;
  report_.energies = found.energies;
}

}  // namespace dapple
