// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/sampler.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

SampleClass take_class(Bytes& bytes, const Surface& surface) {
  SampleClass wanted;
  wanted.count = bytes.one_in(8) ? 0 : take_count(bytes, 25);
  if (bytes.one_in(3))
    wanted.surface = answer([&] {
      const Values values = take_values(bytes, surface.vertex_count(), surface.face_count());
      return surface.with_density(values.density());
    });
  if (bytes.one_in(3)) wanted.radius = take_option(bytes, {}, 0.2 * surface.spacing(50));
  if (bytes.one_in(6)) wanted.locked = take_sites(bytes, surface, bytes.below(4));
  return wanted;
}

}  // namespace

void fuzz_classes(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  std::vector<SampleClass> classes;
  for (int k = bytes.between(1, 4); k > 0; --k) classes.push_back(take_class(bytes, *surface));
  ClassOptions options;
  take_options(bytes, options);
  const auto samples = answer_of_threads([&](int threads) {
    options.sample.threads = threads;
    return sample_classes(*surface, classes, options);
  });
  if (!samples) return;
  expect_valid(*surface, *samples);
  expect_descent(samples->report);
  for (std::size_t c = 0; c < classes.size(); ++c)
    EXPECT_EQ(count_of(samples->classes, static_cast<std::int32_t>(c)), classes[c].count)
        << "class " << c;
  std::size_t first = 0;
  for (const SampleClass& member : classes) {
    const Surface& own = member.surface ? *member.surface : *surface;
    for (std::size_t k = first + member.locked.size(); k < first + member.count; ++k)
      EXPECT_TRUE(test::is_where_dense(own, samples->faces[k], samples->barycentric[k]))
          << "sample " << k << " is where its class has no density";
    first += member.count;
  }
}

}  // namespace dapple::fuzz
