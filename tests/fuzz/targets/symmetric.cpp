// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/symmetric_samples.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

/// The shape beside its mirror image across x = 0.
Shape with_image(const Shape& shape) {
  const Shape image = test::mapped(shape, [](const Vec3& p) { return Vec3(-p[0], p[1], p[2]); });
  return test::joined(shape, image);
}

bool same(const SymmetricSamples& a, const SymmetricSamples& b) {
  return same_bytes(a.samples, b.samples) && a.mirror == b.mirror &&
         a.mirror_error == b.mirror_error;
}

}  // namespace

void fuzz_symmetric(Bytes& bytes) {
  Shape shape = take_shape(bytes);
  if (!bytes.one_in(4)) shape = with_image(shape);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const std::size_t count = take_count(bytes);
  SymmetryOptions options;
  take_options(bytes, options.sample);
  if (bytes.one_in(4)) options.max_mirror_error = bytes.power(-4, 2);
  if (bytes.one_in(8))
    options.normal = {bytes.between(-1.0, 1.0), bytes.between(-1.0, 1.0), bytes.wild()};
  if (bytes.one_in(8)) options.point = {bytes.wild(), bytes.between(-1.0, 1.0), 0.0};
  const auto at = [&](int threads) {
    options.sample.threads = threads;
    return sample_symmetric(*surface, count, options);
  };
  const auto found = answer([&] { return at(1); }), again = answer([&] { return at(2); });
  ASSERT_EQ(found.has_value(), again.has_value()) << "one number of threads is refused";
  if (!found) return;
  EXPECT_TRUE(same(*found, *again)) << "two threads differ";
  ASSERT_EQ(found->samples.size(), count);
  ASSERT_EQ(found->mirror.size(), count);
  expect_valid(*surface, found->samples);
  expect_descent(found->samples.report);
  for (std::size_t k = 0; k < count; ++k) {
    ASSERT_LT(static_cast<std::size_t>(found->mirror[k]), count);
    EXPECT_EQ(found->mirror[static_cast<std::size_t>(found->mirror[k])],
              static_cast<std::int32_t>(k));
  }
}

}  // namespace dapple::fuzz
