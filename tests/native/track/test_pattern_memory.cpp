// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/domain.hpp>
#include <dapple/sampler.hpp>

#include "shapes.hpp"
#include "track/pattern_memory.hpp"

namespace dapple::test {
namespace {

/// Sites on the unit square: their positions on the first frame and now.
struct Fixture {
  explicit Fixture(const std::function<Vec3(const Vec3&)>& map) {
    const Surface flat = grid(8).surface();
    const Samples samples = sample(flat, 200);
    first = samples.positions;
    for (const Vec3& p : first) now.push_back(map(p));
    normals.assign(first.size(), Vec3(0, 0, 1));
    const SurfaceDomain domain(flat);
    memory = std::make_unique<PatternMemory>(
        domain.cells({samples.positions, samples.faces, samples.barycentric}, nullptr));
  }

  /// \param before the sites on the previous frame
  [[nodiscard]] Vectors recall(const Vectors& before, double share = 0.5) const {
    return memory->recall({first, normals}, before, {now, normals}, share);
  }

  Vectors first, now, normals;
  std::unique_ptr<PatternMemory> memory;
};

Vec3 stretched(const Vec3& p) { return {1.7 * p.x() + 0.3 * p.y() + 2.0, 0.8 * p.y(), 0.0}; }

double longest(const Vectors& moves) {
  double result = 0.0;
  for (const Vec3& move : moves) result = std::max(result, move.norm());
  return result;
}

TEST(PatternMemory, HasNothingToUndoInAnAffineImage) {
  const Fixture f(stretched);
  EXPECT_LT(longest(f.recall(f.first)), 1e-13);
}

TEST(PatternMemory, RestoresASingleStray) {
  Fixture f(stretched);
  const std::size_t stray = 100;
  const Vec3 away(0.01, 0.006, 0.0);
  f.now[stray] += away;
  const Vectors moves = f.recall(f.first);
  EXPECT_LT((moves[stray] + 0.5 * away).norm(), 0.1 * away.norm());  // the expected part of the way
  EXPECT_EQ(longest(moves), moves[stray].norm());
}

TEST(PatternMemory, DoesNotMoveWhatDoesNotDeform) {
  Fixture f(stretched);
  f.now[100] += Vec3(0.01, 0.006, 0.0);
  EXPECT_EQ(longest(f.recall(f.now)), 0.0);
}

TEST(PatternMemory, LeavesARebuiltPattern) {
  Fixture f(stretched);
  std::vector<Vec3> shuffled = f.now;  // 200 sites, none at its old place
  for (std::size_t k = 0; k < shuffled.size(); ++k)
    shuffled[k] = f.now[(73 * k + 50) % shuffled.size()];
  f.now = shuffled;
  EXPECT_EQ(longest(f.recall(f.first)), 0.0);
}

TEST(PatternMemory, FollowsBothFramesPlanes) {
  Fixture f(stretched);
  const std::size_t stray = 100;
  f.now[stray] += Vec3(0.01, 0.006, 0.0);
  const Vectors flat = f.recall(f.first);
  const Eigen::AngleAxisd turn(1.1, Vec3(3, 1, 2).normalized());
  for (Vec3& p : f.now) p = turn * p;
  for (Vec3& n : f.normals) n = turn * n;
  const Vectors flat_normals(f.first.size(), Vec3(0, 0, 1));
  const Vectors moves = f.memory->recall({f.first, flat_normals}, f.first, {f.now, f.normals}, 0.5);
  EXPECT_LT((moves[stray] - turn * flat[stray]).norm(), 1e-12);
}

}  // namespace
}  // namespace dapple::test
