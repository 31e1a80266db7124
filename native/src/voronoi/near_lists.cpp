// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/near_lists.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

#include "base/parallel.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFar = 1e150;           // a coordinate of no site; its square is finite
constexpr double kMargin = 1.0 + 1e-12;  // for the rounding of distances
constexpr double kSlack = 0.1;           // spacings that a site may move before lists are made anew
constexpr std::size_t kFewNear = 8;      // a list with fewer sites reaches further
constexpr std::size_t kUsual = 7;        // the site that lists should reach
constexpr std::size_t kListGrain = 256;  // lists per chunk

/// The squared distances of eight places from a point, and a bit for each that is not above a
/// limit.
unsigned measure_eight(const Eight& places, const Triple& point, double limit, double* squared) {
  unsigned bits = 0;
#if defined(__x86_64__)
  const __m128d x = _mm_set1_pd(point.x), y = _mm_set1_pd(point.y), z = _mm_set1_pd(point.z);
  for (std::size_t k = 0; k < 8; k += 2) {
    const __m128d dx = _mm_sub_pd(x, _mm_load_pd(&places[0][k]));
    const __m128d dy = _mm_sub_pd(y, _mm_load_pd(&places[1][k]));
    const __m128d dz = _mm_sub_pd(z, _mm_load_pd(&places[2][k]));
    const __m128d sum =
        _mm_add_pd(_mm_add_pd(_mm_mul_pd(dx, dx), _mm_mul_pd(dy, dy)), _mm_mul_pd(dz, dz));
    _mm_storeu_pd(squared + k, sum);
    const int below = _mm_movemask_pd(_mm_cmple_pd(sum, _mm_set1_pd(limit)));
    bits |= static_cast<unsigned>(below) << k;
  }
#else
  for (std::size_t k = 0; k < 8; ++k) {
    squared[k] = (point - Triple(places[0][k], places[1][k], places[2][k])).squared_norm();
    bits |= (squared[k] <= limit ? 1U : 0U) << k;
  }
#endif
  return bits;
}

/// Where the ray r + t * along, in the cell of 0, meets the bisector with the site at d.
double exit_through(const Triple& d, const Triple& r, const Triple& along) {
  const double ahead = along.x * d.x + along.y * d.y + along.z * d.z;
  const double offset =
      0.5 * (d.x * d.x + d.y * d.y + d.z * d.z) - (r.x * d.x + r.y * d.y + r.z * d.z);
  return ahead > 0.0 ? offset / ahead : kInfinity;
}

}  // namespace

NearLists::NearLists(const Surface& surface, const OrderedSites& sites, const SiteIndex& index)
    : surface_(&surface),
      sites_(&sites),
      index_(&index),
      searches_([this] { return NearSites(*index_, surface_->spacing(sites_->size())); }) {}

void NearLists::List::put(std::size_t k, const Triple& place, std::int32_t site) {
  Eight& block = places[k / kBlock];
  block[0][k % kBlock] = place.x;
  block[1][k % kBlock] = place.y;
  block[2][k % kBlock] = place.z;
  sites[k] = site;
}

/// Note the nearest of each block.
void NearLists::List::measure(const Triple& from) {
  nearest.fill(kInfinity);
  for (std::size_t k = 0; k < count; ++k)
    nearest[k / kBlock] = std::min(nearest[k / kBlock], (place(k) - from).squared_norm());
}

void NearLists::make(bool by_component) {
  const std::size_t count = sites_->size();
  const OrderedSurface& mesh = surface_->ordered();
  made_ = were_moved_ = false;
  components_.clear();
  if (by_component && mesh.components() > 1) {
    components_.resize(count);
    site_on_.assign(static_cast<std::size_t>(mesh.components()), -1);
    for (std::size_t k = 0; k < count; ++k) {
      components_[k] = mesh.component(sites_->faces[k]);
      site_on_[as_index(components_[k])] = static_cast<std::int32_t>(k);
    }
  }
  lists_.resize(count);
  leaders_.resize(count);
  complete_.resize(count);
  made_at_.assign(sites_->positions.begin(), sites_->positions.end());
  const double spacing = surface_->spacing(count);
  for (NearSites<SiteIndex>& search : searches_) search.restart(spacing);
  const std::span<const std::int32_t> order = index_->by_neighborhood();
  parallel_chunks(count, kListGrain, [&](std::size_t begin, std::size_t end) {
    NearSites<SiteIndex>& near = searches_.local();
    for (std::size_t k = begin; k < end; ++k) {
      const std::int32_t site = order.empty() ? static_cast<std::int32_t>(k) : order[k];
      fill(lists_[as_index(site)], site, near);
    }
  });
  alone_ = !index_->has_crowds();
  for (std::size_t k = 0; k < count && alone_; ++k)
    alone_ = leaders_[k] == static_cast<std::int32_t>(k);
  made_ = true;
}

