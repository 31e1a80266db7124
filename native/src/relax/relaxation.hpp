// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/relax.hpp>
#include <dapple/samples.hpp>

#include "optimize/minimizer.hpp"
#include "relax/participants.hpp"
#include "relax/region.hpp"
#include "relax/rings.hpp"

namespace dapple {

struct SharedCells;
struct Thinned;

/// Cells of sites on a part of a surface, some of which are to be measured.
struct MeasuredCells {
  const RestrictedVoronoi& diagram;
  std::span<const Vec3> normals;  ///< per site
  std::vector<bool> chosen;       ///< per site
  double share;                   ///< wanted capacity per site
  double capacity_weight;
};

/// Measure the evenness, bond order and energy of the chosen cells, if there are any.
void measure_members(const MeasuredCells& cells, Quality& quality);

/// Optimizes the sites around a change, on a part of the surface that grows until the sites at its
/// border are even.
class Relaxation {
 public:
  /// \param surface, options, participants must outlive the relaxation
  /// \param locked per site, whether it stays where it is
  /// \param participants the other classes; null if there are none
  Relaxation(const Surface& surface, Sites sites, std::vector<bool> locked,
             const RelaxOptions& options, const Participants* participants = nullptr);

  /// \param changed faces; sorted
  /// \throw ArgumentError for a count that the region cannot reach; Cancelled
  void run(std::span<const OrderedFace> changed, Context* context);

  /// The given sites, then the new ones.
  [[nodiscard]] const Sites& sites() const { return sites_; }
  [[nodiscard]] bool is_alive(std::size_t site) const { return alive_[site]; }
  /// Whether the site was free to move.
  [[nodiscard]] bool is_free(std::size_t site) const { return free_[site]; }
  /// Faces of the last region; sorted.
  [[nodiscard]] const std::vector<OrderedFace>& faces() const { return faces_; }
  /// Evenness of the free sites and their neighbors.
  [[nodiscard]] const Report& report() const { return report_; }

 private:
  using Indices = std::vector<std::int32_t>;

  [[nodiscard]] std::vector<OrderedFace> faces_around(const Context* context);
  [[nodiscard]] std::vector<OrderedFace> all_faces() const;
  [[nodiscard]] bool is_everything() const { return region_.size() == given_; }
  [[nodiscard]] bool is_settled(const Region& region) const;
  void widen(const Context* context);
  [[nodiscard]] std::size_t free_count() const;
  [[nodiscard]] double spare_samples(const Region& region, const RestrictedVoronoi& diagram) const;
  [[nodiscard]] bool widen_for_count(const Region& region, const RestrictedVoronoi& diagram,
                                     const Context* context);
  [[nodiscard]] bool is_void(const std::vector<OrderedFace>& faces) const;
  void empty();
  [[nodiscard]] Region cut_out(const std::vector<OrderedFace>& faces, Context* context);
  void lead_to_density(Region& region, const Context* context);
  void balance(Region& region, Context* context);
  [[nodiscard]] static bool is_spread(const Region& region, const RestrictedVoronoi& diagram,
                                      double capacity);
  void rebalance_all(Region& region, Context* context);
  void add(const Sites& fresh, Region& region);
  [[nodiscard]] RestrictedVoronoi first_cells(const Region& region, Context* context);
  [[nodiscard]] double capacity_around(const Region& region,
                                       const RestrictedVoronoi& diagram) const;
  [[nodiscard]] double capacity_elsewhere() const;
  [[nodiscard]] double capacity_for_count(const Region& region, const SharedCells& shared);
  [[nodiscard]] std::int64_t lacking() const;
  void keep_to_count(std::size_t count, const Region& region, Thinned& found);
  void take_out(const std::vector<std::size_t>& stay, Region& region);
  void put_in(std::size_t count, double capacity, Region& region, const Context* context);
  [[nodiscard]] Indices even_out(const Region& region, Context* context);
  void store(const Region& region, const Sites& found);
  [[nodiscard]] Indices uneven(const Region& region, const RestrictedVoronoi& diagram) const;
  [[nodiscard]] Indices grow_at(const Indices& uneven, Context* context);
  [[nodiscard]] Minimum minimum(const Region& region, std::shared_ptr<const SurfaceDomain> domain,
                                Context* context) const;
  void measure_all(const Region& region, const Minimum& found);
  void note(const Region& region, const Minimum& found);

  const Surface& surface_;
  const RelaxOptions& options_;
  const Participants* others_;
  std::size_t given_;  // sites; new ones follow
  Sites sites_;
  std::vector<bool> alive_;
  std::vector<bool> locked_;
  std::vector<bool> free_;
  Rings rings_;  // of the sites as they were given
  std::span<const OrderedFace> changed_;
  std::vector<OrderedFace> faces_;  // of the last region
  Indices owners_;                  // owners of changed faces; sorted
  Indices region_;                  // given sites that have been optimized or removed; sorted
  Indices border_;                  // the region and its neighbors; sorted
  double capacity_ =
      0.0;  // mean capacity of a site around the region, in the unit of the domains' integrals
  double share_ = 0.0;  // of a site in the region; differs from capacity_ if a count is wanted
  std::unordered_map<std::int32_t, double> first_capacities_;  // before anything has moved
  Report report_;
};

}  // namespace dapple
