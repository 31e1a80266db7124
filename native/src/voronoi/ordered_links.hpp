// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voronoi/site_graph.hpp"
#include "voronoi/site_index.hpp"

namespace dapple {

/// The sites whose cells touch, where they are known beforehand, by their ordered numbers.
class OrderedLinks {
 public:
  /// \param graph of the caller's sites, or null; must outlive the links, as the sites must
  void assign(const OrderedSites& sites, const SiteGraph* graph);

  /// Whether there is a graph; the rest is only for that case.
  [[nodiscard]] bool known() const { return graph_ != nullptr; }

  /// \return links that name the caller's sites
  [[nodiscard]] std::span<const SiteGraph::Link> of(std::int32_t site) const {
    return graph_->of(as_index(sites_->original(site)));
  }
  [[nodiscard]] std::int32_t ordered(std::int32_t original) const {
    return ordered_[as_index(original)];
  }

  /// The site nearest to a point. `from` only affects the time and should be near.
  [[nodiscard]] std::int32_t nearest(const Vec3& point, std::int32_t from) const;

 private:
  const OrderedSites* sites_ = nullptr;
  const SiteGraph* graph_ = nullptr;
  std::vector<std::int32_t> ordered_;  // caller's -> ordered
};

}  // namespace dapple
