// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/pushing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "optimize/contacts.hpp"
#include "optimize/neighborhoods.hpp"

namespace dapple {
namespace {

constexpr double kNear = 0.65;    // spacings: sites that are nearer are pushed apart
constexpr double kApart = 0.66;   // spacings that they get
constexpr double kFew = 0.05;     // share of the sites that may be that near
constexpr int kRings = 2;         // of neighbors that make room
constexpr int kPushes = 8;        // until no pair is too near
constexpr double kNearly = 1e-3;  // of the distance: what a push may leave
constexpr double kWorse = 1.05;   // factor by which pushes may raise the capacity variation
constexpr double kEven = 0.008;   // or up to this
constexpr int kRounds = 2;        // evaluations; places that cost too much are left out next time

/// Two sites that are to keep apart.
struct Pair {
  std::size_t i, j;
  double spacing;
};

/// The local spacing at each site.
std::vector<double> spacings_of(const Objective& objective, const Evaluation& state) {
  std::vector<double> spacings(state.diagram().cells.size());
  for_each_vector(spacings.size(),
                  [&](std::size_t k) { spacings[k] = local_spacing(objective, state, 0, k); });
  return spacings;
}

/// Sites of two bodies, then touching sites, for which wanted(pair, offset from j to i) is true.
template <typename Wanted>
std::vector<Pair> pairs_where(const Evaluation& state, const std::vector<double>& spacings,
                              const Wanted& wanted) {
  const auto add = [&](std::size_t i, std::size_t j, const Vec3& offset, std::vector<Pair>& out) {
    const Pair pair{i, j, 0.5 * (spacings[i] + spacings[j])};
    if (wanted(pair, offset)) out.push_back(pair);
  };
  std::vector<Pair> all;
  for (const Stranger& pair : state.parts[0].strangers)
    add(static_cast<std::size_t>(pair.i), static_cast<std::size_t>(pair.j), pair.offset, all);
  const RestrictedVoronoi& diagram = state.diagram();
  std::vector<std::vector<Pair>> found((diagram.cells.size() + kVectorGrain - 1) / kVectorGrain);
  parallel_chunks(diagram.cells.size(), kVectorGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const CellBoundary& side : diagram.boundary(i))
        if (const auto j = static_cast<std::size_t>(side.neighbor); j > i)
          add(i, j, Vec3(-side.offset), found[begin / kVectorGrain]);
  });
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Add a contact if the pair can move apart along the surface.
bool add_pair(const Planes& planes, const Pair& pair, const Vec3& offset, double least,
              std::vector<Contact>& contacts) {
  return offset.squaredNorm() > 0.0 &&
         add_contact(planes, pair.i, pair.j, offset, least, kNearly * least, contacts, kRoomAlong);
}

/// Sites that are too near to others and can move apart.
Chosen crowded(const Objective& objective, const Evaluation& state,
               const std::vector<double>& spacings) {
  const Planes planes{state.normals, objective.locked};
  Chosen sites;
  for (const Pair& pair : pairs_where(state, spacings, [&](const Pair& near, const Vec3& offset) {
         std::vector<Contact> contact;
         return offset.norm() < kNear * near.spacing &&
                add_pair(planes, near, offset, kApart * near.spacing, contact);
       }))
    sites.insert(sites.end(), {pair.i, pair.j});
  make_unique(sites);
  return sites;
}

/// Moves that lead pairs apart that are too near, and bring no others too near.
/// \return whether there are such pairs
bool moves_apart(const Objective& objective, const std::vector<Pair>& pairs, const Sites& sites,
                 const Vectors& normals, Vectors& moves) {
  const Planes planes{normals, objective.locked};
  std::vector<Contact> contacts;
  bool any = false;
  for (const Pair& pair : pairs) {
    const Vec3 offset = sites.positions[pair.i] - sites.positions[pair.j];
    const double ratio = offset.norm() / pair.spacing;
    const double least = pair.spacing * (ratio < kNear ? kApart : kNear);
    any = (add_pair(planes, pair, offset, least, contacts) && ratio < kNear) || any;
  }
  moves.assign(sites.size(), Vec3::Zero());
  if (any) separate(contacts, moves);
  objective.restrict(moves, normals);
  return any;
}

Sites pushed(const Objective& objective, const Evaluation& state,
             const std::vector<double>& spacings, const Chosen& crowded, Context* context) {
  const std::vector<bool> near = around(state.diagram(), crowded, kRings);
  const std::vector<Pair> pairs =  // of which at least one site may move
      pairs_where(state, spacings,
                  [&](const Pair& pair, const Vec3&) { return near[pair.i] || near[pair.j]; });
  Sites sites = state.sites;
  Vectors normals = state.normals, moves;
  for (int push = 0; push < kPushes; ++push) {
    if (!moves_apart(objective, pairs, sites, normals, moves)) break;
    for (const std::int32_t k : objective.move(moves, sites, context)) {
      const auto site = static_cast<std::size_t>(k);
      normals[site] = objective.domain().normal(sites.faces[site]);
    }
  }
  return sites;
}

/// By how much the squares of the deviations of the capacities rise around a place, relative to
/// that of the mean.
double rise_at(const Objective& objective, const Evaluation& before, const Evaluation& after,
               const Chosen& place) {
  const double mean = objective.terms[0].mean_capacity(before.sites.size());
  const auto off = [&](const Evaluation& state, std::size_t k) {
    return std::pow(state.diagram().cells[k].capacity / mean - 1.0, 2);
  };
  double rise = 0.0;
  for (const std::size_t k : with_rings(before.diagram(), place, kRings + 1))
    rise += off(after, k) - off(before, k);
  return rise;
}

/// The places where pushes cost most, so that the others together cost no more than they may.
std::vector<Chosen> unaffordable(const Objective& objective, const Evaluation& before,
                                 const Evaluation& after, const std::vector<Chosen>& places) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t p = 0; p < places.size(); ++p)
    order.emplace_back(rise_at(objective, before, after, places[p]), p);
  std::sort(order.begin(), order.end());
  const double variation = capacity_variation(objective, before);
  const double most = std::max(kWorse * variation, kEven);
  double left = static_cast<double>(before.sites.size()) * (most * most - variation * variation);
  std::vector<Chosen> result;
  for (const auto& [rise, p] : order) {
    left -= rise;
    if (left < 0.0) result.push_back(places[p]);
  }
  return result;
}

}  // namespace

void push_apart(const Objective& objective, int most, Minimum& found, Context* context) {
  const auto few = kFew * static_cast<double>(found.state.sites.size());
  std::vector<bool> given_up(found.state.sites.size(), false);
  Evaluation next;
  for (int round = 0; round < kRounds && found.evaluations < most; ++round) {
    check_context(context);
    const std::vector<double> spacings = spacings_of(objective, found.state);
    Chosen sites = crowded(objective, found.state, spacings);
    if (static_cast<double>(sites.size()) > few) return;
    std::erase_if(sites, [&](std::size_t k) { return given_up[k]; });
    if (sites.empty()) return;
    const std::vector<Chosen> places = places_of(found.state.diagram(), sites, kRings);
    update(next, objective, pushed(objective, found.state, spacings, sites, context), nullptr);
    ++found.evaluations;
    const std::vector<Chosen> costly = unaffordable(objective, found.state, next, places);
    for (const Chosen& place : costly)
      for (const std::size_t k : place) given_up[k] = true;
    if (costly.empty()) std::swap(found.state, next);
  }
}

}  // namespace dapple
