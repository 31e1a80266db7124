// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/pushing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
constexpr double kRoom = 0.5;     // of a contact; pairs on the two sides of a thin edge have less
constexpr double kWorse = 1.05;   // factor by which pushes may raise the capacity variation
constexpr double kEven = 0.008;   // or up to this
constexpr int kRounds = 2;        // evaluations; places that cost too much are left out next time

/// Two sites that are to keep apart.
struct Pair {
  std::size_t i, j;
  double spacing;
};

/// Call visit(pair, offset from j to i) for touching sites and sites of two bodies.
template <typename Visit>
void for_each_pair(const Objective& objective, const Evaluation& state, const Visit& visit) {
  const auto call = [&](std::size_t i, std::size_t j, const Vec3& offset) {
    visit(Pair{i, j, spacing_between(objective, state, i, j)}, offset);
  };
  for (const Stranger& pair : state.parts[0].strangers)
    call(static_cast<std::size_t>(pair.i), static_cast<std::size_t>(pair.j), pair.offset);
  const RestrictedVoronoi& diagram = state.diagram();
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    for (const CellBoundary& side : diagram.boundary(i))
      if (const auto j = static_cast<std::size_t>(side.neighbor); j > i)
        call(i, j, Vec3(-side.offset));
}

/// Add a contact if the pair can move apart along the surface.
bool add_pair(const Planes& planes, const Pair& pair, const Vec3& offset, double least,
              std::vector<Contact>& contacts) {
  if (!(offset.squaredNorm() > 0.0)) return false;
  const std::size_t before = contacts.size();
  add_contact(planes, pair.i, pair.j, offset, least, kNearly * least, contacts);
  if (contacts.size() > before && contacts.back().room < kRoom) contacts.pop_back();
  return contacts.size() > before;
}

/// Sites that are too near to others and can move apart.
Chosen crowded(const Objective& objective, const Evaluation& state) {
  const Planes planes{state.normals, objective.locked};
  std::vector<Contact> contacts;
  for_each_pair(objective, state, [&](const Pair& pair, const Vec3& offset) {
    if (offset.norm() < kNear * pair.spacing)
      add_pair(planes, pair, offset, kApart * pair.spacing, contacts);
  });
  Chosen sites;
  for (const Contact& contact : contacts) sites.insert(sites.end(), {contact.i, contact.j});
  make_unique(sites);
  return sites;
}

/// The pairs of which at least one site may move.
std::vector<Pair> pairs_around(const Objective& objective, const Evaluation& state,
                               const std::vector<bool>& near) {
  std::vector<Pair> pairs;
  for_each_pair(objective, state, [&](const Pair& pair, const Vec3&) {
    if (near[pair.i] || near[pair.j]) pairs.push_back(pair);
  });
  return pairs;
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

Sites pushed(const Objective& objective, const Evaluation& state, const Chosen& crowded,
             Context* context) {
  const std::vector<Pair> pairs =
      pairs_around(objective, state, around(state.diagram(), crowded, kRings));
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
    Chosen sites = crowded(objective, found.state);
    if (static_cast<double>(sites.size()) > few) return;
    std::erase_if(sites, [&](std::size_t k) { return given_up[k]; });
    if (sites.empty()) return;
    const std::vector<Chosen> places = places_of(found.state.diagram(), sites, kRings);
    update(next, objective, pushed(objective, found.state, sites, context), nullptr);
    ++found.evaluations;
    const std::vector<Chosen> costly = unaffordable(objective, found.state, next, places);
    for (const Chosen& place : costly)
      for (const std::size_t k : place) given_up[k] = true;
    if (costly.empty()) std::swap(found.state, next);
  }
}

}  // namespace dapple