void NearLists::fill(List& list, std::int32_t site, NearSites<SiteIndex>& near) {
  near.turn_to(site);
  while (near.within_reach() < kFewNear && !near.is_complete()) near.extend();
  const std::span<const Rival> all = near.all();
  list.count = 0;
  list.complete = near.within_reach() > all.size() ? all.back().squared_distance
                  : near.is_complete()             ? kInfinity
                                                   : near.squared_reach();
  std::int32_t leader = site;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::int32_t other = all[k].site;
    if (!compete(site, other)) continue;
    if (all[k].squared_distance == 0.0) {
      if (precedes(other, leader)) leader = other;
      continue;
    }
    if (list.count == kMost) {
      list.complete = all[k].squared_distance;
      break;
    }
    const Triple place(sites_->position(other));
    bool twin = false;  // the first of several at one place is in the list already
    for (std::size_t p = list.count; p > 0 && !twin; --p)
      twin = sites_->position(list.sites[p - 1]) == sites_->position(other);
    if (!twin) list.put(list.count++, place, other);
  }
  for (std::size_t k = list.count; k < kMost; ++k) list.put(k, {kFar, kFar, kFar}, -1);
  list.measure(Triple(sites_->position(site)));
  leaders_[as_index(site)] = leader;
  complete_[as_index(site)] = std::sqrt(list.complete);
  near.note_need(all.empty() ? near.squared_reach()
                             : all[std::min(kUsual, all.size() - 1)].squared_distance);
}

bool NearLists::hold_for(const Sites& sites, bool by_component) {
  if (!made_ || !alone_ || sites.size() != lists_.size()) return false;
  const OrderedSurface& mesh = surface_->ordered();
  if ((by_component && mesh.components() > 1) != !components_.empty()) return false;
  if (!components_.empty())
    for (std::size_t k = 0; k < components_.size(); ++k)
      if (mesh.component(mesh.counted_face(sites.faces[as_index(sites_->originals[k])])) !=
          components_[k])
        return false;
  moved_ = largest_move(sites);
  return moved_ <= kSlack * surface_->spacing(sites.size());
}

double NearLists::largest_move(const Sites& sites) const {
  double squared = 0.0;
  for (std::size_t k = 0; k < made_at_.size(); ++k)
    squared = std::max(
        squared, (Triple(sites.positions[as_index(sites_->originals[k])]) - Triple(made_at_[k]))
                     .squared_norm());
  return std::sqrt(squared);
}

void NearLists::move() {
  were_moved_ = true;
  parallel_chunks(lists_.size(), kListGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      List& list = lists_[k];
      for (std::size_t n = 0; n < list.count; ++n)
        list.put(n, Triple(sites_->position(list.sites[n])), list.sites[n]);
      list.measure(Triple(sites_->positions[k]));
      const double reach = std::max(0.0, complete_[k] / kMargin - 2.0 * kMargin * moved_);
      list.complete = reach * reach;
    }
  });
}

NearLists::Nearest NearLists::nearest(const Triple& point, std::int32_t from) const {
  Nearest best{leader(from), squared_distance(leader(from), point)};
  std::array<double, kBlock> squared;
  for (;;) {
    const List& list = lists_[as_index(best.site)];
    const double needed = 4.0 * kMargin * best.squared_distance;
    Nearest next = best;
    for (std::size_t b = 0; b < kBlocks; ++b) {
      if (list.nearest[b] > needed) continue;
      unsigned bits = measure_eight(list.places[b], point, next.squared_distance, squared.data());
      for (; bits != 0; bits &= bits - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(bits));
        const std::int32_t site = list.sites[kBlock * b + k];
        if (squared[k] < next.squared_distance ||
            (squared[k] == next.squared_distance && precedes(site, next.site)))
          next = {site, squared[k]};
      }
    }
    if (next.site == best.site) return needed <= list.complete ? best : search(point, best.site);
    best = next;
  }
}

NearLists::Nearest NearLists::search(const Triple& point, std::int32_t from) const {
  Nearest best{leader(from), squared_distance(leader(from), point)};
  const auto take = [&](std::int32_t site) {
    const double squared = squared_distance(site, point);
    if (squared < best.squared_distance ||
        (squared == best.squared_distance && precedes(site, best.site)))
      best = {site, squared};
  };
  const std::int32_t close =
      index_->nearest_of({point.x, point.y, point.z}, kMargin * best.squared_distance,
                         [&](std::int32_t site) { return compete(from, site); });
  if (close >= 0) take(leader(close));
  search_around(point, best.squared_distance, from, take);
  return best;
}

