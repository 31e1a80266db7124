// SPDX-License-Identifier: GPL-3.0-or-later
#include "plane/flat_sites.hpp"

#include <tuple>

#include "base/morton.hpp"
#include "base/vectors.hpp"

namespace dapple {
namespace {

constexpr int kBits = 31;  // per axis

/// Put a zero bit between the bits of v.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffffu;
  v = (v | v << 8) & 0x00ff00ff00ff00ffu;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fu;
  v = (v | v << 2) & 0x3333333333333333u;
  v = (v | v << 1) & 0x5555555555555555u;
  return v;
}

struct Key {
  std::uint64_t code;
  std::int32_t site;
};

/// The sites along the curve; coincident sites are adjacent, in their original order.
std::vector<Key> along_curve(std::span<const Vec3> x) {
  Eigen::AlignedBox2d box;
  for (const Vec3& p : x) box.extend(p.head<2>());
  const double most = double((std::int64_t{1} << kBits) - 1);
  const double scale = x.empty() ? 0.0 : most / std::max(box.sizes().maxCoeff(), 1e-300);
  std::vector<Key> keys(x.size());
  for_each_vector(x.size(), [&](std::size_t k) {
    const Vec2 along = scale * (x[k].head<2>() - box.min());
    keys[k] = {spread(cell_along(along.x(), most)) | spread(cell_along(along.y(), most)) << 1,
               static_cast<std::int32_t>(k)};
  });
  parallel_sort(keys, [&](const Key& a, const Key& b) {
    if (a.code != b.code) return a.code < b.code;
    const Vec3& p = x[static_cast<std::size_t>(a.site)];
    const Vec3& q = x[static_cast<std::size_t>(b.site)];
    return std::tuple(p.x(), p.y(), a.site) < std::tuple(q.x(), q.y(), b.site);
  });
  return keys;
}

}  // namespace

FlatSites::FlatSites(std::span<const Vec3> sites, bool periodic) : periodic_(periodic) {
  places_.reserve(sites.size());
  sites_.reserve(sites.size());
  for (const Key& key : along_curve(sites)) {
    const Vec3& p = sites[static_cast<std::size_t>(key.site)];
    if (!places_.empty() && p.head<2>() == places_.back().head<2>()) {
      twins_.push_back({key.site, sites_.back()});
      continue;
    }
    places_.emplace_back(p.x(), p.y(), 0.0);
    sites_.push_back(key.site);
  }
  boxes_ = SiteBoxes(places_);
}

}  // namespace dapple
