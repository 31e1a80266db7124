// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/sampler.hpp>

#include "changing_bodies.hpp"
#include "invariants.hpp"
#include "track/frame_solver.hpp"
#include "track/transfer.hpp"

namespace dapple::test {
namespace {

double density_of(const Surface& surface, const Samples& samples) {
  return static_cast<double>(samples.size()) / surface.capacity();
}

Transfer transfer_of(const Surface& before, const Surface& next, const Samples& samples,
                     double spacings = 1.0) {
  return {
      before, next, dapple::sites_of(samples), {density_of(before, samples), spacings}, nullptr};
}

TEST(Transfer, FindsTheNearestPlacesOfAnotherMeshOfTheSameShape) {
  const Surface before = icosphere(4).surface(), next = icosphere(5).surface();
  const Samples samples = sample(before, 300);
  const Transferred found = transfer_of(before, next, samples).samples();
  const Projection nearest = Projector(next).project(samples.positions);
  ASSERT_EQ(found.which.size(), samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k)
    EXPECT_LT((found.sites.positions[k] - nearest.positions[k]).norm(), 0.002) << k;
}

/// The limb moves by two spacings, so the closest points of samples at its sides are wrong.
TEST(Transfer, MovesAlongWithALimb) {
  const auto limb = [](int around, double shift) {
    return mapped(torus(around, 24), [&](const Vec3& p) { return Vec3(p + Vec3(0, 0, shift)); })
        .surface();
  };
  const Surface before = limb(80, 0.0), next = limb(70, 0.2);
  const Samples samples = sample(before, 2000);
  EXPECT_GT(0.2, 2.0 * samples.report.spacing);
  const Transferred found = transfer_of(before, next, samples).samples();
  ASSERT_EQ(found.which.size(), samples.size());
  const auto error = [&](const std::vector<Vec3>& places) {
    double sum = 0.0;
    for (std::size_t k = 0; k < samples.size(); ++k)
      sum += (places[k] - samples.positions[k] - Vec3(0, 0, 0.2)).norm();
    return sum;
  };
  EXPECT_LT(error(found.sites.positions),
            0.6 * error(Projector(next).project(samples.positions).positions));
}

/// A plate a tenth of a spacing thick moves by five times its thickness, so the closest point is on
/// the other side.
TEST(Transfer, StaysOnItsSideOfAThinPlate) {
  const auto plate = [](int cells, double height) {
    return mapped(box(cells),
                  [&](const Vec3& p) { return Vec3(p.x(), p.y(), 0.01 * p.z() + height); })
        .surface();
  };
  const Surface before = plate(10, 0.0), next = plate(7, 0.05);
  const Samples samples = sample(before, 200);
  const Transferred found = transfer_of(before, next, samples).samples();
  ASSERT_GE(found.which.size(), 190u);
  for (std::size_t k = 0; k < found.which.size(); ++k) {
    const Vec3& from = samples.positions[static_cast<std::size_t>(found.which[k])];
    const Vec3& to = found.sites.positions[k];
    const bool on_wall =
        std::min(from.x(), from.y()) < 1e-9 || std::max(from.x(), from.y()) > 1 - 1e-9;
    if (!on_wall) {
      EXPECT_NEAR(to.z(), from.z() + 0.05, 1e-12) << k;
    }
  }
}

TEST(Transfer, LosesWhatHasNoSurfaceWithinReach) {
  const Shape ball = icosphere(3);
  const Shape other = mapped(ball, [](const Vec3& p) { return Vec3(0.5 * p + Vec3(3, 0, 0)); });
  const Surface both = joined(ball, other).surface(), one = ball.surface();
  const Samples samples = sample(both, 300);
  const Transferred found = transfer_of(both, one, samples).samples();
  std::vector<std::int32_t> left;
  for (std::size_t k = 0; k < samples.size(); ++k)
    if (samples.positions[k].x() < 2.0) left.push_back(static_cast<std::int32_t>(k));
  EXPECT_EQ(found.which, left);
}

/// The component moves by five spacings.
TEST(Transfer, FollowsAComponentThatMovesFartherThanTheReach) {
  const Shape ball = icosphere(4);
  const Surface before = ball.surface();
  const Samples samples = sample(before, 2000);
  const auto moved = [](const Vec3& p) { return Vec3(p + Vec3(0.45, 0, 0)); };
  const Surface next = mapped(icosphere(3), moved).surface();
  EXPECT_GT(0.45, 5.0 * samples.report.spacing);
  EXPECT_EQ(transfer_of(before, next, samples).samples().which.size(), samples.size());
}

TEST(Transfer, FindsNoPlaceWithoutDensity) {
  const Surface before = icosphere(3).surface();
  const Samples samples = sample(before, 300);
  const Surface next = with_face_density(icosphere(2), [](const Vec3& p) {
                         return p.x() > 0.0 ? 1.0 : 0.0;
                       }).surface();
  const Transferred found = transfer_of(before, next, samples).samples();
  ASSERT_GT(found.which.size(), 100u);
  ASSERT_LT(found.which.size(), 250u);
  const std::vector<double> density = next.density();
  for (const std::int32_t face : found.sites.faces)
    EXPECT_EQ(density[static_cast<std::size_t>(face)], 1.0);
}

TEST(Transfer, FindsOtherSitesTheSameWay) {
  const Surface before = remeshed(2).surface(), next = remeshed(3).surface();
  const Samples samples = sample(before, 100);
  const Transfer transfer = transfer_of(before, next, samples);
  const Transferred again = transfer.find(dapple::sites_of(samples), nullptr);
  EXPECT_EQ(again.which, transfer.samples().which);
  EXPECT_TRUE(same_bytes(again.sites.positions, transfer.samples().sites.positions));
}

}  // namespace
}  // namespace dapple::test
