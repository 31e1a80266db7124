// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/energy.hpp>
#include <dapple/poisson_start.hpp>

#include "allocator.hpp"
#include "base/parallel.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

/// The number of allocations during `work()`, with one thread so that runs are comparable.
template <typename Work>
long allocations_in(const Work& work) {
  long count = 0;
  with_threads(1, [&] {
    const long before = allocations();
    work();
    count = allocations() - before;
  });
  return count;
}

/// The allocations of the second of two evaluations.
long allocations_in_a_second_evaluation(const Domain& domain, const Sites& sites) {
  Energy energy;
  const auto evaluate = [&] { update_energy(energy, domain, sites, 30.0); };
  EXPECT_GT(allocations_in(evaluate), 0);
  return allocations_in(evaluate);
}

TEST(Allocations, NoneInLaterEvaluations) {
  const Surface surface = blob(5).surface();
  for (const std::size_t count : {20u, 500u, 20000u}) {
    const SurfaceDomain domain(surface);
    const Sites sites = poisson_start(surface, count, 1);
    EXPECT_EQ(allocations_in_a_second_evaluation(domain, sites), 0) << count << " sites";
  }
}

TEST(Allocations, AreNoneWithADensity) {
  Shape shape = blob(5);
  for (const Vec3& vertex : shape.vertices) shape.density.push_back(std::exp(2.0 * vertex.x()));
  const Surface surface = shape.surface();
  const SurfaceDomain domain(surface);
  const Sites sites = poisson_start(surface, 500, 1);
  EXPECT_EQ(allocations_in_a_second_evaluation(domain, sites), 0);
}

/// Reused memory that held other sites gives the same results as new memory.
TEST(Allocations, SparedAllocationsChangeNothing) {
  const Surface surface = blob(4).surface();
  const SurfaceDomain domain(surface);
  Energy kept;
  for (const std::size_t count : {300u, 1000u, 50u, 51u, 1000u}) {
    const Sites sites = poisson_start(surface, count, count);
    update_energy(kept, domain, sites, 30.0);
    const Energy fresh = evaluate_energy(SurfaceDomain(surface), sites, 30.0);
    EXPECT_EQ(kept.total, fresh.total);
    EXPECT_EQ(kept.gradient, fresh.gradient);
    ASSERT_EQ(kept.diagram.boundaries.size(), fresh.diagram.boundaries.size());
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(kept.diagram.cells[k].capacity, fresh.diagram.cells[k].capacity);
      EXPECT_EQ(kept.diagram.rows[k].first, fresh.diagram.rows[k].first);
      EXPECT_EQ(kept.diagram.rows[k].count, fresh.diagram.rows[k].count);
    }
  }
}

}  // namespace
}  // namespace dapple::test
