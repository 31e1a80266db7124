// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax/relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/progress.hpp"
#include "base/stopwatch.hpp"
#include "base/validate.hpp"
#include "relax/part_domain.hpp"
#include "relax/widest_gaps.hpp"
#include "sample/lead_to_density.hpp"
#include "sample/rebalance.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr int kFreeRings = 2;     // around the cells that have a part of what has changed
constexpr double kUneven = 0.02;  // of the capacity: a border cell so far off is freed too ...
constexpr double kPushed = 0.01;  // ... unless it hardly was nearer before
constexpr int kGrowths = 16;
constexpr std::size_t kHole = 256;  // faces
constexpr int kHardlyAny = 16;      // sites that tell nothing of the capacity of all
// Of the progress: the region is known, it has its number of sites, it is even for the first time;
// then half of the rest each.
constexpr double kFound = 0.1, kBalanced = 0.25, kFirst = 0.7, kGrown = 0.5;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

/// \param members per cell: a fixed one gets no others beside it
/// \throw ArgumentError if samples of that capacity are more than there can be
template <typename Member>
void check_wanted(std::span<const Member> members, const RestrictedVoronoi& diagram,
                  double capacity) {
  double sum = 0.0;
  for (std::size_t k = 0; k < members.size(); ++k)
    if (members[k].open) sum += diagram.cells[k].capacity;
  if (!(sum <= capacity * static_cast<double>(kMostSamples)))
    throw ArgumentError("what has changed asks for " + number(sum / capacity) +
                        " samples to be as dense as around it: at most " +
                        std::to_string(kMostSamples) + " are possible");
}

}  // namespace

/// The sites of one round: a part of the surface and what lies on it.
struct Relaxation::Region {
  struct Member {
    std::int32_t site;
    bool fixed;
    bool open;      // others may come into its cell, even if it is locked
    bool measured;  // it may move, or is beside one that may
  };

  SurfacePart part;
  std::vector<Member> members = {};
  Sites sites = {};  // on the part

  /// \param face of the part
  void add(const Member& member, const Sites& from, std::size_t k, std::int32_t face) {
    members.push_back(member);
    sites.positions.push_back(from.positions[k]);
    sites.faces.push_back(face);
    sites.barycentric.push_back(from.barycentric[k]);
  }

  [[nodiscard]] std::vector<bool> fixed() const {
    return which([](const Member& member) { return member.fixed; });
  }
  [[nodiscard]] std::vector<bool> free() const {
    return which([](const Member& member) { return !member.fixed; });
  }
  [[nodiscard]] std::vector<bool> open() const {
    return which([](const Member& member) { return member.open; });
  }

 private:
  [[nodiscard]] std::vector<bool> which(const auto& is) const {
    std::vector<bool> result;
    result.reserve(members.size());
    for (const Member& member : members) result.push_back(is(member));
    return result;
  }
};

Relaxation::Relaxation(const Surface& surface, Sites sites, std::vector<bool> locked,
                       const RelaxOptions& options)
    : surface_(surface),
      options_(options),
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
  for (int k = 0; k < kFreeRings; ++k) region_ = rings_.grown(region_, context);
  const std::vector<OrderedFace> faces = faces_around(context);
  if (is_void(faces)) return empty();
  Region region = cut_out(faces, finding.context());
  balance(region, balancing.context());
  if (region.members.empty()) return;
  Indices uneven = even_out(region, first.context());
  double done = kFirst;
  for (int k = 0; k < kGrowths && !uneven.empty(); ++k) {
    const double before = std::exchange(done, done + kGrown * (1.0 - done));
    Stretch step(context, before, done);
    uneven = grow_at(uneven, step.context());
  }
}

/// Those of the cells of the region and of two fixed rings around it, the first of which has whole
/// cells thanks to the second; sorted.
std::vector<OrderedFace> Relaxation::faces_around(const Context* context) {
  for (const std::int32_t s : region_) free_[at(s)] = !locked_[at(s)];
  border_ = rings_.grown(region_, context);
  const Indices all = rings_.grown(border_, context);
  return without_holes(surface_, rings_.faces(all, context), kHole);
}

