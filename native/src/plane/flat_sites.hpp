// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voronoi/site_boxes.hpp"

namespace dapple {

/// The distinct places of sites in the plane or the torus, in the order of a Morton curve, with
/// searches for near ones. On the torus every site counts nine times: in the unit square and in the
/// eight squares around it.
class FlatSites {
  static constexpr double kShifted = 1.0 + 1e-9;

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
  [[nodiscard]] const Vec3& place(std::size_t k) const { return places_[k]; }
  /// The first of the caller's sites at a place.
  [[nodiscard]] std::int32_t site(std::size_t k) const { return sites_[k]; }
  /// All sites that are not the first at their place.
  [[nodiscard]] std::span<const Twin> twins() const { return twins_; }

  /// The box of a few places that contains this one; equal numbers stand for the same box.
  [[nodiscard]] std::size_t neighborhood(std::size_t k) const { return k / SiteBoxes::kFan; }
  [[nodiscard]] Box box_around(std::size_t k) const { return boxes_.leaf_of(k); }

  /// Call visit(k, shift) for all places whose images, moved by the shift, are nearer to the box
  /// than the root of `limit`, and perhaps for some slightly farther, because shifts are rounded.
  template <typename Visit>
  void for_each_near(const Box& query, double limit, const Visit& visit) const {
    for_each_shift([&](const Vec3& shift) {
      boxes_.for_each_near({query.low - shift, query.high - shift}, kShifted * limit,
                           [&](std::size_t k) { visit(k, shift); });
    });
  }

  /// The same, near boxes first, for a limit that decreases during the search.
  template <typename Visit>
  void for_each_nearest(const Vec3& point, const double& limit, const Visit& visit) const {
    for_each_shift([&](const Vec3& shift) {
      const Vec3 moved = point - shift;
      boxes_.for_each_nearest({moved, moved}, limit, [&](std::size_t k) { visit(k, shift); });
    });
  }

 private:
  /// The eight squares around suffice, because a site's own images keep its cell within half a
  /// period. The middle square comes first, because near sites lower the limit.
  template <typename Use>
  void for_each_shift(const Use& use) const {
    use(Vec3::Zero());
    if (!periodic_) return;
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double x : {-1.0, 0.0, 1.0})
        if (x != 0.0 || y != 0.0) use(Vec3(x, y, 0.0));
  }

  bool periodic_;
  std::vector<Vec3> places_;
  std::vector<std::int32_t> sites_;
  std::vector<Twin> twins_;
  SiteBoxes boxes_;
};

}  // namespace dapple
