// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/analysis.hpp>
#include <dapple/optimizer.hpp>
#include <dapple/sampler.hpp>

#include "optimize/contacts.hpp"
#include "optimize/repulsion.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

Sites sites_of(const Samples& samples) {
  return {samples.positions, samples.faces, samples.barycentric};
}

Contact along_x(std::size_t i, std::size_t j, double gap) {
  return {i, j, gap, Vec3::UnitX(), Vec3::UnitX(), 2.0, 1e-9};
}

TEST(Contacts, ShareThePushEqually) {
  Vectors moves(2, Vec3::Zero());
  const std::vector<Contact> contacts{along_x(0, 1, -0.2)};
  separate(contacts, moves);
  EXPECT_NEAR(moves[0].x(), 0.1, 1e-12);
  EXPECT_NEAR(moves[1].x(), -0.1, 1e-12);
}

TEST(Contacts, LeaveMovesThatKeepTheDistance) {
  const Vectors before{{0.3, 0, 0}, {0.1, 0.5, 0}};
  Vectors moves = before;
  const std::vector<Contact> contacts{along_x(0, 1, -0.2)};
  separate(contacts, moves);
  EXPECT_EQ(moves[0], before[0]);
  EXPECT_EQ(moves[1], before[1]);
}

/// A site pushed into the next one pushes that one too.
TEST(Contacts, PushOneSiteAfterAnother) {
  Vectors moves(3, Vec3::Zero());
  const std::vector<Contact> contacts{along_x(0, 1, -0.2), along_x(1, 2, 0.0)};
  separate(contacts, moves);
  for (const Contact& contact : contacts) EXPECT_LE(contact.excess(moves), 1e-3);
}

TEST(Contacts, KeepLockedSitesInPlace) {
  Vectors moves(2, Vec3::Zero());
  Contact contact = along_x(0, 1, -0.2);
  contact.at_i = Vec3::Zero();
  contact.room = 1.0;
  separate({&contact, 1}, moves);
  EXPECT_EQ(moves[0], Vec3(Vec3::Zero()));
  EXPECT_NEAR(moves[1].x(), -0.2, 1e-12);
}

TEST(Contacts, AreNoneAcrossAThinEdge) {
  const Vectors normals{Vec3(0.0, 0.3, 1.0).normalized(), Vec3(0.0, 0.3, -1.0).normalized(),
                        Vec3::UnitY()};
  const Planes planes{normals, {}};
  std::vector<Contact> contacts;
  add_contact(planes, 0, 1, 0.1 * Vec3::UnitZ(), 0.2, 1e-9, contacts, kRoomAlong);
  EXPECT_TRUE(contacts.empty());
  add_contact(planes, 0, 1, 0.1 * Vec3::UnitZ(), 0.2, 1e-9, contacts);
  EXPECT_EQ(contacts.size(), 1u);
  add_contact(planes, 0, 2, 0.1 * Vec3::UnitX(), 0.2, 1e-9, contacts, kRoomAlong);
  EXPECT_EQ(contacts.size(), 2u);
}

/// Of an even pattern, a move that would bring one site near to another is changed, and no other.
TEST(CrowdedContacts, ChangeOnlyMovesThatWouldCrowd) {
  const Surface surface = blob(4).surface();
  const Samples even = sample(surface, 1000, {.seed = 3});
  const double spacing = even.report.spacing;
  ASSERT_GT(even.report.evenness.alpha_min, 0.67);
  const RestrictedVoronoi diagram = restricted_voronoi(surface, sites_of(even));
  const CellBoundary side = diagram.boundary(7)[0];
  const auto other = static_cast<std::size_t>(side.neighbor);
  Vectors moves(1000, Vec3::Zero());
  moves[7] = 0.6 * side.offset;
  const auto contacts =
      crowded_contacts(diagram, std::vector<double>(1000, 0.72 * spacing), even.normals, {}, moves);
  separate(contacts, moves);
  EXPECT_GT((moves[7] - moves[other] - side.offset).norm(), 0.65 * spacing);
  std::size_t moved = 0;
  for (const Vec3& move : moves) moved += move.norm() > 0.0 ? 1 : 0;
  EXPECT_LT(moved, 10u);
}

TEST(CrowdedContacts, AreNoneWhereManySitesAreNear) {
  const Surface surface = blob(4).surface();
  const Samples random =
      sample(surface, 1000, {.optimizer = {.max_evaluations = 1}, .start = Start::kRandom});
  EXPECT_TRUE(crowded_contacts(restricted_voronoi(surface, sites_of(random)),
                               std::vector<double>(1000, 0.72 * random.report.spacing),
                               random.normals, {}, Vectors(1000, Vec3::Zero()))
                  .empty());
}

/// On the two sides of a ridge, and in a groove, sites are near others that they cannot leave.
TEST(Samples, AreEvenOnSharpFolds) {
  double sum = 0.0;
  for (const double height : {0.4, 0.5}) {
    const Surface surface = mapped(grid(48), [=](const Vec3& p) {
                              const double along = std::fmod(4.0 * p.x(), 1.0);
                              return Vec3(p.x(), p.y(), height * std::abs(2.0 * along - 1.0));
                            }).surface();
    for (const std::size_t count : {500, 1000})
      for (const std::uint64_t seed : {0, 1, 2, 3, 4, 5})
        sum += sample(surface, count, {.seed = seed}).report.evenness.capacity_variation;
  }
  EXPECT_LE(sum / 24.0, 0.0085);
}

/// Where the density rises quickly, a site in the sparse part has near ones on the dense side.
TEST(Samples, KeepTheirDistanceWhereTheDensityRisesQuickly) {
  const Shape patches = with_density(blob(5), [](const Vec3& x) {
    return std::clamp(2.0 * (std::sin(7.0 * x.x()) + std::sin(7.0 * x.y()) + std::sin(7.0 * x.z())),
                      0.0, 1.0);
  });
  const Samples samples = sample(patches.surface(), 2000, {.seed = 1});
  EXPECT_GT(samples.report.evenness.alpha_min, 0.6);
}

}  // namespace
}  // namespace dapple::test
