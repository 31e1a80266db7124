// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/resample.hpp>
#include <iostream>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

class ResampleOn : public testing::TestWithParam<Shape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, ResampleOn, testing::ValuesIn(all_shapes()),
                         shape_name<testing::TestParamInfo<Shape>>);

TEST_P(ResampleOn, GivesTheCountWithUniqueIds) {
  const Surface surface = GetParam().surface();
  const Samples before = sample(surface, 100);
  for (const std::size_t count : {0u, 1u, 90u, 100u, 130u}) {
    const Samples after = resample(surface, before, count);
    ASSERT_EQ(after.size(), count);
    check_on_surface(surface, {after.positions, after.faces, {}}, after.barycentric);
    std::vector<std::int32_t> ids = after.ids;
    std::sort(ids.begin(), ids.end());
    EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
  }
}

/// One per cent more, fewer, and of the density: most things stay where they are.
TEST(Resample, MovesMostSamplesLittle) {
  const Surface surface = blob(4).surface();
  const Samples before = sample(surface, 1000);
  std::vector<double> tilted;
  for (const Vec3& x : surface.vertices()) tilted.push_back(1.0 + 0.01 * x.x());
  const Samples more = resample(surface, before, 1010), fewer = resample(surface, before, 990),
                other =
                    resample(surface.with_density({DensityAt::kVertices, tilted}), before, 1000);
  for (const Samples* after : {&more, &fewer, &other}) {
    const Report& report = after->report;
    std::cout << after->size() << " samples: slide median " << report.slide_median << ", mean "
              << report.slide_mean << ", max " << report.slide_max << ", capacity spread "
              << report.evenness.capacity_spread << ", " << report.evaluations << " evaluations\n";
    EXPECT_LT(report.slide_median, 0.15);
    EXPECT_LT(report.evenness.capacity_spread, 0.02);
    EXPECT_GT(report.evenness.alpha_min, 0.55);
  }
  for (std::size_t k = 0; k < 1000; ++k) EXPECT_EQ(more.ids[k], before.ids[k]);
  EXPECT_EQ(more.ids[1000], 1000);
}

TEST(Resample, DoesNotMoveWhatIsWanted) {
  const Surface surface = blob(3).surface();
  const Samples before = sample(surface, 300);
  EXPECT_TRUE(same_bytes(resample(surface, before, 300).positions, before.positions));
}

TEST(Resample, NamesSamplesOfAnotherSurface) {
  const Samples before = sample(blob(3).surface(), 100);
  expect_message<ArgumentError>([&] { (void)resample(grid(2).surface(), before, 100); },
                                {"faces["});
}

TEST(Resample, NamesIdsThatLeaveNoRoomForOthers) {
  const Surface surface = blob(2).surface();
  const Samples some = sample(surface, 20);
  std::vector<std::int32_t> ids = some.ids;
  ids[7] = 2147483640;
  const Samples before = bind_samples(surface, some.faces, some.barycentric, ids);
  EXPECT_EQ(resample(surface, before, 27).ids.back(), 2147483647);
  expect_message<ArgumentError>([&] { (void)resample(surface, before, 28); },
                                {"ids", "2147483640", "8"});
}

/// Samples made by hand may have no ids.
TEST(Resample, NumbersSamplesWithoutIds) {
  const Surface surface = blob(2).surface();
  Samples before = sample(surface, 20);
  before.ids.clear();
  const Samples after = resample(surface, before, 30);
  for (std::size_t k = 0; k < after.size(); ++k)
    EXPECT_EQ(after.ids[k], static_cast<std::int32_t>(k));
}

}  // namespace
}  // namespace dapple::test
