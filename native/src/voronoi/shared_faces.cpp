// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/shared_faces.hpp"

#include <algorithm>
#include <iterator>

#include "base/parallel.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::int32_t kNone = -1;
constexpr double kUncovered = 1e-9;  // share of a face's area that rounding cannot explain

using SiteSet = std::vector<std::int32_t>;  // sorted, without duplicates

void make_set(SiteSet& sites) {
  std::sort(sites.begin(), sites.end());
  sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
}

class Propagation {
 public:
  Propagation(const Surface& surface, std::span<const Coverage> pieces,
              std::span<const OrderedFace> uncovered, const Divide& divide)
      : surface_(surface),
        uncovered_(uncovered),
        divide_(divide),
        number_of_(surface.face_count(), kNone),
        owners_(surface.face_count()),
        sure_(uncovered.size()),
        known_(uncovered.size()) {
    for (std::size_t k = 0; k < uncovered.size(); ++k)
      number_of_[as_index(uncovered[k])] = static_cast<std::int32_t>(k);
    const std::vector<bool> looked_at = uncovered_and_neighbors();
    for (const Coverage& piece : pieces) {
      const std::size_t face = as_index(piece.face);
      if (!looked_at[face]) continue;
      owners_[face].push_back(piece.site);
      if (number_of_[face] != kNone && piece.area > 0.0)
        sure_[static_cast<std::size_t>(number_of_[face])].push_back(piece.site);
    }
    for (SiteSet& owners : owners_) make_set(owners);
    for (SiteSet& sure : sure_) make_set(sure);
  }

  std::vector<Share> run() {
    for (std::size_t k = 0; k < uncovered_.size(); ++k) known_[k] = owners_of(uncovered_[k]);
    std::vector<std::size_t> active(uncovered_.size());
    for (std::size_t k = 0; k < active.size(); ++k) active[k] = k;
    while (!active.empty()) active = round(active);
    std::vector<Share> shares;
    for (const OrderedFace face : uncovered_)
      for (const std::int32_t site : owners_of(face)) shares.push_back({site, face});
    std::sort(shares.begin(), shares.end());
    return shares;
  }

 private:
  /// All active faces use the state before the round, so that their order does not matter.
  std::vector<std::size_t> round(const std::vector<std::size_t>& active) {
    std::vector<SiteSet> owners(active.size());
    parallel_chunks(active.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) owners[k] = propagate(active[k]);
    });
    std::vector<std::size_t> next;
    for (std::size_t k = 0; k < active.size(); ++k) {
      SiteSet& current = owners_[as_index(uncovered_[active[k]])];
      if (owners[k] == current) continue;
      current = std::move(owners[k]);
      add_neighbors(uncovered_[active[k]], next);
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    return next;
  }

  /// A step of label propagation: the owners of an uncovered face after its neighbors' owners have
  /// competed for it.
  SiteSet propagate(std::size_t k) {
    SiteSet neighbors;
    for_each_neighbor(uncovered_[k], [&](OrderedFace face) {
      const SiteSet& owners = owners_of(face);
      neighbors.insert(neighbors.end(), owners.begin(), owners.end());
    });
    make_set(neighbors);
    SiteSet fresh;
    std::set_difference(neighbors.begin(), neighbors.end(), known_[k].begin(), known_[k].end(),
                        std::back_inserter(fresh));
    const SiteSet& current = owners_of(uncovered_[k]);
    if (fresh.empty()) return current;
    known_[k].insert(known_[k].end(), fresh.begin(), fresh.end());
    make_set(known_[k]);
    SiteSet rivals = joined(fresh, current), asked;
    std::set_difference(rivals.begin(), rivals.end(), sure_[k].begin(), sure_[k].end(),
                        std::back_inserter(asked));
    return joined(divide_(uncovered_[k], asked, rivals), sure_[k]);
  }

  static SiteSet joined(const SiteSet& a, const SiteSet& b) {
    SiteSet result;
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
    return result;
  }

  void add_neighbors(OrderedFace face, std::vector<std::size_t>& next) const {
    for_each_neighbor(face, [&](OrderedFace neighbor) {
      const std::int32_t number = number_of_[as_index(neighbor)];
      if (number != kNone) next.push_back(static_cast<std::size_t>(number));
    });
  }

  [[nodiscard]] std::vector<bool> uncovered_and_neighbors() const {
    std::vector<bool> result(surface_.face_count(), false);
    for (const OrderedFace face : uncovered_) {
      result[as_index(face)] = true;
      for_each_neighbor(face, [&](OrderedFace other) { result[as_index(other)] = true; });
    }
    return result;
  }

  template <typename Visit>
  void for_each_neighbor(OrderedFace face, const Visit& visit) const {
    const OrderedSurface& ordered = surface_.ordered();
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t h = half_edge(face, k);
      for (std::int32_t g = ordered.next_around(h); g != h; g = ordered.next_around(g))
        visit(face_of(g));
    }
  }

  [[nodiscard]] const SiteSet& owners_of(OrderedFace face) const { return owners_[as_index(face)]; }

  const Surface& surface_;
  std::span<const OrderedFace> uncovered_;
  const Divide& divide_;
  std::vector<std::int32_t> number_of_;  // per face: its index among the uncovered ones, or kNone
  std::vector<SiteSet> owners_;          // per uncovered face or neighbor of one
  std::vector<SiteSet> sure_;   // per uncovered face: sites whose floods found a part of it
  std::vector<SiteSet> known_;  // per uncovered face: all sites that have competed for it
};

}  // namespace

std::vector<OrderedFace> uncovered_faces(const Surface& surface, std::span<const Coverage> pieces) {
  std::vector<double> missing(surface.face_count());
  std::vector<bool> reached(surface.face_count(), false);
  for (std::size_t f = 0; f < missing.size(); ++f)
    missing[f] = surface.ordered().geometry(nth_face(f)).moments.area;
  for (const Coverage& piece : pieces) {
    missing[as_index(piece.face)] -= piece.area;
    reached[as_index(piece.face)] = true;
  }
  std::vector<OrderedFace> uncovered;
  for (std::size_t f = 0; f < missing.size(); ++f) {
    const OrderedFace face = nth_face(f);
    if (!surface.ordered().counts(face)) continue;
    // A face without area that no flood reached counts too: labels must spread across it.
    if (!reached[f] || missing[f] > kUncovered * surface.ordered().geometry(face).moments.area)
      uncovered.push_back(face);
  }
  return uncovered;
}

std::vector<Share> share_out(const Surface& surface, std::span<const Coverage> pieces,
                             std::span<const OrderedFace> uncovered, const Divide& divide) {
  return Propagation(surface, pieces, uncovered, divide).run();
}

}  // namespace dapple
