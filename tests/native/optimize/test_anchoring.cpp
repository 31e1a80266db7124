// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>

#include "optimize/anchoring.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

constexpr double kScale = 3.0;

/// Samples on a bumpy body, each displaced from its anchor in its own way.
struct Fixture {
  explicit Fixture(Hold held) : hold(held) {
    const Surface surface = blob(3).surface();
    const Samples samples = sample(surface, 80);
    diagram = restricted_voronoi(surface, {samples.positions, samples.faces});
    anchors = positions = samples.positions;
    Random random(5);
    for (Vec3& x : positions) x += 0.1 * random.in_box();
    anchoring = Anchoring(diagram, anchors, kScale, hold);
  }

  [[nodiscard]] double total() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < positions.size(); ++k) sum += anchoring.energy(positions, k);
    return sum;
  }

  Hold hold;
  RestrictedVoronoi diagram;
  Vectors anchors, positions;
  Anchoring anchoring;
};

TEST(Anchoring, HasTheEnergyOfItsDefinition) {
  const Fixture f({.stickiness = 0.7, .smoothing = 0.4});
  const auto slide = [&](std::size_t k) { return Vec3(f.positions[k] - f.anchors[k]); };
  double sum = 0.0;
  for (std::size_t i = 0; i < f.positions.size(); ++i) {
    sum += 0.7 * f.diagram.cells[i].mass * slide(i).squaredNorm();
    for (const CellBoundary& side : f.diagram.boundary(i)) {
      const auto j = static_cast<std::size_t>(side.neighbor);
      const double mass = 0.5 * (f.diagram.cells[i].mass + f.diagram.cells[j].mass);
      sum += 0.5 * 0.4 * mass * (slide(i) - slide(j)).squaredNorm();  // each pair comes twice
    }
  }
  EXPECT_NEAR(f.total(), kScale * sum, 1e-12 * sum);
}

TEST(Anchoring, HasAnExactGradient) {
  Fixture f({.stickiness = 0.2, .smoothing = 0.5});
  constexpr double kStep = 1e-5;
  for (std::size_t k = 0; k < f.positions.size(); k += 9) {
    const Vec3 gradient = f.anchoring.gradient(f.positions, k);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double at = f.positions[k][axis];
      f.positions[k][axis] = at + kStep;
      const double more = f.total();
      f.positions[k][axis] = at - kStep;
      const double less = f.total();
      f.positions[k][axis] = at;
      EXPECT_NEAR((more - less) / (2.0 * kStep), gradient[axis], 1e-6 * gradient.norm());
    }
  }
}

TEST(Anchoring, SmoothingLeavesWhatAllSlideInCommon) {
  Fixture f({.smoothing = 1.0});
  for (std::size_t k = 0; k < f.positions.size(); ++k)
    f.positions[k] = f.anchors[k] + Vec3(0.3, 0.2, -0.1);
  EXPECT_NEAR(f.total(), 0.0, 1e-25);
}

}  // namespace
}  // namespace dapple::test
