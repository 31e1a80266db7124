// SPDX-License-Identifier: GPL-3.0-or-later
#include "rebalance/widest_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <limits>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "start/dart_board.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kDraws = 12.0;   // random points per site
constexpr std::size_t kMore = 8;  // factor if these are too few
constexpr std::size_t kMost = 1 << 21;
constexpr std::size_t kFew = 1 << 16;   // points: cheap up to this number
constexpr std::size_t kCandidates = 4;  // nearest sites tested for being on the same side of a wall
constexpr double kReach = 1.5;          // of the gap: range in which a new site matters
constexpr std::size_t kGrain = 256;     // points
constexpr std::size_t kNone = ~std::size_t{0};

/// A candidate position.
struct Place {
  Dart dart;
  double squared_distance;  // from the nearest site
  [[nodiscard]] double room() const { return squared_distance * dart.density; }
};

std::vector<Vec3> positions_of(const std::vector<Place>& places) {
  std::vector<Vec3> result;
  result.reserve(places.size());
  for (const Place& place : places) result.push_back(place.dart.position);
  return result;
}

/// Random points in the cells of open sites.
std::vector<Place> draw_places(const Surface& surface, const Gaps& gaps, std::size_t draws,
                               std::uint64_t seed, const Context* context) {
  Random random(seed);
  const DartBoard board(surface, draws);
  std::vector<Dart> darts(draws), sites(gaps.sites.size());
  std::vector<DartBoard::Draw> drawn(draws);
  for (DartBoard::Draw& draw : drawn) draw = board.draw(random);
  for (std::size_t k = 0; k < sites.size(); ++k)
    sites[k] = dart_at(surface, surface.ordered().ordered_face(gaps.sites.faces[k]),
                       gaps.sites.barycentric[k]);
  const Neighbors tree(gaps.sites.positions);
  std::vector<double> distances(draws, -1.0);
  parallel_chunks(draws, kGrain, [&](std::size_t begin, std::size_t end) {
    if (context) context->check();
    std::vector<Neighbor> near;
    for (std::size_t k = begin; k < end; ++k) {
      darts[k] = dart_at(surface, drawn[k].face, drawn[k].weights);
      const auto sees = [&](const Neighbor& n) {
        return see_each_other(darts[k], sites[static_cast<std::size_t>(n.index)]);
      };
      tree.nearest(darts[k].position, 1, near);
      if (!sees(near.front())) tree.nearest(darts[k].position, kCandidates, near);
      const auto first = std::find_if(near.begin(), near.end(), sees);
      // If all of them are on the other side, sites on the point's side are farther away.
      const Neighbor& nearest = first != near.end() ? *first : near.back();
      if (gaps.open[static_cast<std::size_t>(nearest.index)])
        distances[k] = nearest.squared_distance;
    }
  });
  std::vector<Place> places;
  for (std::size_t k = 0; k < draws; ++k)
    if (distances[k] > 0.0) places.push_back({darts[k], distances[k]});
  return places;
}

/// Chooses the positions farthest from all sites, one after another.
class Filling {
 public:
  explicit Filling(std::vector<Place> places)
      : places_(std::move(places)), positions_(positions_of(places_)), tree_(positions_) {
    for (std::size_t k = 0; k < places_.size(); ++k) waiting_.push_back({places_[k].room(), k});
    std::make_heap(waiting_.begin(), waiting_.end());
  }

  /// The next position; null if none is left.
  const Dart* next() {
    const std::size_t k = widest();
    if (k == kNone) return nullptr;
    const Place taken = places_[k];
    tree_.within(taken.dart.position, kReach * std::sqrt(taken.squared_distance), near_);
    for (const Neighbor& n : near_) {
      Place& other = places_[static_cast<std::size_t>(n.index)];
      if (see_each_other(other.dart, taken.dart))
        other.squared_distance = std::min(other.squared_distance, n.squared_distance);
    }
    places_[k].squared_distance = 0.0;
    return &places_[k].dart;
  }

 private:
  /// The widest gap. Positions whose distance has decreased are inserted into the heap again.
  std::size_t widest() {
    while (!waiting_.empty()) {
      std::pop_heap(waiting_.begin(), waiting_.end());
      const auto [room, k] = waiting_.back();
      waiting_.pop_back();
      const double now = places_[k].room();
      if (now == room && now > 0.0) return k;
      if (!(now > 0.0)) continue;
      waiting_.push_back({now, k});
      std::push_heap(waiting_.begin(), waiting_.end());
    }
    return kNone;
  }

  std::vector<Place> places_;
  std::vector<Vec3> positions_;
  Neighbors tree_;
  std::vector<std::pair<double, std::size_t>> waiting_;  // a heap
  std::vector<Neighbor> near_;
};

}  // namespace

Sites widest_gaps(const Surface& surface, const Gaps& gaps, std::size_t count, std::uint64_t seed,
                  const Context* context) {
  Sites result;
  if (std::none_of(gaps.open.begin(), gaps.open.end(), [](bool open) { return open; }))
    return result;
  // The number of points is limited, because the capacity does not determine it if cells cover
  // little of the surface, as when parts without a site have no owner.
  const std::size_t most =
      std::max(kFew, kMore * static_cast<std::size_t>(kDraws) * (count + gaps.sites.size()));
  auto draws = static_cast<std::size_t>(
      std::min(std::ceil(kDraws * surface.ordered().unit_capacity() / gaps.capacity),
               static_cast<double>(most)));
  std::vector<Place> places = draw_places(surface, gaps, draws, seed, context);
  // The cells of open sites may be a small part of the surface.
  while (places.size() < count && kMore * draws <= kMost)
    places = draw_places(surface, gaps, draws *= kMore, seed, context);
  if (places.empty()) return result;
  Filling filling(std::move(places));
  while (result.size() < count) {
    check_at(context, result.size(), kGrain);
    const Dart* dart = filling.next();
    if (!dart) break;
    result.positions.push_back(dart->position);
    result.faces.push_back(surface.ordered().original_face(dart->face));
    result.barycentric.push_back(dart->barycentric);
  }
  return result;
}

}  // namespace dapple
