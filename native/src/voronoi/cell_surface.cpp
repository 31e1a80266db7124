// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_surface.hpp"

#include <algorithm>
#include <bit>

namespace dapple {

namespace {

/// The value of a map at a key, created if missing. The mutex guards the map but is not held while
/// a value is created, because a Poll may need the same value. The value stored first is used.
template <typename Map, typename Make>
typename Map::mapped_type made_once(std::mutex& mutex, Map& map, const typename Map::key_type& key,
                                    const Make& make) {
  {
    const std::scoped_lock lock(mutex);
    if (const auto known = map.find(key); known != map.end()) return known->second;
  }
  const typename Map::mapped_type made = make();
  const std::scoped_lock lock(mutex);
  return map.try_emplace(key, made).first->second;
}

std::shared_ptr<const SidedSurface> find_sides(const Surface& surface, std::size_t count,
                                               Cells cells, Context* context) {
  return cells == Cells::kConnected ? with_sides(surface, count, context) : nullptr;
}

}  // namespace

KnownSides sides_for(const Surface& surface, std::size_t count, Cells cells, Context* context) {
  return find_sides(surface, count, cells, context);
}

CellSurface cell_surface(const Surface& surface, std::size_t count, Cells cells, Context* context) {
  return CellSurfaces(cells).at(surface, count, context);
}

std::shared_ptr<const SidedSurface> CellSurfaces::sides_of(const Surface& surface,
                                                           std::size_t count,
                                                           Context* context) const {
  if (!known_) return find_sides(surface, count, cells_, context);
  return *known_ ? with_sides_of(**known_, surface) : nullptr;
}

std::shared_ptr<const SidedSurface> CellSurfaces::known(const Surface& surface) {
  if (!known_ || !*known_) return nullptr;
  return made_once(mutex_, sided_, 0, [&] { return sides_of(surface, 0, nullptr); });
}

CellSurface CellSurfaces::at(const Surface& surface, std::size_t count, Context* context) {
  const auto order = static_cast<int>(std::bit_width(std::max<std::size_t>(count, 1)));
  CellSurface result;
  // Known components do not depend on the count.
  result.sided = made_once(mutex_, sided_, known_ ? 0 : count,
                           [&] { return sides_of(surface, count, nullptr); });
  result.cut = made_once(mutex_, cut_, {order, result.sided.get()},
                         [&] { return cut_for(result.uncut(surface), count, context); });
  return result;
}

}  // namespace dapple
