// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/resample.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

/// The same faces over moved vertices or with another density; as it was where that is refused.
Surface take_changed(Bytes& bytes, const Surface& surface) {
  const auto changed = answer([&] {
    const Surface moved =
        bytes.one_in(4) ? surface.deformed(take_frame(bytes, surface.vertices())) : surface;
    const Values values = take_values(bytes, surface.vertex_count(), surface.face_count());
    return bytes.one_in(2) ? moved.with_density(values.density()) : moved;
  });
  return changed.value_or(surface);
}

/// Those that stay come first, in their order; new ids follow the largest.
void expect_ids_kept(const Samples& before, const Samples& after) {
  if (before.size() == 0) return;
  const std::int32_t largest = *std::max_element(before.ids.begin(), before.ids.end());
  std::size_t at = 0;
  std::size_t k = 0;
  for (; k < after.size() && after.ids[k] <= largest; ++k) {
    while (at < before.size() && before.ids[at] != after.ids[k]) ++at;
    EXPECT_LT(at, before.size()) << "id " << after.ids[k] << " is out of its order";
  }
  std::int32_t next = largest;
  for (; k < after.size(); ++k) EXPECT_EQ(after.ids[k], ++next);
}

}  // namespace

void fuzz_resample(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const auto before = take_samples(bytes, *surface);
  if (!before) return;
  const Surface changed = take_changed(bytes, *surface);
  const std::size_t count = take_count(bytes);
  ResampleOptions options;
  take_options(bytes, options);
  std::vector<std::int32_t> locked, ids;
  if (before->size() > 0 && bytes.one_in(3))
    for (int k = bytes.below(8); k > 0; --k)
      locked.push_back(static_cast<std::int32_t>(bytes.whole() % before->size()));
  for (const std::int32_t k : locked) ids.push_back(before->ids[static_cast<std::size_t>(k)]);
  if (locked.size() > count) bytes.set_wild();
  options.locked = locked;
  const auto samples = answer_of_threads([&](int threads) {
    options.threads = threads;
    return resample(changed, *before, count, options);
  });
  if (!bytes.was_wild()) {
    EXPECT_TRUE(samples) << "what is plain is refused";
  }
  if (!samples) return;
  EXPECT_EQ(samples->size(), count);
  expect_valid(changed, *samples);
  expect_where_dense(changed, *samples, ids);
  expect_filled(changed, *samples, options.cells, ids);
  expect_ids_kept(*before, *samples);
  for (const std::int32_t id : ids)
    EXPECT_EQ(std::count(samples->ids.begin(), samples->ids.end(), id), 1) << "locked id " << id;
}

}  // namespace dapple::fuzz
