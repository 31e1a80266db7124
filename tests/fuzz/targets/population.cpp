// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/population.hpp>
#include <dapple/sampler.hpp>
#include <set>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

/// A frame that does not ask for so many samples that it takes long.
std::vector<Vec3> take_small_frame(Bytes& bytes, const Surface& surface) {
  std::vector<Vec3> frame = take_frame(bytes, surface.vertices());
  const auto moved = answer([&] { return surface.deformed(frame); });
  if (moved && moved->area() > 4.0 * surface.area()) return surface.vertices();
  return frame;
}

void expect_fades(const Samples& samples) {
  EXPECT_EQ(samples.fade.size(), samples.size());
  for (const double fade : samples.fade) {
    EXPECT_GE(fade, 0.0);
    EXPECT_LE(fade, 1.0);
  }
}

/// An id that has gone does not come back.
void expect_new_ids(const Samples& before, const Samples& after, std::set<std::int32_t>& gone) {
  const std::set<std::int32_t> now(after.ids.begin(), after.ids.end());
  for (const std::int32_t id : now) EXPECT_EQ(gone.count(id), 0u) << "id " << id;
  for (const std::int32_t id : before.ids)
    if (now.count(id) == 0) gone.insert(id);
}

std::vector<Samples> run(Population& population, std::span<const std::vector<Vec3>> frames) {
  std::vector<Samples> result;
  std::set<std::int32_t> gone;
  for (const std::vector<Vec3>& frame : frames) {
    const Samples before = population.samples();
    const auto after = answer([&] { return population.advance(frame); });
    if (!after) {
      EXPECT_TRUE(same_bytes(population.samples(), before)) << "refused, and changed";
    }
    if (!after) continue;
    test::check_on_surface(population.surface(), {after->positions, after->faces},
                           after->barycentric);
    expect_fades(*after);
    expect_new_ids(before, *after, gone);
    result.push_back(*after);
  }
  return result;
}

}  // namespace

void fuzz_population(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  const auto first = take_samples(bytes, *surface);
  if (!first) return;
  PopulationOptions options;
  take_options(bytes, options);
  std::vector<std::vector<Vec3>> frames;
  for (int k = bytes.between(1, 5); k > 0; --k) frames.push_back(take_small_frame(bytes, *surface));
  (void)answer_of_threads([&](int threads) {
    options.tracker.threads = threads;
    Population population(*surface, *first, options);
    return run(population, frames);
  });
}

}  // namespace dapple::fuzz
