// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/polygon.hpp"
#include "surface/ordered_surface.hpp"
#include "voronoi/bisectors.hpp"
#include "voronoi/density_support.hpp"

namespace dapple {

/// Visits the pieces of one cell after another; one object per thread. Sites are ordered sites.
class CellFlood {
 public:
  /// The arguments must outlive the flood.
  CellFlood(const Surface& surface, const OrderedSites& sites, const SiteIndex& index,
            const OrderedLinks* links = nullptr);

  /// Call after the sites have changed.
  /// \param support the faces that floods from a site on them do not leave; null: all
  void restart(const DensitySupport* support = nullptr);

  /// Start a site. False if a coincident site of lower (caller's) index owns the cell, such as
  /// owner(), or another one that this leads to.
  bool reset(std::int32_t site, Rivals rivals = Rivals::kAll);

  /// The same for clipping faces far from it. Only where links are not known.
  bool reset_far(std::int32_t site);

  /// Start a site that competes with `others` only.
  void reset_among(std::int32_t site, std::span<const std::int32_t> others);

  [[nodiscard]] std::int32_t owner() const { return owner_; }
  [[nodiscard]] const Vec3& position() const { return sites_->position(site_); }
  [[nodiscard]] const Bisector& bisector(std::int32_t k) const {
    return bisectors_.known(static_cast<std::size_t>(k));
  }
  /// Number of known bisectors.
  [[nodiscard]] std::size_t known() const { return bisectors_.end(); }
  /// Time spent on neighbor searches.
  [[nodiscard]] Laps& laps() { return bisectors_.laps(); }
  [[nodiscard]] const Polygon& polygon() const { return polygon_; }
  /// The bisectors that clipped the last face, or that contain the face and so give it to their
  /// site.
  [[nodiscard]] std::span<const std::int32_t> cuts() const { return cuts_; }

  /// Clip a face to the site's cell; true if nothing was cut off.
  ///
  /// A face that lies in a bisector, up to rounding, is equally near to both sites; both calls give
  /// it to the lower (caller's) index.
  bool clip(OrderedFace face);

  /// Call `visit(face, whole)` for each piece of the cell that is connected to one of the seeds.
  template <typename Visit>
  void flood(std::span<const OrderedFace> seeds, const Visit& visit) {
    ++stamp_;
    pending_.clear();
    const std::int32_t* const around = surface_->ordered().connectivity().next_around_edge.data();
    for (const OrderedFace face : seeds) push(face);
    for (std::size_t next = 0; next < pending_.size(); ++next) {
      const OrderedFace face = pending_[next];
      const bool whole = clip(face);
      if (polygon_.empty()) continue;
      visit(face, whole);
      for (const Polygon::Corner& corner : polygon_.corners())
        if (corner.edge < 0) cross(half_edge(face, -1 - corner.edge), around);
    }
  }

 private:
  void push(OrderedFace face) {
    std::int32_t& stamp = stamps_[as_index(face)];
    if (stamp == stamp_) return;
    stamp = stamp_;
    if (support_ && bounded_ && !support_->has(face)) return;
    pending_.push_back(face);
    surface_->ordered().prefetch(face);
  }

  void turn_to(std::int32_t site);
  [[nodiscard]] bool is_far(const Bisector& bisector) const {
    return !(bisector.squared_distance < 4.0 * polygon_.squared_radius());
  }
  [[nodiscard]] bool clip_near(const HalfSpaces::Triangle& triangle);
  void clip_far(const HalfSpaces::Triangle& triangle, const std::array<std::int32_t, 3>& vertices);
  void take_known_far();
  void find_far(const HalfSpaces::Triangle& triangle, const std::array<std::int32_t, 3>& vertices);
  [[nodiscard]] bool take_far(std::size_t k);
  [[nodiscard]] const Vec3* next_unsure() const;
  [[nodiscard]] bool cut_by_those(unsigned reached, std::size_t first, std::size_t last);
  [[nodiscard]] bool cut_by(const Bisector& bisector, std::size_t k);

  void cross(std::int32_t half_edge, const std::int32_t* around) {
    for (std::int32_t h = around[half_edge]; h != half_edge; h = around[h]) push(face_of(h));
  }

  const Surface* surface_;
  const OrderedSites* sites_;
  Bisectors bisectors_;
  std::int32_t site_ = 0;
  std::int32_t owner_ = 0;
  Polygon polygon_;
  std::vector<std::int32_t> cuts_;
  Polygon rest_;                   // of a face that near bisectors leave: what far ones do ...
  std::vector<std::int32_t> far_;  // ... which are these
  std::vector<Vec3> sure_;         // corners of it to which no other site is nearer
  std::vector<std::int32_t>
      own_vertices_;  // per vertex: the last turn to a site of which it is sure
  std::int32_t turn_ = 0;
  const DensitySupport* support_ = nullptr;
  bool bounded_ = false;              // whether the site is on it
  bool whole_ = true;                 // whether it is the face
  std::vector<std::int32_t> stamps_;  // per face: the last flood that reached it
  std::int32_t stamp_ = 0;
  std::vector<OrderedFace> pending_;  // a queue: what is pushed has time to come from memory
};

}  // namespace dapple
