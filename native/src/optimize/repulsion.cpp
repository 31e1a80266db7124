// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/repulsion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dapple {
namespace {

// How close a step may bring two sites, relative to the repulsion radius. With a smaller value the
// step determines the smallest distance of the next state; with 1 the steps become too short (0.95
// to 0.98 measured about the same, 0.98 best).
constexpr double kNear = 0.98;
constexpr double kSlack = 1e-9;  // relative, for rounding
// The distance that a step leaves between two sites, relative to the repulsion radius: the few
// pairs that are nearer than the others by far are separated at once, where the minimum of the
// energy is reached only after many more steps.
constexpr double kLeast = 0.92, kLeastOfLarger = 0.87, kMostOfMean = 1.06;
constexpr double kFew = 0.08;     // share of the sites: if more are so near, nothing is separated
constexpr double kBeyond = 0.1;   // of the distance: farther sites are not pushed into others
constexpr double kNearly = 1e-3;  // of the distance: the difference that may remain

/// Call visit(i, j, offset from j to i, out) for every pair of sites whose cells touch, in
/// parallel, and for strangers; return the contents of `out`, in the order of the sites.
template <typename Found, typename Visit>
std::vector<Found> of_close_pairs(const RestrictedVoronoi& diagram,
                                  std::span<const Stranger> strangers, const Visit& visit) {
  const std::size_t count = diagram.cells.size();
  std::vector<std::vector<Found>> found((count + kVectorGrain - 1) / kVectorGrain);
  parallel_chunks(count, kVectorGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const CellBoundary& side : diagram.boundary(i)) {
        const auto j = static_cast<std::size_t>(side.neighbor);
        // Each pair is visited once, because both cells list their common boundary, apart from
        // rounding.
        if (j >= i) visit(i, j, -side.offset, found[begin / kVectorGrain]);
      }
  });
  std::vector<Found> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  for (const Stranger& pair : strangers)
    visit(static_cast<std::size_t>(pair.i), static_cast<std::size_t>(pair.j), pair.offset, all);
  return all;
}

void sort_unique(std::vector<std::size_t>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// The distance at which touching sites are kept apart. Where the density changes quickly, the mean
/// of the radii is little for the site with the larger one.
double least_distance(double a, double b) {
  const double mean = 0.5 * (a + b);
  return std::clamp(kLeastOfLarger * std::max(a, b), kLeast * mean, kMostOfMean * mean);
}

/// Sites that are nearer to a touching one than that after the moves; sorted.
std::vector<std::size_t> crowded_sites(const RestrictedVoronoi& diagram,
                                       const std::vector<double>& radii, const Vectors& moves,
                                       std::span<const Stranger> strangers) {
  std::vector<std::size_t> sites = of_close_pairs<std::size_t>(
      diagram, strangers,
      [&](std::size_t i, std::size_t j, const Vec3& d, std::vector<std::size_t>& out) {
        if ((d + moves[i] - moves[j]).norm() < least_distance(radii[i], radii[j]))
          out.insert(out.end(), {i, j});
      });
  sort_unique(sites);
  return sites;
}

/// The sites, those whose cells touch theirs, and strangers; sorted.
std::vector<std::size_t> with_neighbors(const RestrictedVoronoi& diagram,
                                        std::span<const Stranger> strangers,
                                        std::vector<std::size_t> sites) {
  const std::size_t count = sites.size();
  const std::vector<std::size_t> given = sites;
  for (const Stranger& pair : strangers) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    if (std::binary_search(given.begin(), given.end(), i)) sites.push_back(j);
    if (std::binary_search(given.begin(), given.end(), j)) sites.push_back(i);
  }
  for (std::size_t k = 0; k < count; ++k)
    for (const CellBoundary& side : diagram.boundary(sites[k]))
      sites.push_back(static_cast<std::size_t>(side.neighbor));
  sort_unique(sites);
  return sites;
}

}  // namespace

std::optional<Push> push_between(std::size_t i, std::size_t j, const Vec3& d, double radius,
                                 double weight) {
  const double distance = d.norm();
  if (distance >= radius || distance <= 0.0) return std::nullopt;
  const double overlap = 1.0 - distance / radius;
  const Vec3 direction = d / distance;
  return Push{{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), overlap,
               weight * overlap * overlap, 2.0 * weight / (radius * radius), direction},
              2.0 * weight * overlap / radius * direction};
}

void add(Repulsion& repulsion, const Push& push) {
  repulsion.energy += push.pair.energy;
  repulsion.gradient[static_cast<std::size_t>(push.pair.i)] -= push.force;
  repulsion.gradient[static_cast<std::size_t>(push.pair.j)] += push.force;
  repulsion.pairs.push_back(push.pair);
}

void update_repulsion(Repulsion& repulsion, const RestrictedVoronoi& diagram,
                      const std::vector<double>& radii, double weight,
                      std::span<const Stranger> strangers, double stronger) {
  repulsion.energy = 0.0;
  repulsion.pairs.clear();
  repulsion.gradient.resize(diagram.cells.size());
  for_each_vector(diagram.cells.size(), [&](std::size_t k) { repulsion.gradient[k].setZero(); });
  if (weight == 0.0 || radii.empty()) return;
  const auto pushes = of_close_pairs<Push>(
      diagram, {}, [&](std::size_t i, std::size_t j, const Vec3& d, std::vector<Push>& out) {
        if (const auto push = push_between(i, j, d, 0.5 * (radii[i] + radii[j]), weight))
          out.push_back(*push);
      });
  for (const Push& push : pushes) add(repulsion, push);
  for (const Stranger& pair : strangers) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    const double radius = 0.5 * (radii[i] + radii[j]);
    if (const auto push = push_between(i, j, pair.offset, radius, stronger * weight))
      add(repulsion, *push);
  }
}

