// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/planar_sampler.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

double take_length(Bytes& bytes) { return bytes.one_in(32) ? bytes.wild() : bytes.power(-3, 3); }

std::vector<Vec2> take_ring(Bytes& bytes, const Vec2& middle, double radius) {
  std::vector<Vec2> ring;
  const int count = bytes.between(3, 12);
  const bool star = bytes.one_in(2);
  for (int k = 0; k < count; ++k) {
    const double far = star ? bytes.between(0.1, 1.0) : 1.0;
    ring.push_back(middle + far * radius * (Eigen::Rotation2Dd(6.283 * k / count) * Vec2::UnitX()));
  }
  if (bytes.one_in(6)) ring[bytes.whole() % ring.size()] = {bytes.between(-1, 1), bytes.wild()};
  if (bytes.one_in(6)) {
    const Vec2 other = ring[bytes.whole() % ring.size()];
    ring[bytes.whole() % ring.size()] = other;
  }
  return ring;
}

std::unique_ptr<FlatDomain> take_polygon(Bytes& bytes) {
  const std::vector<Vec2> outline = take_ring(bytes, Vec2::Zero(), 2.0);
  std::vector<std::vector<Vec2>> holes;
  for (int k = bytes.below(3); k > 0; --k) {
    const Vec2 middle{bytes.between(-1.5, 1.5), bytes.between(-1.5, 1.5)};
    holes.push_back(take_ring(bytes, middle, bytes.between(0.01, 0.8)));
  }
  return std::make_unique<PlanarDomain>(PlanarDomain::polygon(outline, holes));
}

std::unique_ptr<FlatDomain> take_domain(Bytes& bytes) {
  switch (bytes.below(5)) {
    case 0: {
      const double width = take_length(bytes);
      return std::make_unique<PlanarDomain>(PlanarDomain::rectangle(width, take_length(bytes)));
    }
    case 1: {
      const Image image = take_image(bytes, 0.0);
      const double width = take_length(bytes);
      return std::make_unique<PlanarDomain>(PlanarDomain::image(width, take_length(bytes), image));
    }
    case 2:
      return take_polygon(bytes);
    case 3:
      return std::make_unique<TorusDomain>();
    default:
      return std::make_unique<TorusDomain>(take_image(bytes, 0.0));
  }
}

void expect_points(const FlatDomain& domain, const PlanarSamples& samples) {
  for (const Vec2& p : samples.positions) EXPECT_TRUE(p.allFinite());
  EXPECT_NO_THROW((void)domain.sites(samples.positions)) << "a point is outside";
  expect_descent(samples.report);
  expect_measured(samples.report);
}

void fuzz_planar_classes(Bytes& bytes, const FlatDomain& domain) {
  std::vector<PlanarClass> classes(static_cast<std::size_t>(bytes.between(1, 3)));
  for (PlanarClass& one : classes) {
    one.count = take_count(bytes, 20);
    if (domain.density() && bytes.one_in(3)) {
      one.density = *domain.density();
      for (double& value : one.density->values) value = bytes.byte() / 32.0;
    }
    if (bytes.one_in(4)) one.radius = take_option(bytes, {}, 0.1 * domain.spacing(40));
  }
  ClassOptions options;
  take_options(bytes, options);
  const auto samples = answer_of_threads([&](int threads) {
    options.sample.threads = threads;
    return sample_planar_classes(domain, classes, options);
  });
  if (!samples) return;
  expect_points(domain, *samples);
  for (std::size_t c = 0; c < classes.size(); ++c)
    EXPECT_EQ(count_of(samples->classes, static_cast<std::int32_t>(c)), classes[c].count);
}

}  // namespace

void fuzz_planar(Bytes& bytes) {
  const auto found = answer([&] { return take_domain(bytes); });
  if (!found) return;
  const FlatDomain& domain = **found;
  if (bytes.one_in(3)) return fuzz_planar_classes(bytes, domain);
  const std::size_t count = take_count(bytes);
  SampleOptions options;
  take_options(bytes, options);
  const auto samples = answer_of_threads([&](int threads) {
    options.threads = threads;
    return sample_planar(domain, count, options);
  });
  if (!bytes.was_wild()) {
    EXPECT_TRUE(samples) << "what is plain is refused";
  }
  if (!samples) return;
  EXPECT_EQ(samples->positions.size(), count);
  expect_points(domain, *samples);
}

}  // namespace dapple::fuzz
