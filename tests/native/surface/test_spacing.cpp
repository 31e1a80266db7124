// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/surface.hpp>
#include <vector>

#include "shapes.hpp"

namespace dapple::test {
namespace {

TEST(CountAtSpacing, IsTheInverseOfSpacing) {
  const Surface surface = grid(2).surface();
  for (const std::size_t count : {1, 2, 50, 1'000'000})
    EXPECT_EQ(surface.count(surface.spacing(count)), count);
  EXPECT_EQ(surface.count(1e9), 1U);
}

TEST(CountAtSpacing, IsOfThePlacesWhereTheDensityIsLargest) {
  const Shape shape = grid(2);
  const double spacing = shape.surface().spacing(1000);
  for (const double largest : {1e-200, 1.0, 5.0, 1e200}) {
    std::vector<double> halves(shape.faces.size(), 0.0);
    std::fill(halves.begin(), halves.begin() + 4, largest);  // of eight faces of equal area
    const Surface half = shape.surface().with_density({DensityAt::kFaces, halves});
    EXPECT_EQ(half.count(spacing), 500U);
    const std::vector<double> same(shape.vertices.size(), largest);
    const Surface whole = shape.surface().with_density({DensityAt::kVertices, same});
    EXPECT_EQ(whole.count(spacing), 1000U);
  }
}

TEST(CountAtSpacing, RefusesAnInvalidSpacing) {
  const Surface surface = grid(2).surface();
  for (const double spacing : {0.0, -1.0, std::nan(""), HUGE_VAL, 1e-9, 1e-300})
    EXPECT_THROW(static_cast<void>(surface.count(spacing)), ArgumentError) << spacing;
}

}  // namespace
}  // namespace dapple::test