bool Relaxation::is_void(const std::vector<OrderedFace>& faces) const {
  return std::none_of(faces.begin(), faces.end(), [this](OrderedFace face) {
    return surface_.ordered().geometry(face).moments.capacity > 0.0;
  });
}

/// Nothing stays where nothing shall be.
void Relaxation::empty() {
  for (std::size_t s = 0; s < sites_.size(); ++s) alive_[s] = alive_[s] && !free_[s];
}

/// What lies on faces, as a surface of its own.
Relaxation::Region Relaxation::cut_out(const std::vector<OrderedFace>& faces, Context* context) {
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

/// Take out and put in sites, so that each has the capacity of those around.
void Relaxation::balance(Region& region, Context* context) {
  const SurfaceDomain domain(region.part.surface(), Cells::kConnected, Steps::kConnected,
                             /*sides=*/nullptr, EmptyFaces::kLeft);
  RestrictedVoronoi diagram =
      in_stage(context, Stage::kCells, [&] { return domain.cells(region.sites, context); });
  ++report_.evaluations;
  capacity_ = capacity_around(region, diagram);
  for (std::size_t k = 0; k < region.members.size(); ++k)
    first_capacities_[region.members[k].site] = diagram.cells[k].capacity;
  if (capacity_ == 0.0)
    capacity_ = capacity_elsewhere() * (domain.density_unit() / surface_.ordered().density_unit());
  const double wanted = wanted_capacity(region, diagram);
  if (wanted == 0.0) return;
  check_wanted(std::span<const Region::Member>(region.members), diagram, wanted);
  const std::size_t beside_locked = lacking_beside_locked(region, diagram, wanted);
  Thinned found = thin_out(region.part.surface(), domain, region.sites,
                           {region.free(), wanted, std::move(diagram)}, context);
  report_.evaluations += found.evaluations;
  found.lacking += beside_locked;
  if (options_.count) keep_to_count(*options_.count, region, found);
  take_out(found.stay, region);
  if (found.lacking > 0) put_in(found.lacking, wanted, region, context);
}

/// How many more the cells of locked sites have room for.
std::size_t Relaxation::lacking_beside_locked(const Region& region,
                                              const RestrictedVoronoi& diagram, double capacity) {
  double room = 0.0;
  for (std::size_t k = 0; k < region.members.size(); ++k)
    if (region.members[k].open && region.members[k].fixed)
      room += diagram.cells[k].capacity / capacity - 1.0;
  return static_cast<std::size_t>(std::llround(std::max(room, 0.0)));
}

/// What is thinned out in several rounds can miss the count by the rounding of each: the smallest
/// cells go, or more are put in.
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

/// The mean of the whole cells where nothing has changed; 0 if there are none.
double Relaxation::capacity_around(const Region& region, const RestrictedVoronoi& diagram) const {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    const Region::Member& member = region.members[k];
    if (!member.measured || std::binary_search(owners_.begin(), owners_.end(), member.site))
      continue;
    sum += diagram.cells[k].capacity;
    ++count;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// The mean on the faces that have not changed; of all where these hold hardly any sites. In the
/// unit of the cells of the whole surface.
double Relaxation::capacity_elsewhere() const {
  double mass = 0.0;
  std::vector<bool> is_changed(surface_.face_count(), false);
  for (const OrderedFace face : changed_) {
    is_changed[as_index(face)] = true;
    mass += surface_.ordered().geometry(face).moments.capacity;
  }
  const auto left = std::count_if(sites_.faces.begin(), sites_.faces.end(), [&](std::int32_t f) {
    return !is_changed[as_index(surface_.ordered().ordered_face(f))];
  });
  const double all = surface_.ordered().unit_mass();
  return left >= kHardlyAny && all > mass ? (all - mass) / static_cast<double>(left)
                                          : all / static_cast<double>(given_);
}

/// Of each of the sites where samples come and go, so that there become as many as are wanted; 0:
/// they are as many.
double Relaxation::wanted_capacity(const Region& region, const RestrictedVoronoi& diagram) const {
  if (!options_.count) return capacity_;
  double sum = 0.0;
  std::int64_t open = 0, free = 0;
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    if (!region.members[k].open) continue;
    sum += diagram.cells[k].capacity;
    ++open;
    free += region.members[k].fixed ? 0 : 1;
  }
  const auto given = static_cast<std::int64_t>(given_);
  const std::int64_t more = static_cast<std::int64_t>(*options_.count) - given;
  if (more == 0 && !has_stranded(region)) return 0.0;
  const auto refuse = [&](std::int64_t some, const char* why) {
    throw ArgumentError("count is " + std::to_string(*options_.count) + " and there are " +
                        std::to_string(given) + " samples, " + std::to_string(some) + why);
  };
  if (free + more < 0)
    refuse(given - free, " of which stay: they are locked, or nothing has changed around them");
  if (open + more < 1 || !(sum > 0.0))
    refuse(free, " of which are where something has changed and may go: one of these has to stay");
  return sum / static_cast<double>(open + more);
}

/// Whether a site that may go is where there is no density any more: others come elsewhere.
bool Relaxation::has_stranded(const Region& region) {
  for (std::size_t k = 0; k < region.members.size(); ++k)
    if (!region.members[k].fixed && !has_density(region.part.surface(), region.sites.faces[k]))
      return true;
  return false;
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

/// \param capacity that each is to have
void Relaxation::put_in(std::size_t count, double capacity, Region& region,
                        const Context* context) {
  const Sites fresh = widest_gaps(region.part.surface(), {region.sites, region.open(), capacity},
                                  count, options_.seed, context);
  if (options_.count && fresh.size() < count)
    throw ArgumentError("count is " + std::to_string(*options_.count) + ", but where samples may " +
                        "go there are places for " + std::to_string(fresh.size()) + " of " +
                        std::to_string(count) + " new ones only");
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
/// \return the sites at its border whose cells are uneven then
Relaxation::Indices Relaxation::even_out(const Region& region, Context* context) {
  const SurfaceDomain domain(region.part.surface(), Cells::kConnected, Steps::kConnected,
                             /*sides=*/nullptr, EmptyFaces::kLeft);
  const PartDomain share(domain, capacity_, region.members.size());
  const OptimizerOptions& optimizer = options_.optimizer;
  const Objective objective{.capacity_weight = optimizer.capacity_weight,
                            .terms = {{.domain = &share,
                                       .repulsion_radius = optimizer.repulsion_radius,
                                       .repulsion_weight = optimizer.repulsion_weight}},
                            .locked = region.fixed()};
  Sites start = region.sites;
  lead_to_density(region.part.surface(), domain, start, objective.locked);
  const Minimum found = minimize(objective, start, optimizer, context);
  store(region, found.state.sites);
  note(region, found);
  return uneven(region, found.state.diagram());
}

void Relaxation::store(const Region& region, const Sites& found) {
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    if (region.members[k].fixed) continue;
    const std::size_t s = at(region.members[k].site);
    sites_.positions[s] = found.positions[k];
    sites_.faces[s] = region.part.outside(found.faces[k]);
    sites_.barycentric[s] = found.barycentric[k];
  }
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

/// What the last round found; its evaluations and iterations are added to those before.
void Relaxation::note(const Region& region, const Minimum& found) {
  const RestrictedVoronoi& all = found.state.diagram();
  RestrictedVoronoi measured;
  std::vector<Vec3> normals;
  double energy = 0.0;
  for (std::size_t k = 0; k < region.members.size(); ++k) {
    if (!region.members[k].measured) continue;
    const Moments& cell = all.cells[k];
    measured.cells.push_back(cell);
    measured.rows.push_back(all.rows[k]);
    normals.push_back(found.state.normals[k]);
    energy += (cell.second / capacity_ +
               options_.optimizer.capacity_weight * cell.capacity * (cell.capacity / capacity_)) /
              capacity_;
  }
  measured.boundaries = all.boundaries;
  report_.evenness = measure_evenness(measured);
  report_.bond_order = bond_order(measured, normals);
  report_.energy =
      energy / static_cast<double>(normals.size()) - options_.optimizer.capacity_weight;
  report_.evaluations += found.evaluations;
  report_.iterations += found.iterations;
  report_.converged = found.converged;
  report_.energies = found.energies;
}

}  // namespace dapple
