// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>

#include "surface/ordered_face.hpp"
#include "voronoi/site_boxes.hpp"

namespace dapple {

/// The sites in the order of their faces, which is also an order in space. The computation of cells
/// identifies a site by its index in this order, *ordered* site for short.
class OrderedSites {
 public:
  std::vector<std::int32_t> originals;  ///< ordered -> caller's
  std::vector<Vec3> positions;
  std::vector<OrderedFace> faces;

  OrderedSites() = default;
  OrderedSites(const Surface& surface, const Sites& sites) { assign(surface, sites); }

  /// Rebuild for other sites, in the same memory.
  void assign(const Surface& surface, const Sites& sites);

  /// Move to other sites, as many as before, without sorting them again.
  void move(const Surface& surface, const Sites& sites);

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] std::int32_t original(std::int32_t site) const {
    return originals[static_cast<std::size_t>(site)];
  }
  [[nodiscard]] const Vec3& position(std::int32_t site) const {
    return positions[static_cast<std::size_t>(site)];
  }

 private:
  void order_by_face(std::size_t face_count);

  std::vector<OrderedFace> callers_;  // faces, by caller's index
  std::vector<std::int32_t> next_;    // per face: the place of its next site
};

/// Finds nearby sites by boxes around them.
class SiteIndex {
 public:
  /// \param sites must outlive the index
  explicit SiteIndex(const OrderedSites& sites) : sites_(&sites) { update(); }

  /// After the sites have changed; in the same memory.
  void update();

  /// After the sites have moved a little; only without crowds.
  void refit();

  [[nodiscard]] std::int32_t original(std::int32_t site) const { return sites_->original(site); }
  [[nodiscard]] const Vec3& position(std::int32_t site) const { return sites_->position(site); }
  [[nodiscard]] bool has_crowds() const { return !leaders_.empty(); }

  /// Call visit(site) for all sites whose squared distance from a box is below `limit`. Of a crowd
  /// of sites at one place on one face only the first (in the caller's order) is found.
  template <typename Visit>
  void for_each_near(const Box& query, double limit, const Visit& visit) const {
    boxes_.for_each_near(query, limit, [&](std::size_t k) { visit(site_in_boxes(k)); });
  }
  /// The same for several boxes in one, if asked first which groups of sites are near that one.
  template <typename Visit>
  void for_each_near(std::span<const std::size_t> groups, const Box& query, double limit,
                     const Visit& visit) const {
    for (const std::size_t group : groups)
      boxes_.visit_group(group, query, limit, [&](std::size_t k) { visit(site_in_boxes(k)); });
  }
  template <typename Visit>
  void for_each_group_near(const Box& query, double limit, const Visit& visit) const {
    boxes_.for_each_group_near(query, limit, visit);
  }
  [[nodiscard]] SiteBoxes::Neighborhood neighborhood(std::int32_t site) const {
    return boxes_.neighborhood(as_index(places_.empty() ? site : places_[as_index(leader(site))]));
  }
  [[nodiscard]] SiteBoxes::Neighborhood block(const SiteBoxes::Neighborhood& part) const {
    return boxes_.block(part);
  }
  /// All sites in an order in which those of one neighborhood follow each other, as far as there is
  /// one; empty if their own is such an order.
  [[nodiscard]] std::span<const std::int32_t> by_neighborhood() const {
    return leaders_.empty() ? kept_ : std::span<const std::int32_t>();
  }
  /// The number of sites that can be found.
  [[nodiscard]] std::size_t population() const {
    return kept_.empty() ? sites_->size() : kept_.size();
  }
  /// The representative of the crowd of a site; the site itself outside crowds.
  [[nodiscard]] std::int32_t leader(std::int32_t site) const {
    return leaders_.empty() ? site : leaders_[static_cast<std::size_t>(site)];
  }

  /// The site nearest to a point; `otherwise` if all are so far that squared distances overflow.
  [[nodiscard]] std::int32_t nearest(const Vec3& point, std::int32_t otherwise) const;

  /// The nearest site to a point among those for which `competes(site)` holds; of several at the
  /// same distance the first in the caller's order. Only sites whose squared distance is below
  /// `limit` count; -1 if there are none.
  template <typename Competes>
  [[nodiscard]] std::int32_t nearest_of(const Vec3& point, double limit,
                                        const Competes& competes) const {
    std::int32_t best = -1;
    boxes_.for_each_nearest({point, point}, limit, [&](std::size_t k) {
      const std::int32_t site = site_in_boxes(k);
      const double squared = squared_distance(point, site);
      if (!(squared < limit) && !(best >= 0 && squared == limit && precedes(site, best))) return;
      if (!competes(site)) return;
      limit = squared;
      best = site;
    });
    return best;
  }

  /// Call visit(site) for at least all sites whose squared distance from a point is below `limit`,
  /// which visit() may lower, near ones first.
  template <typename Visit>
  void for_each_nearest(const Vec3& point, const double& limit, const Visit& visit) const {
    boxes_.for_each_nearest({point, point}, limit, [&](std::size_t k) { visit(site_in_boxes(k)); });
  }

 private:
  [[nodiscard]] std::int32_t site_in_boxes(std::size_t k) const {
    return kept_.empty() ? static_cast<std::int32_t>(k) : kept_[k];
  }
  void leave_crowds_out();
  [[nodiscard]] bool are_spread() const;
  [[nodiscard]] bool are_off_their_faces() const;
  void sort_in_space(bool anew);
  void find_crowds(std::size_t first, std::size_t last);
  [[nodiscard]] bool precedes(std::int32_t site, std::int32_t other) const {
    return sites_->original(site) < sites_->original(other);
  }
  [[nodiscard]] double squared_distance(const Vec3& point, std::int32_t site) const {
    return (sites_->position(site) - point).squaredNorm();
  }

  const OrderedSites* sites_;
  SiteBoxes boxes_;
  // Where there are crowds: a search would look at all of a crowd for each of its sites.
  std::vector<std::int32_t> leaders_;  // per site
  std::vector<std::int32_t> kept_;     // the sites in the boxes, in their order; empty: all
  std::vector<std::int32_t> places_;   // of sites in the boxes; empty: their own numbers
  std::vector<Vec3> kept_positions_;
};

}  // namespace dapple
