// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/domain.hpp>

namespace dapple {

/// A part of a surface on which each site is to have a given capacity. Cells are cut off at the rim
/// of the part, so this cannot follow from the part's own capacity.
class PartDomain final : public Domain {
 public:
  /// \param domain   of the part; must outlive this
  /// \param capacity of a site, as the domain's integrals
  PartDomain(const SurfaceDomain& domain, double capacity, std::size_t count)
      : domain_(domain), capacity_(capacity * static_cast<double>(count)) {}

  void update_cells(RestrictedVoronoi& diagram, const Sites& sites,
                    Context* context) const override {
    domain_.update_cells(diagram, sites, context);
  }
  [[nodiscard]] Sites project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                              const Context* context) const override {
    return domain_.project(points, hints, context);
  }
  [[nodiscard]] Vec3 normal(std::int32_t face) const override { return domain_.normal(face); }
  [[nodiscard]] double area() const override { return domain_.area(); }
  [[nodiscard]] double capacity() const override { return capacity_; }
  [[nodiscard]] double density_unit() const override { return domain_.density_unit(); }
  [[nodiscard]] bool uniform() const override { return domain_.uniform(); }
  [[nodiscard]] std::vector<bool> on_border(const Sites& sites,
                                            const RestrictedVoronoi& diagram) const override {
    return domain_.on_border(sites, diagram);
  }
  [[nodiscard]] Surface sampling_surface(std::size_t count) const override {
    return domain_.sampling_surface(count);
  }
  void check(const Sites& sites) const override { domain_.check(sites); }

 private:
  const SurfaceDomain& domain_;
  double capacity_;
};

}  // namespace dapple
