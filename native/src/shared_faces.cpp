// SPDX-License-Identifier: GPL-3.0-or-later
#include "shared_faces.hpp"

#include <algorithm>
#include <iterator>

#include "parallel.hpp"

namespace dapple {
namespace {

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
      : surface_(surface), orphans_(orphans), divide_(divide), owners_(surface.face_count()) {
    for (const Coverage& piece : pieces)
      owners_[static_cast<std::size_t>(piece.face)].push_back(piece.site);
    for (SiteSet& owners : owners_) make_set(owners);
    known_.resize(orphans.size());
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
      add_neighbours(orphans_[active[k]], next);
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    return next;
  }

  /// The owners of an orphan after its neighbours' owners have competed for it too.
  SiteSet hear(std::size_t k) {
    SiteSet told;
    for_each_neighbour(orphans_[k], [&](std::int32_t face) {
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
    fresh.insert(fresh.end(), current.begin(), current.end());
    make_set(fresh);
    return divide_(orphans_[k], fresh);
  }

  void add_neighbours(std::int32_t face, std::vector<std::size_t>& next) const {
    for_each_neighbour(face, [&](std::int32_t neighbour) {
      const auto found = std::lower_bound(orphans_.begin(), orphans_.end(), neighbour);
      if (found != orphans_.end() && *found == neighbour)
        next.push_back(static_cast<std::size_t>(found - orphans_.begin()));
    });
  }

  template <typename Visit>
  void for_each_neighbour(std::int32_t face, const Visit& visit) const {
    for (std::int32_t h = 3 * face; h < 3 * face + 3; ++h)
      for (std::int32_t g = surface_.next_around(h); g != h; g = surface_.next_around(g))
        visit(g / 3);
  }

  [[nodiscard]] const SiteSet& owners_of(std::int32_t face) const {
    return owners_[static_cast<std::size_t>(face)];
  }

  const Surface& surface_;
  std::span<const std::int32_t> orphans_;
  const Divide& divide_;
  std::vector<SiteSet> owners_;  // per face
  std::vector<SiteSet> known_;   // per orphan: all that have ever competed for it
};

}  // namespace

std::vector<std::int32_t> find_orphans(const Surface& surface, std::span<const Coverage> pieces) {
  std::vector<double> missing(surface.face_count());
  std::vector<bool> reached(surface.face_count(), false);
  for (std::size_t f = 0; f < missing.size(); ++f)
    missing[f] = surface.geometry(static_cast<std::int32_t>(f)).moments.area;
  for (const Coverage& piece : pieces) {
    missing[static_cast<std::size_t>(piece.face)] -= piece.area;
    reached[static_cast<std::size_t>(piece.face)] = true;
  }
  std::vector<std::int32_t> orphans;
  for (std::size_t f = 0; f < missing.size(); ++f) {
    const auto face = static_cast<std::int32_t>(f);
    // A face without area that nobody reached is one too: what is owned must spread across it.
    if (!reached[f] || missing[f] > kUncovered * surface.geometry(face).moments.area)
      orphans.push_back(face);
  }
  return orphans;
}

std::vector<Share> share_orphans(const Surface& surface, std::span<const Coverage> pieces,
                                 std::span<const std::int32_t> orphans, const Divide& divide) {
  return Spreading(surface, pieces, orphans, divide).run();
}

}  // namespace dapple