std::int32_t NearLists::nearer(const Triple& point, double squared, std::int32_t i, std::int32_t j,
                               std::int32_t k) const {
  double limit = squared * (1.0 - 1e-12);
  std::int32_t found = -1;
  const auto take = [&](std::int32_t site, double distance) {
    if (site == i || site == j || site == k) return;
    if (!(distance < limit || (distance == limit && found >= 0 && precedes(site, found)))) return;
    limit = distance;
    found = site;
  };
  const List& list = lists_[as_index(i)];
  if (4.0 * kMargin * squared > list.complete) {
    search_around(point, squared, i,
                  [&](std::int32_t site) { take(site, squared_distance(site, point)); });
    return found;
  }
  std::array<double, kBlock> distances;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    if (list.nearest[b] > 4.0 * squared) continue;
    unsigned bits = measure_eight(list.places[b], point, limit, distances.data());
    for (; bits != 0; bits &= bits - 1) {
      const auto n = static_cast<std::size_t>(std::countr_zero(bits));
      take(list.sites[kBlock * b + n], distances[n]);
    }
  }
  return found;
}

/// The exits through the bisectors with a block of near sites.
void NearLists::take_exits(const List& list, std::size_t block, const Triple& x, const Triple& r,
                           const Triple& along, std::int32_t other, Exit& exit) const {
  std::array<double, kBlock> t;
  const Eight& places = list.places[block];
  const std::int32_t* const sites = list.sites.data() + kBlock * block;
  double least = kInfinity;
  for (std::size_t k = 0; k < kBlock; ++k) {
    t[k] = exit_through({places[0][k] - x.x, places[1][k] - x.y, places[2][k] - x.z}, r, along);
    t[k] = sites[k] == other || sites[k] < 0 ? kInfinity : t[k];
  }
  for (std::size_t k = 0; k < kBlock; ++k) least = std::min(least, t[k]);
  if (!(least <= exit.t)) return;
  for (std::size_t k = 0; k < kBlock; ++k)
    if (t[k] == least && (least < exit.t || (exit.site >= 0 && precedes(sites[k], exit.site))))
      exit = {least, sites[k]};
}

NearLists::Exit NearLists::exit(std::int32_t site, const Triple& start, const Triple& along,
                                double first, double last, std::int32_t other) const {
  const List& list = lists_[as_index(site)];
  const Triple x(sites_->position(site)), r = start - x;
  Exit exit{last, -1};
  const double entry = (r + first * along).squared_norm();
  double reach = kInfinity;  // of a bisector that could be met earlier
  for (std::size_t b = 0; b < kBlocks && kBlock * b < list.count; ++b) {
    if (list.nearest[b] > 4.0 * kMargin * reach) continue;
    take_exits(list, b, x, r, along, other, exit);
    reach = std::max(entry, (r + std::max(first, exit.t) * along).squared_norm());
  }
  if (!(4.0 * kMargin * reach > list.complete)) return exit;
  reach = std::max(entry, (r + std::max(first, exit.t) * along).squared_norm());
  search_around(x, 4.0 * reach, site, [&](std::int32_t beyond) {
    if (beyond == site || beyond == other) return;
    const double t = exit_through(Triple(sites_->position(beyond)) - x, r, along);
    if (t < exit.t || (t == exit.t && exit.site >= 0 && precedes(beyond, exit.site)))
      exit = {t, beyond};
  });
  return exit;
}

void NearLists::near_rivals(std::int32_t site, std::vector<Rival>& rivals) const {
  const List& list = lists_[as_index(site)];
  const Triple x(sites_->position(site));
  rivals.clear();
  for (std::size_t k = 0; k < list.count; ++k) {
    const double squared = squared_distance(list.sites[k], x);
    if (squared < list.complete)
      rivals.push_back({squared, sites_->original(list.sites[k]), list.sites[k]});
  }
  std::sort(rivals.begin(), rivals.end());
}

void NearLists::far_rivals(std::int32_t site, double limit, std::vector<Rival>& rivals) const {
  const double from = known_reach(site);
  const Triple x(sites_->position(site));
  rivals.clear();
  search_around(x, limit, site, [&](std::int32_t other) {
    const double squared = squared_distance(other, x);
    if (other != site && squared >= from && squared > 0.0)
      rivals.push_back({squared, sites_->original(other), other});
  });
  std::sort(rivals.begin(), rivals.end());
}

}  // namespace dapple
