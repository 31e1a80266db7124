// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/morton.hpp"

#include <algorithm>
#include <utility>

#include "base/parallel.hpp"
#include "base/progress.hpp"

namespace dapple {
namespace {

constexpr int kBits = 21;  // per axis, 63 in total
constexpr std::size_t kGrain = 4096;

/// Put two zero bits between the 21 bits of v.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffu;
  v = (v | v << 16) & 0x001f0000ff0000ffu;
  v = (v | v << 8) & 0x100f00f00f00f00fu;
  v = (v | v << 4) & 0x10c30c30c30c30c3u;
  v = (v | v << 2) & 0x1249249249249249u;
  return v;
}

std::uint64_t code(const Vec3& unit) {
  constexpr double kMost = (1 << kBits) - 1;
  const Vec3 along = kMost * unit;
  return spread(cell_along(along.x(), kMost)) | spread(cell_along(along.y(), kMost)) << 1 |
         spread(cell_along(along.z(), kMost)) << 2;
}

using Key = std::pair<std::uint64_t, std::int32_t>;

void sort(std::vector<Key>& keys, Context* context) {
  if (context && !Poll::current()) return sort_watched(keys, context);
  parallel_sort(keys);
}

}  // namespace

std::vector<std::int32_t> morton_order(std::span<const Vec3> points, Context* context) {
  if (points.empty()) return {};
  Vec3 low = points[0];
  Vec3 high = points[0];
  for (std::size_t k = 0; k < points.size(); ++k) {
    check_at(k, 65536);
    low = low.cwiseMin(points[k]);
    high = high.cwiseMax(points[k]);
  }
  const double extent = std::max((high - low).maxCoeff(), 1e-300);
  std::vector<Key> keys(points.size());
  Stretch coding(context, 0.0, 0.3), sorting(context, 0.3, 1.0);
  Tally tally(coding.context(), points.size());
  parallel_chunks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    tally.check();
    for (std::size_t k = begin; k < end; ++k)
      keys[k] = {code((points[k] - low) / extent), static_cast<std::int32_t>(k)};
    tally.add(end - begin);
  });
  sort(keys, sorting.context());
  std::vector<std::int32_t> order(points.size());
  parallel_chunks(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) order[k] = keys[k].second;
  });
  return order;
}

}  // namespace dapple
