// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/neighbours.hpp>
#include <optional>

#include "site_graph.hpp"

namespace dapple {

/// The sites in the order of their faces, which is also an order in space. All that computes cells
/// speaks of a site by its place in this order, *ordered* site for short.
struct OrderedSites {
  std::vector<std::int32_t> originals;  ///< ordered -> caller's
  std::vector<Vec3> positions;
  std::vector<std::int32_t> faces;  ///< ordered faces

  OrderedSites(const Surface& surface, const Sites& sites);

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] std::int32_t original(std::int32_t site) const {
    return originals[static_cast<std::size_t>(site)];
  }
  [[nodiscard]] const Vec3& position(std::int32_t site) const {
    return positions[static_cast<std::size_t>(site)];
  }
};

/// Knows which sites are near: from a tree, or from a graph of the sites whose cells touch.
class SiteIndex {
 public:
  /// The arguments must outlive the index. \param graph of the caller's sites, or null
  SiteIndex(const OrderedSites& sites, const SiteGraph* graph);

  /// Null with a graph.
  [[nodiscard]] const Neighbours* tree() const { return tree_ ? &*tree_ : nullptr; }
  /// Only with a graph; they name the caller's sites.
  [[nodiscard]] std::span<const SiteGraph::Link> links(std::int32_t site) const {
    return graph_->of(static_cast<std::size_t>(sites_->original(site)));
  }
  /// Only with a graph.
  [[nodiscard]] std::int32_t ordered(std::int32_t original) const {
    return ordered_[static_cast<std::size_t>(original)];
  }

  /// The site nearest to a point. Only the way there depends on `from`, a site that is better near.
  [[nodiscard]] std::int32_t nearest(const Vec3& point, std::int32_t from) const;

 private:
  [[nodiscard]] std::int32_t walk(const Vec3& point, std::int32_t site) const;
  [[nodiscard]] double squared_distance(const Vec3& point, std::int32_t site) const {
    return (sites_->position(site) - point).squaredNorm();
  }

  const OrderedSites* sites_;
  const SiteGraph* graph_;
  std::optional<Neighbours> tree_;     // without a graph
  std::vector<std::int32_t> ordered_;  // with a graph: caller's -> ordered
};

}  // namespace dapple
