// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/progressive.hpp>
#include <dapple/sampler.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

/// On a face that is there twice, they are on the one that counts.
void expect_locked(const Surface& surface, const Samples& samples, Sites locked) {
  surface.move_to_counted(locked.faces, locked.barycentric);
  for (std::size_t k = 0; k < locked.size(); ++k) {
    EXPECT_EQ(samples.positions[k], locked.positions[k]) << "locked site " << k << " has moved";
    EXPECT_EQ(samples.faces[k], locked.faces[k]);
  }
}

void expect_ranks(const Samples& samples) {
  std::vector<std::int32_t> ranks = progressive_ranks(samples.positions, samples.classes);
  std::sort(ranks.begin(), ranks.end());
  for (std::size_t k = 0; k < ranks.size(); ++k) EXPECT_EQ(ranks[k], static_cast<std::int32_t>(k));
}

}  // namespace

void fuzz_sample(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const std::size_t count = take_count(bytes);
  SampleOptions options;
  take_options(bytes, options);
  if (bytes.one_in(4)) options.locked = take_sites(bytes, *surface, bytes.below(8));
  const auto samples = answer_of_threads([&](int threads) {
    options.threads = threads;
    return sample(*surface, count, options);
  });
  if (options.locked.size() > count) bytes.set_wild();
  if (!bytes.was_wild()) {
    EXPECT_TRUE(samples) << "what is plain is refused";
  }
  if (!samples) return;
  EXPECT_EQ(samples->size(), count);
  expect_valid(*surface, *samples);
  const std::vector<std::int32_t> locked(
      samples->ids.begin(),
      samples->ids.begin() + static_cast<std::ptrdiff_t>(options.locked.size()));
  expect_where_dense(*surface, *samples, locked);
  expect_filled(*surface, *samples, options.cells, locked);
  expect_locked(*surface, *samples, options.locked);
  expect_descent(samples->report);
  expect_ranks(*samples);
}

}  // namespace dapple::fuzz
