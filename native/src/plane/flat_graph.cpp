// SPDX-License-Identifier: GPL-3.0-or-later
#include "plane/flat_graph.hpp"

#include <algorithm>
#include <numeric>

#include "base/parallel.hpp"
#include "plane/flat_cells.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 512;  // places per chunk

using Link = SiteGraph::Link;

/// Turn the number of links of each site into the end of its row, and allocate the rows.
void make_rows(SiteGraph& graph) {
  std::partial_sum(graph.starts.begin(), graph.starts.end(), graph.starts.begin());
  graph.links.resize(graph.starts.back());
}

/// \param cells creates the cells of a thread
template <typename MakeCells>
SiteGraph to_graph(const FlatSites& sites, std::size_t count, const MakeCells& cells) {
  SiteGraph graph;
  graph.periodic = sites.periodic();
  graph.starts.assign(count + 1, 0);
  std::vector<std::vector<Link>> found((sites.size() + kGrain - 1) / kGrain);
  parallel_chunks(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    FlatCells mine = cells();
    std::vector<Link>& links = found[begin / kGrain];
    for (std::size_t k = begin; k < end; ++k) {
      mine.turn_to(static_cast<std::int32_t>(k));
      links.insert(links.end(), mine.links().begin(), mine.links().end());
      graph.starts[sites.site_at(k) + 1] = mine.links().size();
    }
  });
  for (const FlatSites::Twin& twin : sites.twins())
    graph.starts[static_cast<std::size_t>(twin.site) + 1] = 1;
  make_rows(graph);
  parallel_chunks(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const Link* next = found[begin / kGrain].data();
    for (std::size_t k = begin; k < end; ++k) {
      const auto row = graph.starts.begin() + static_cast<std::ptrdiff_t>(sites.site_at(k));
      std::copy_n(next, row[1] - row[0], graph.links.begin() + static_cast<std::ptrdiff_t>(row[0]));
      next += row[1] - row[0];
    }
  });
  for (const FlatSites::Twin& twin : sites.twins())
    graph.links[graph.starts[static_cast<std::size_t>(twin.site)]] = {twin.first, Vec3::Zero()};
  return graph;
}

}  // namespace

SiteGraph plane_graph(std::span<const Vec3> x, const Eigen::AlignedBox2d& frame) {
  const FlatSites sites(x, false);
  return to_graph(sites, x.size(), [&] { return FlatCells(sites, frame); });
}

SiteGraph torus_graph(std::span<const Vec3> x) {
  const FlatSites sites(x, true);
  return to_graph(sites, x.size(), [&] { return FlatCells(sites); });
}

}  // namespace dapple