Approaches::Approaches(const RestrictedVoronoi& diagram, const std::vector<double>& radii,
                       const Vectors& moves, std::span<const Stranger> strangers)
    : diagram_(diagram), radii_(radii), strangers_(strangers) {
  if (radii.empty()) return;
  std::vector<double> lengths(moves.size());
  for_each_vector(moves.size(), [&](std::size_t k) { lengths[k] = moves[k].norm(); });
  const std::size_t count = diagram.cells.size();
  candidates_.resize((count + kVectorGrain - 1) / kVectorGrain);
  parallel_chunks(count, kVectorGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < diagram.rows[i].count; ++k) {
        const std::size_t side = diagram.rows[i].first + k;
        const auto j = static_cast<std::size_t>(diagram.boundaries[side].neighbor);
        if (j < i) continue;  // each pair is visited once
        const double distance = diagram.boundaries[side].offset.norm();
        if (distance - lengths[i] - lengths[j] < (1.0 + kSlack) * least(i, j, distance))
          candidates_[begin / kVectorGrain].push_back({i, side});
      }
  });
}

double Approaches::least(std::size_t i, std::size_t j, double distance) const {
  return std::min(kNear * 0.5 * (radii_[i] + radii_[j]), distance);
}

bool Approaches::is_too_near(std::size_t i, std::size_t j, const Vec3& d,
                             const Vectors& moves) const {
  return (d + moves[i] - moves[j]).norm() < least(i, j, d.norm());
}

std::size_t Approaches::shorten(Vectors& moves) const {
  std::vector<bool> shortened(radii_.size(), false);
  std::vector<std::vector<std::size_t>> found(candidates_.size());
  parallel_chunks(candidates_.size(), 1, [&](std::size_t chunk, std::size_t) {
    for (const auto& [i, side] : candidates_[chunk]) {
      const CellBoundary& boundary = diagram_.boundaries[side];
      const auto j = static_cast<std::size_t>(boundary.neighbor);
      if (is_too_near(i, j, -boundary.offset, moves))
        found[chunk].insert(found[chunk].end(), {i, j});
    }
  });
  for (const auto& part : found)
    for (const std::size_t k : part) shortened[k] = true;
  for (const Stranger& pair : strangers_) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    if (!radii_.empty() && is_too_near(i, j, pair.offset, moves))
      shortened[i] = shortened[j] = true;
  }
  for (std::size_t k = 0; k < shortened.size(); ++k)
    if (shortened[k]) moves[k] *= 0.5;
  return static_cast<std::size_t>(std::count(shortened.begin(), shortened.end(), true));
}

std::vector<Contact> crowded_contacts(const RestrictedVoronoi& diagram,
                                      const std::vector<double>& radii, const Vectors& normals,
                                      const std::vector<bool>& locked, const Vectors& moves,
                                      std::span<const Stranger> strangers) {
  std::vector<Contact> contacts;
  if (radii.empty()) return contacts;
  const std::vector<std::size_t> crowded = crowded_sites(diagram, radii, moves, strangers);
  if (crowded.empty() ||
      static_cast<double>(crowded.size()) > kFew * static_cast<double>(radii.size()))
    return contacts;
  const Planes planes{normals, locked};
  const std::vector<std::size_t> around = with_neighbors(diagram, strangers, crowded);
  const auto is_around = [&](std::size_t k) {
    return std::binary_search(around.begin(), around.end(), k);
  };
  const auto keep = [&](std::size_t i, std::size_t j, const Vec3& d) {
    const double least = least_distance(radii[i], radii[j]);
    if (d.squaredNorm() > 0.0 && (d + moves[i] - moves[j]).norm() <= (1.0 + kBeyond) * least)
      add_contact(planes, i, j, d, least, kNearly * least, contacts, kRoomAlong);
  };
  for (const std::size_t i : around)
    for (const CellBoundary& side : diagram.boundary(i)) {
      const auto j = static_cast<std::size_t>(side.neighbor);
      if (j > i || (j < i && !is_around(j))) keep(i, j, -side.offset);
    }
  for (const Stranger& pair : strangers) {
    const auto i = static_cast<std::size_t>(pair.i), j = static_cast<std::size_t>(pair.j);
    if (is_around(i) || is_around(j)) keep(i, j, pair.offset);
  }
  return contacts;
}

const ClosePair* worst_pair(const Repulsion& repulsion) {
  const auto worst = std::max_element(
      repulsion.pairs.begin(), repulsion.pairs.end(),
      [](const ClosePair& a, const ClosePair& b) { return a.overlap < b.overlap; });
  return worst == repulsion.pairs.end() ? nullptr : &*worst;
}

double worst_overlap(const Repulsion& repulsion) {
  const ClosePair* worst = worst_pair(repulsion);
  return worst ? worst->overlap : 0.0;
}

}  // namespace dapple
