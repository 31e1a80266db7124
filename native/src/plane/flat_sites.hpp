// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voronoi/site_boxes.hpp"

namespace dapple {

/// The distinct places of sites in the plane or the torus, in the order of a Morton curve, with
/// searches for near ones. On the torus every place has nine images, in the unit square and in the
/// eight squares around it; those in the square have the lowest numbers.
class FlatSites {
 public:
  /// A site that coincides with an earlier one.
  struct Twin {
    std::int32_t site, first;
  };

  /// \param periodic whether this is the torus
  FlatSites(std::span<const Vec3> sites, bool periodic);
  FlatSites(const FlatSites&) = delete;
  FlatSites& operator=(const FlatSites&) = delete;

  /// Of places.
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] bool periodic() const { return periodic_; }
  /// The first of the caller's sites at a place.
  [[nodiscard]] std::size_t site_at(std::size_t place) const {
    return static_cast<std::size_t>(sites_[place]);
  }
  /// All sites that are not the first at their place.
  [[nodiscard]] std::span<const Twin> twins() const { return twins_; }

  /// Of an image.
  [[nodiscard]] Vec3 position(std::int32_t image) const {
    return periodic_ ? places_[place(image)] + shift(image / count()) : places_[place(image)];
  }
  [[nodiscard]] std::int32_t site(std::int32_t image) const { return sites_[place(image)]; }
  /// Images sorted by it are in the order of their sites, and those of one site in the order of
  /// their coordinates.
  [[nodiscard]] std::int32_t original(std::int32_t image) const {
    return periodic_ ? kImages * site(image) + rank(image / count()) : site(image);
  }

  // ---- what NearSites needs ----

  [[nodiscard]] std::size_t population() const { return (periodic_ ? kImages : 1) * size(); }
  [[nodiscard]] SiteBoxes::Neighborhood neighborhood(std::int32_t place) const {
    return boxes_.neighborhood(static_cast<std::size_t>(place));
  }
  [[nodiscard]] SiteBoxes::Neighborhood block(const SiteBoxes::Neighborhood& part) const {
    return boxes_.block(part);
  }

  /// Call visit(image) for all images nearer to the box than the root of `limit`, and perhaps for
  /// some slightly farther, because shifts are rounded.
  template <typename Visit>
  void for_each_near(const Box& query, double limit, const Visit& visit) const {
    for_each_shift([&](std::int32_t k) {
      boxes_.for_each_near(moved(query, k), kShifted * limit,
                           [&](std::size_t place) { visit(image(place, k)); });
    });
  }
  /// The same in groups of places that are known to be near.
  template <typename Visit>
  void for_each_near(std::span<const std::size_t> groups, const Box& query, double limit,
                     const Visit& visit) const {
    for (const std::size_t group : groups) {
      const auto k = static_cast<std::int32_t>(group / size());
      boxes_.visit_group(group % size(), moved(query, k), kShifted * limit,
                         [&](std::size_t place) { visit(image(place, k)); });
    }
  }
  template <typename Visit>
  void for_each_group_near(const Box& query, double limit, const Visit& visit) const {
    for_each_shift([&](std::int32_t k) {
      boxes_.for_each_group_near(moved(query, k), kShifted * limit, [&](std::size_t group) {
        visit(static_cast<std::size_t>(k) * size() + group);
      });
    });
  }

  /// Call visit(image) for at least all images nearer than the root of `limit`, which visit() may
  /// lower, near ones first.
  template <typename Visit>
  void for_each_nearest(const Vec3& point, const double& limit, const Visit& visit) const {
    for_each_shift([&](std::int32_t k) {
      boxes_.for_each_nearest(moved({point, point}, k), limit,
                              [&](std::size_t place) { visit(image(place, k)); });
    });
  }

 private:
  static constexpr double kShifted = 1.0 + 1e-9;
  static constexpr std::int32_t kImages = 9;

  [[nodiscard]] std::int32_t count() const { return static_cast<std::int32_t>(places_.size()); }
  [[nodiscard]] std::size_t place(std::int32_t image) const {
    return static_cast<std::size_t>(periodic_ ? image % count() : image);
  }
  [[nodiscard]] std::int32_t image(std::size_t place, std::int32_t shift) const {
    return shift * count() + static_cast<std::int32_t>(place);
  }
  /// The place of a square in the order of the coordinates. The middle square comes first, because
  /// near sites lower the limit.
  [[nodiscard]] static std::int32_t rank(std::int32_t shift) {
    constexpr std::array<std::int32_t, kImages> kRanks = {4, 0, 3, 6, 1, 7, 2, 5, 8};
    return kRanks[static_cast<std::size_t>(shift)];
  }
  /// The eight squares around suffice, because a site's own images keep its cell within half a
  /// period.
  [[nodiscard]] static Vec3 shift(std::int32_t k) {
    const std::int32_t row = rank(k) / 3, column = rank(k) % 3;
    return {row - 1.0, column - 1.0, 0.0};
  }
  [[nodiscard]] static Box moved(const Box& query, std::int32_t k) {
    return {query.low - shift(k), query.high - shift(k)};
  }
  template <typename Use>
  void for_each_shift(const Use& use) const {
    for (std::int32_t k = 0; k < (periodic_ ? kImages : 1); ++k) use(k);
  }

  bool periodic_;
  std::vector<Vec3> places_;
  std::vector<std::int32_t> sites_;
  std::vector<Twin> twins_;
  SiteBoxes boxes_;
};

}  // namespace dapple
