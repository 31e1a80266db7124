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

using SiteSet = std::vector<std::int32_t>;  // sorted, each once

void make_set(SiteSet& sites) {
  std::sort(sites.begin(), sites.end());
  sites.erase(std::unique(sites.begin(), sites.end()), sites.end());
}

class Spreading {
 public:
  Spreading(const Surface& surface, std::span<const Coverage> pieces,
            std::span<const std::int32_t> orphans, const Divide& divide)
      : surface_(surface),
        orphans_(orphans),
        divide_(divide),
        orphan_of_(surface.face_count(), kNone),
        owners_(surface.face_count()),
        sure_(orphans.size()),
        known_(orphans.size()) {
    for (std::size_t k = 0; k < orphans.size(); ++k)
      orphan_of_[static_cast<std::size_t>(orphans[k])] = static_cast<std::int32_t>(k);
    const std::vector<bool> looked_at = orphans_and_neighbors();
    for (const Coverage& piece : pieces) {
      const auto face = static_cast<std::size_t>(piece.face);
      if (!looked_at[face]) continue;
      owners_[face].push_back(piece.site);
      if (orphan_of_[face] != kNone && piece.area > 0.0)
        sure_[static_cast<std::size_t>(orphan_of_[face])].push_back(piece.site);
    }
    for (SiteSet& owners : owners_) make_set(owners);
    for (SiteSet& sure : sure_) make_set(sure);
  }

  std::vector<Share> run() {
    for (std::size_t k = 0; k < orphans_.size(); ++k) known_[k] = owners_of(orphans_[k]);
    std::vector<std::size_t> active(orphans_.size());
    for (std::size_t k = 0; k < active.size(); ++k) active[k] = k;
    while (!active.empty()) active = round(active);
    std::vector<Share> shares;
    for (const std::int32_t face : orphans_)
      for (const std::int32_t site : owners_of(face)) shares.push_back({site, face});
    std::sort(shares.begin(), shares.end());
    return shares;
  }

 private:
  /// All active orphans look at the state before the round, so that their order plays no part.
  std::vector<std::size_t> round(const std::vector<std::size_t>& active) {
    std::vector<SiteSet> owners(active.size());
    parallel_chunks(active.size(), 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) owners[k] = hear(active[k]);
    });
    std::vector<std::size_t> next;
    for (std::size_t k = 0; k < active.size(); ++k) {
      SiteSet& current = owners_[static_cast<std::size_t>(orphans_[active[k]])];
      if (owners[k] == current) continue;
      current = std::move(owners[k]);
      add_neighbors(orphans_[active[k]], next);
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    return next;
  }

  /// The owners of an orphan after its neighbors' owners have competed for it too.
  SiteSet hear(std::size_t k) {
    SiteSet told;
    for_each_neighbor(orphans_[k], [&](std::int32_t face) {
      const SiteSet& owners = owners_of(face);
      told.insert(told.end(), owners.begin(), owners.end());
    });
    make_set(told);
    SiteSet fresh;
    std::set_difference(told.begin(), told.end(), known_[k].begin(), known_[k].end(),
                        std::back_inserter(fresh));
    const SiteSet& current = owners_of(orphans_[k]);
    if (fresh.empty()) return current;
    known_[k].insert(known_[k].end(), fresh.begin(), fresh.end());
    make_set(known_[k]);
    SiteSet rivals = joined(fresh, current), asked;
    std::set_difference(rivals.begin(), rivals.end(), sure_[k].begin(), sure_[k].end(),
                        std::back_inserter(asked));
    return joined(divide_(orphans_[k], asked, rivals), sure_[k]);
  }

  static SiteSet joined(const SiteSet& a, const SiteSet& b) {
    SiteSet result;
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
    return result;
  }

  void add_neighbors(std::int32_t face, std::vector<std::size_t>& next) const {
    for_each_neighbor(face, [&](std::int32_t neighbor) {
      const std::int32_t orphan = orphan_of_[static_cast<std::size_t>(neighbor)];
      if (orphan != kNone) next.push_back(static_cast<std::size_t>(orphan));
    });
  }

  [[nodiscard]] std::vector<bool> orphans_and_neighbors() const {
    std::vector<bool> result(surface_.face_count(), false);
    for (const std::int32_t face : orphans_) {
      result[static_cast<std::size_t>(face)] = true;
      for_each_neighbor(
          face, [&](std::int32_t other) { result[static_cast<std::size_t>(other)] = true; });
    }
    return result;
  }

  template <typename Visit>
  void for_each_neighbor(std::int32_t face, const Visit& visit) const {
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h)
      for (std::int32_t g = surface_.ordered().next_around(h); g != h;
           g = surface_.ordered().next_around(g))
        visit(g / 3);
  }

  [[nodiscard]] const SiteSet& owners_of(std::int32_t face) const {
    return owners_[static_cast<std::size_t>(face)];
  }

  const Surface& surface_;
  std::span<const std::int32_t> orphans_;
  const Divide& divide_;
  std::vector<std::int32_t> orphan_of_;  // per face: its place among the orphans, or kNone
  std::vector<SiteSet> owners_;          // per face, of orphans and their neighbors
  std::vector<SiteSet> sure_;            // per orphan: those whose floods found an area of it
  std::vector<SiteSet> known_;           // per orphan: all that have ever competed for it
};

}  // namespace

std::vector<std::int32_t> find_orphans(const Surface& surface, std::span<const Coverage> pieces) {
  std::vector<double> missing(surface.face_count());
  std::vector<bool> reached(surface.face_count(), false);
  for (std::size_t f = 0; f < missing.size(); ++f)
    missing[f] = surface.ordered().geometry(static_cast<std::int32_t>(f)).moments.area;
  for (const Coverage& piece : pieces) {
    missing[static_cast<std::size_t>(piece.face)] -= piece.area;
    reached[static_cast<std::size_t>(piece.face)] = true;
  }
  std::vector<std::int32_t> orphans;
  for (std::size_t f = 0; f < missing.size(); ++f) {
    const auto face = static_cast<std::int32_t>(f);
    // A face without area that nobody reached is one too: what is owned must spread across it.
    if (!reached[f] || missing[f] > kUncovered * surface.ordered().geometry(face).moments.area)
      orphans.push_back(face);
  }
  return orphans;
}

std::vector<Share> share_orphans(const Surface& surface, std::span<const Coverage> pieces,
                                 std::span<const std::int32_t> orphans, const Divide& divide) {
  return Spreading(surface, pieces, orphans, divide).run();
}

}  // namespace dapple
