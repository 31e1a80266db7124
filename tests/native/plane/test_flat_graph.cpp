// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "base/parallel.hpp"
#include "base/random.hpp"
#include "plane/flat_graph.hpp"
#include "plane/flat_polygon.hpp"

namespace dapple::test {
namespace {

using Points = std::vector<Vec3>;

const Eigen::AlignedBox2d kFrame(Vec2(0.0, 0.0), Vec2(1.0, 1.0));

Points random_points(std::size_t count, double left, double size, std::uint64_t seed) {
  Random random(seed);
  Points points;
  while (points.size() < count) {
    const double x = left + size * random.uniform();
    points.emplace_back(x, left + size * random.uniform(), 0.0);
  }
  return points;
}

Points joined(Points a, const Points& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A ring of sites: their cells meet in the empty middle and at the frame.
Points ring(std::size_t count) {
  Points points;
  Random random(4);
  for (std::size_t k = 0; k < count; ++k) {
    const double turn = 2.0 * std::numbers::pi * random.uniform();
    const double radius = 0.4 + 0.01 * random.uniform();
    points.emplace_back(0.5 + radius * std::cos(turn), 0.5 + radius * std::sin(turn), 0.0);
  }
  return points;
}

Points line(std::size_t count) {
  Points points;
  Random random(9);
  for (std::size_t k = 0; k < count; ++k)
    points.emplace_back((double(k) + 0.5) / double(count), 0.25 + 1e-4 * random.uniform(), 0.0);
  return points;
}

/// No sites, few, evenly many, a far denser corner, and sites around and along empty regions.
std::vector<Points> arrangements() {
  return {{},
          random_points(2, 0, 1, 2),
          random_points(7, 0, 1, 3),
          random_points(1500, 0, 1, 4),
          joined(random_points(40, 0, 1, 5), random_points(1200, 0.7, 0.01, 6)),
          ring(900),
          line(400),
          joined(line(300), random_points(100, 0.5, 0.5, 7))};
}

struct Whole {
  std::int32_t site;
  Vec2 turns;  // the image, as whole periods
  bool operator<(const Whole& other) const {
    return std::tuple(site, turns.x(), turns.y()) <
           std::tuple(other.site, other.turns.x(), other.turns.y());
  }
  bool operator==(const Whole&) const = default;
};

/// The sites whose bisectors bound the cell of site i if every other site cuts it.
std::vector<Whole> expected_links(const Points& x, std::size_t i, bool periodic) {
  const Vec2 p = x[i].head<2>(), low = kFrame.min() - p, high = kFrame.max() - p;
  FlatPolygon cell;
  cell.corners = {{low, -1}, {{high.x(), low.y()}, -1}, {high, -1}, {{low.x(), high.y()}, -1}};
  if (periodic) cell.corners = {{{-1, -1}, -1}, {{1, -1}, -1}, {{1, 1}, -1}, {{-1, 1}, -1}};
  std::vector<Whole> all;
  for (std::size_t j = 0; j < x.size(); ++j)
    for (const double right : {-1.0, 0.0, 1.0})
      for (const double up : {-1.0, 0.0, 1.0}) {
        const Vec2 turns(right, up), d = x[j].head<2>() + turns - p;
        if ((!periodic && !turns.isZero()) || d.isZero(0.0)) continue;
        cell.cut(d, 0.5 * d.squaredNorm(), static_cast<std::int32_t>(all.size()));
        all.push_back({static_cast<std::int32_t>(j), turns});
      }
  std::vector<Whole> result;
  for (const FlatPolygon::Corner& corner : cell.corners)
    if (corner.edge >= 0) result.push_back(all[static_cast<std::size_t>(corner.edge)]);
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<Whole> links_of(const SiteGraph& graph, const Points& x, std::size_t i) {
  std::vector<Whole> result;
  for (const SiteGraph::Link& link : graph.of(i)) {
    const Vec3 turns = x[i] + link.offset - x[static_cast<std::size_t>(link.site)];
    result.push_back({link.site, turns.head<2>().array().round()});
    EXPECT_LE((turns.head<2>() - result.back().turns).norm(), 1e-15);
  }
  std::sort(result.begin(), result.end());
  return result;
}

void expect_links(const SiteGraph& graph, const Points& x) {
  ASSERT_EQ(graph.starts.size(), x.size() + 1);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_TRUE(links_of(graph, x, i) == expected_links(x, i, graph.periodic)) << "site " << i;
    const auto links = graph.of(i);
    EXPECT_TRUE(std::is_sorted(links.begin(), links.end(), [](const auto& a, const auto& b) {
      return a.offset.squaredNorm() < b.offset.squaredNorm();
    }));
  }
}

SiteGraph graph_of(const Points& x, bool periodic) {
  return periodic ? torus_graph(x) : plane_graph(x, kFrame);
}

class FlatGraph : public testing::TestWithParam<bool> {};

std::string domain_name(const testing::TestParamInfo<bool>& periodic) {
  return periodic.param ? "Torus" : "Plane";
}
INSTANTIATE_TEST_SUITE_P(Domains, FlatGraph, testing::Bool(), domain_name);

TEST_P(FlatGraph, HasAllThatBoundACell) {
  for (const Points& x : arrangements()) expect_links(graph_of(x, GetParam()), x);
}

TEST_P(FlatGraph, LinksTheOthersOfAPlaceToTheFirst) {
  Points x = random_points(300, 0, 1, 8);
  const SiteGraph distinct = graph_of(x, GetParam());
  for (const std::size_t k : {17u, 17u, 0u, 299u, 17u}) x.push_back(x[k]);
  const SiteGraph graph = graph_of(x, GetParam());
  for (std::size_t k = 0; k < 300; ++k)
    EXPECT_TRUE(links_of(graph, x, k) == links_of(distinct, x, k)) << "site " << k;
  const std::array<std::int32_t, 5> firsts = {17, 17, 0, 299, 17};
  for (std::size_t k = 0; k < firsts.size(); ++k) {
    ASSERT_EQ(graph.of(300 + k).size(), 1u);
    EXPECT_EQ(graph.of(300 + k)[0].site, firsts[k]);
    EXPECT_TRUE(graph.of(300 + k)[0].offset.isZero(0.0));
  }
}

TEST_P(FlatGraph, IsTheSameForAnyThreads) {
  for (const Points& x : arrangements()) {
    const SiteGraph base = with_threads(1, [&] { return graph_of(x, GetParam()); });
    for (const int threads : {2, 5}) {
      const SiteGraph again = with_threads(threads, [&] { return graph_of(x, GetParam()); });
      EXPECT_EQ(again.starts, base.starts);
      EXPECT_TRUE(std::equal(
          again.links.begin(), again.links.end(), base.links.begin(),
          [](const auto& a, const auto& b) { return a.site == b.site && a.offset == b.offset; }));
    }
  }
}

// Where four cells meet at a point, rounding decides whether the opposite ones are linked.
TEST_P(FlatGraph, LinksNeighborsInALattice) {
  Points x;
  for (int k = 0; k < 400; ++k) x.emplace_back((k % 20 + 0.5) / 20, (k / 20 + 0.5) / 20, 0.0);
  const SiteGraph graph = graph_of(x, GetParam());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto links = graph.of(k);
    const auto sides = std::count_if(links.begin(), links.end(), [](const auto& link) {
      return std::abs(link.offset.norm() - 0.05) < 1e-12;
    });
    const bool inside = k % 20 > 0 && k % 20 < 19 && k / 20 > 0 && k / 20 < 19;
    if (inside || GetParam()) {
      EXPECT_EQ(sides, 4) << "site " << k;
    }
    for (const auto& link : links) EXPECT_LE(link.offset.norm(), 0.071);
  }
}

// A single site has its own images as neighbors.
TEST(TorusGraph, LinksALoneSiteToItself) {
  const Points x = {{0.3, 0.9, 0.0}};
  EXPECT_TRUE(plane_graph(x, kFrame).of(0).empty());
  const SiteGraph graph = torus_graph(x);
  ASSERT_EQ(graph.of(0).size(), 4u);
  for (const auto& link : graph.of(0)) {
    EXPECT_EQ(link.site, 0);
    EXPECT_EQ(link.offset.norm(), 1.0);
  }
}

}  // namespace
}  // namespace dapple::test
