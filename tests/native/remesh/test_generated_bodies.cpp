// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <dapple/remesh.hpp>
#include <dapple/topology.hpp>
#include <map>

#include "shapes.hpp"

namespace dapple::test {
namespace {

/// A body made by a seed: plates with 0 to 20 holes, thick or thin, closed or open, bent, in up to
/// three parts.
class Body {
 public:
  explicit Body(std::uint64_t seed) : random_(seed) {}

  [[nodiscard]] Shape shape() {
    Shape result = plate();
    const int more = random_.below(4) == 0 ? 1 + random_.below(2) : 0;
    for (int k = 0; k < more; ++k)
      result = joined(result, mapped(plate(), [&](const Vec3& p) {
                        return Vec3(p + Vec3(0.0, 0.0, 3.0 * (k + 1)));
                      }));
    return result;
  }

 private:
  static constexpr int kCells = 11;  // along a side

  /// Cells that are there; holes do not touch each other or the border.
  std::vector<bool> mask() {
    std::vector<bool> cells(kCells * kCells, true);
    const int holes = random_.below(21);
    for (int k = 0; k < holes; ++k) {
      const int i = 1 + 2 * random_.below(kCells / 2), j = 1 + 2 * random_.below(kCells / 2);
      cells[static_cast<std::size_t>(i * kCells + j)] = false;
    }
    return cells;
  }

  Shape plate() {
    const std::vector<bool> cells = mask();
    const double thick = random_.below(3) == 0 ? 0.02 : random_.between(0.1, 0.4);
    const bool open = random_.below(4) == 0;
    faces_.clear();
    vertices_.clear();
    numbers_.clear();
    const auto is_there = [&](int i, int j) {
      return i >= 0 && j >= 0 && i < kCells && j < kCells &&
             cells[static_cast<std::size_t>(i * kCells + j)];
    };
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j) {
        if (!is_there(i, j)) continue;
        quad({i, j, 1}, {i + 1, j, 1}, {i + 1, j + 1, 1}, {i, j + 1, 1});
        if (open) continue;
        quad({i, j, 0}, {i, j + 1, 0}, {i + 1, j + 1, 0}, {i + 1, j, 0});
        if (!is_there(i - 1, j)) quad({i, j, 0}, {i, j, 1}, {i, j + 1, 1}, {i, j + 1, 0});
        if (!is_there(i + 1, j))
          quad({i + 1, j, 0}, {i + 1, j + 1, 0}, {i + 1, j + 1, 1}, {i + 1, j, 1});
        if (!is_there(i, j - 1)) quad({i, j, 0}, {i + 1, j, 0}, {i + 1, j, 1}, {i, j, 1});
        if (!is_there(i, j + 1))
          quad({i, j + 1, 0}, {i, j + 1, 1}, {i + 1, j + 1, 1}, {i + 1, j + 1, 0});
      }
    return bent({"Body", vertices_, faces_}, thick);
  }

  /// Waves, and a taper toward the rim or none.
  Shape bent(const Shape& flat, double thick) {
    const double wave = random_.between(0.0, 0.3), turn = random_.between(0.0, 6.0);
    const bool tapers = random_.below(2) == 0;
    return mapped(flat, [=](const Vec3& p) {
      const double x = 2.0 * p[0] / kCells - 1.0, y = 2.0 * p[1] / kCells - 1.0;
      const double rim = std::max(std::abs(x), std::abs(y));
      const double height = thick * (p[2] - 0.5) * (tapers ? 1.0 - 0.7 * rim * rim : 1.0);
      return Vec3(x, y, height + wave * std::sin(2.0 * x + turn) * std::cos(1.5 * y));
    });
  }

  using Place = std::array<int, 3>;
  std::int32_t vertex(const Place& place) {
    const auto [found, made] = numbers_.try_emplace(place, static_cast<int>(vertices_.size()));
    if (made) vertices_.push_back(Vec3(place[0], place[1], place[2]));
    return found->second;
  }
  void quad(const Place& a, const Place& b, const Place& c, const Place& d) {
    const std::array<std::int32_t, 4> v = {vertex(a), vertex(b), vertex(c), vertex(d)};
    if (random_.below(2) == 0) {
      faces_.push_back({v[0], v[1], v[2]});
      faces_.push_back({v[0], v[2], v[3]});
    } else {
      faces_.push_back({v[0], v[1], v[3]});
      faces_.push_back({v[1], v[2], v[3]});
    }
  }

  Random random_;
  std::vector<Vec3> vertices_;
  std::vector<Face> faces_;
  std::map<Place, std::int32_t> numbers_;
};

class GeneratedBodies : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, GeneratedBodies, testing::Range(0, 100));

TEST_P(GeneratedBodies, KeepTheirTopology) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  const Surface surface = Body(seed).shape().surface();
  const Topology before = topology(surface);
  ASSERT_TRUE(before.manifold);
  const auto parts = static_cast<std::size_t>(before.components);
  const RemeshResult mesh = remesh(surface, parts * (500 + 10 * (seed % 40)));
  EXPECT_EQ(mesh.report.flaws, 0u);
  EXPECT_EQ(mesh.report.dropped_lines, 0u);
  EXPECT_EQ(mesh.report.nonmanifold_edges, 0u);
  EXPECT_EQ(mesh.report.flipped, 0u);
  SurfaceOptions plain;
  plain.weld = std::nullopt;
  const Topology after = topology(Surface(mesh.vertices, mesh.faces, Density{}, plain));
  EXPECT_TRUE(after.manifold);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_EQ(after.border_loops, before.border_loops);
}

}  // namespace
}  // namespace dapple::test
