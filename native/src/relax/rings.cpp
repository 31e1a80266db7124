// SPDX-License-Identifier: GPL-3.0-or-later
#include "relax/rings.hpp"

#include <algorithm>
#include <unordered_set>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 32;  // cells or faces per chunk
constexpr std::size_t kFew = 512;   // faces or sites between two checks

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Rings::Rings(const Surface& surface, const Sites& sites)
    : surface_(surface),
      sites_(surface, sites),
      index_(sites_),
      ordered_(sites.size()),
      floods_([this] { return CellFlood(surface_, sites_, index_); }) {
  for (std::size_t k = 0; k < ordered_.size(); ++k)
    ordered_[static_cast<std::size_t>(sites_.originals[k])] = static_cast<std::int32_t>(k);
}

// The search proceeds from cell to cell: neighbors of a cell with a part of the faces may have a
// part too.
std::vector<std::int32_t> Rings::owners(std::span<const OrderedFace> faces,
                                        const Context* context) {
  const auto is_one = [&](OrderedFace face) {
    return std::binary_search(faces.begin(), faces.end(), face);
  };
  std::vector<std::int32_t> result = on_or_near(faces), pending = result;
  std::unordered_set<std::int32_t> seen(result.begin(), result.end());
  while (!pending.empty()) {
    find(pending, context);
    std::vector<std::int32_t> next;
    for (const std::int32_t site : pending)
      for (const std::int32_t other : cells_.at(site).neighbors)
        if (seen.insert(other).second) next.push_back(other);
    find(next, context);
    std::erase_if(next, [&](std::int32_t site) {
      const std::vector<OrderedFace>& mine = cells_.at(site).faces;
      return std::none_of(mine.begin(), mine.end(), is_one);
    });
    append(result, next);
    pending = std::move(next);
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// The sites on the faces; for a face without sites, the site nearest to its centroid.
std::vector<std::int32_t> Rings::on_or_near(std::span<const OrderedFace> faces) const {
  std::vector<std::int32_t> result;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_at(f, kFew);
    const OrderedFace face = faces[f];
    const auto [first, last] = std::equal_range(sites_.faces.begin(), sites_.faces.end(), face);
    const auto place = static_cast<std::int32_t>(first - sites_.faces.begin());
    if (first == last)
      result.push_back(
          index_.nearest(surface_.ordered().geometry(face).centroid,
                         std::min(place, static_cast<std::int32_t>(sites_.size()) - 1)));
    for (std::int32_t k = 0; k < last - first; ++k) result.push_back(place + k);
  }
  for (std::int32_t& site : result) site = sites_.original(site);
  sort_unique(result);
  return result;
}

std::vector<std::int32_t> Rings::grown(std::span<const std::int32_t> sites,
                                       const Context* context) {
  find(sites, context);
  std::vector<std::int32_t> result(sites.begin(), sites.end());
  for (std::size_t k = 0; k < sites.size(); ++k)
    check_at(k, kFew), append(result, cells_.at(sites[k]).neighbors);
  sort_unique(result);
  return result;
}

std::vector<OrderedFace> Rings::faces(std::span<const std::int32_t> sites, const Context* context) {
  find(sites, context);
  std::vector<OrderedFace> result;
  for (std::size_t k = 0; k < sites.size(); ++k)
    check_at(k, kFew), append(result, cells_.at(sites[k]).faces);
  sort_unique(result);
  return result;
}

void Rings::find(std::span<const std::int32_t> sites, const Context* context) {
  std::vector<std::int32_t> missing;
  for (const std::int32_t site : sites)
    if (!cells_.contains(site)) missing.push_back(site);
  std::sort(missing.begin(), missing.end(),  // nearby ones share a search
            [this](std::int32_t a, std::int32_t b) { return ordered(a) < ordered(b); });
  std::vector<Cell> found(missing.size());
  parallel_chunks(missing.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (context) context->check();
    for (std::size_t k = begin; k < end; ++k) found[k] = find_cell(floods_.local(), missing[k]);
  });
  for (std::size_t k = 0; k < missing.size(); ++k)
    check_at(k, kFew), cells_.emplace(missing[k], std::move(found[k]));
}

/// A site that coincides with another one has that site as its neighbor.
Rings::Cell Rings::find_cell(CellFlood& flood, std::int32_t original) const {
  const std::int32_t site = ordered(original);
  const OrderedFace start = sites_.faces[static_cast<std::size_t>(site)];
  if (!flood.reset(site, Rivals::kInSight)) return {{sites_.original(flood.owner())}, {start}};
  Cell cell;
  flood.flood({&start, 1}, [&](OrderedFace face, bool whole) {
    cell.faces.push_back(face);
    if (whole) return;
    for (const Polygon::Corner& corner : flood.polygon().corners())
      if (corner.edge >= 0)
        cell.neighbors.push_back(sites_.original(flood.bisector(corner.edge).site));
  });
  sort_unique(cell.neighbors);
  return cell;
}

}  // namespace dapple
