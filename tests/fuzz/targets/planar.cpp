// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
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
  return std::make_unique<Plane>(Plane::polygon(outline, holes));
}

/// A domain and what its image's values lie on.
struct Ground {
  std::unique_ptr<FlatDomain> domain;
  Vec2 size = Vec2::Ones();  // of the image
  bool periodic = false;
};

Ground take_rectangle(Bytes& bytes, const Image* image) {
  const double width = take_length(bytes);
  const Vec2 size(width, take_length(bytes));
  Plane domain =
      image ? Plane::image(size.x(), size.y(), *image) : Plane::rectangle(size.x(), size.y());
  return {std::make_unique<Plane>(std::move(domain)), size};
}

Ground take_ground(Bytes& bytes) {
  switch (bytes.below(5)) {
    case 0:
      return take_rectangle(bytes, nullptr);
    case 1: {
      const Image image = take_image(bytes, 0.0);
      return take_rectangle(bytes, &image);
    }
    case 2:
      return {take_polygon(bytes)};
    case 3:
      return {std::make_unique<Torus>(), Vec2::Ones(), true};
    default:
      return {std::make_unique<Torus>(take_image(bytes, 0.0)), Vec2::Ones(), true};
  }
}

/// Between which two pixels a coordinate lies, in pixels, and how far from the first.
struct Between {
  std::size_t first, second;
  double share;
};

Between between(double x, std::size_t count, bool periodic) {
  const double low = std::floor(x - 0.5), last = static_cast<double>(count) - 1.0;
  const auto pixel = [&](double k) {
    return static_cast<std::size_t>(periodic ? (k < 0.0    ? last
                                                : k > last ? 0.0
                                                           : k)
                                             : std::clamp(k, 0.0, last));
  };
  return {pixel(low), pixel(low + 1.0), x - 0.5 - low};
}

/// Whether an image that is linear on triangles between the centers of its pixels is above 0.
bool is_dense(const Ground& ground, const Image& image, const Vec2& p) {
  const auto columns = static_cast<double>(image.columns), rows = static_cast<double>(image.rows);
  const Between x = between(p.x() / ground.size.x() * columns, image.columns, ground.periodic);
  const Between y = between(p.y() / ground.size.y() * rows, image.rows, ground.periodic);
  const auto dense = [&](std::size_t column, std::size_t row, double weight) {
    return weight > 0.0 && image.values[row * image.columns + column] > 0.0;
  };
  if (dense(x.first, y.first, 1.0 - std::max(x.share, y.share))) return true;
  if (dense(x.second, y.second, std::min(x.share, y.share))) return true;
  return x.share > y.share ? dense(x.second, y.first, x.share - y.share)
                           : dense(x.first, y.second, y.share - x.share);
}

void expect_dense(const Ground& ground, const Image* image, const Vec2& p) {
  EXPECT_TRUE(!image || is_dense(ground, *image, p))
      << "a sample at (" << p.x() << ", " << p.y() << ") is where the density is 0";
}

void expect_points(const FlatDomain& domain, const PlanarSamples& samples) {
  for (const Vec2& p : samples.positions) EXPECT_TRUE(p.allFinite());
  EXPECT_NO_THROW((void)domain.sites(samples.positions)) << "a point is outside";
  expect_descent(samples.report);
  expect_measured(samples.report);
}

void fuzz_planar_classes(Bytes& bytes, const Ground& ground) {
  const FlatDomain& domain = *ground.domain;
  std::vector<SampleClass> classes(static_cast<std::size_t>(bytes.between(1, 3)));
  for (SampleClass& one : classes) {
    one.count = take_count(bytes, 20);
    if (domain.density() && bytes.one_in(3)) {
      one.image = *domain.density();
      for (double& value : one.image->values) value = bytes.byte() / 32.0;
      take_zeros(bytes, *one.image);
    }
    if (bytes.one_in(4)) one.radius = take_option(bytes, {}, 0.1 * domain.spacing(40));
  }
  ClassOptions options;
  take_options(bytes, options);
  const auto samples = answer_of_threads([&](int threads) {
    options.sample.threads = threads;
    return sample_classes(domain, classes, options);
  });
  if (!samples) return;
  expect_points(domain, *samples);
  for (std::size_t k = 0; k < samples->positions.size(); ++k) {
    const SampleClass& own = classes[static_cast<std::size_t>(samples->classes[k])];
    expect_dense(ground, own.image ? &*own.image : domain.density(), samples->positions[k]);
  }
  for (std::size_t c = 0; c < classes.size(); ++c)
    EXPECT_EQ(count_of(samples->classes, static_cast<std::int32_t>(c)), classes[c].count);
}

}  // namespace

void fuzz_planar(Bytes& bytes) {
  const auto ground = answer([&] { return take_ground(bytes); });
  if (!ground) return;
  const FlatDomain& domain = *ground->domain;
  if (bytes.one_in(3)) return fuzz_planar_classes(bytes, *ground);
  const std::size_t count = take_count(bytes);
  SampleOptions options;
  take_options(bytes, options);
  const auto samples = answer_of_threads([&](int threads) {
    options.threads = threads;
    return sample(domain, count, options);
  });
  if (!bytes.was_wild()) {
    EXPECT_TRUE(samples) << "what is plain is refused";
  }
  if (!samples) return;
  EXPECT_EQ(samples->positions.size(), count);
  expect_points(domain, *samples);
  for (const Vec2& p : samples->positions) expect_dense(*ground, domain.density(), p);
}

}  // namespace dapple::fuzz
