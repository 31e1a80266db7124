// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/relax.hpp>
#include <dapple/sampler.hpp>
#include <set>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

/// Even samples for most inputs, as relax() is for what has been solved.
std::optional<Samples> take_solved(Bytes& bytes, const Surface& surface) {
  if (bytes.one_in(3)) return take_samples(bytes, surface);
  const std::size_t count = take_count(bytes);
  return answer([&] { return sample(surface, count, {.optimizer = {.max_evaluations = 5}}); });
}

constexpr double kMostGrowth = 4.0;  // or it asks for so many samples that it takes long

/// Another density or place for a few values or vertices.
Surface take_changed(Bytes& bytes, const Surface& surface) {
  const auto changed = answer([&] {
    if (bytes.one_in(2)) return surface.deformed(take_frame(bytes, surface.vertices()));
    std::vector<double> values(surface.face_count(), 1.0);
    for (int k = bytes.below(20); k > 0; --k)
      values[bytes.whole() % values.size()] = bytes.between(0.0, 3.0);
    if (!bytes.one_in(2)) return surface.with_density({DensityAt::kFaces, values});
    const Values other = take_values(bytes, surface.vertex_count(), surface.face_count());
    return surface.with_density(other.density());
  });
  const bool grows = changed && changed->capacity() > kMostGrowth * surface.capacity();
  return changed && !grows ? *changed : surface;
}

std::vector<std::int32_t> take_changed_faces(Bytes& bytes, const Surface& before,
                                             const Surface& after) {
  std::vector<std::int32_t> faces = changed_faces(before, after);
  if (bytes.one_in(4))
    for (int k = bytes.below(8); k > 0; --k)
      faces.push_back(static_cast<std::int32_t>(bytes.whole() % before.face_count()));
  return faces;
}

RelaxOptions take_relax_options(Bytes& bytes, const Samples& samples) {
  RelaxOptions options;
  take_options(bytes, options);
  if (bytes.one_in(3)) {
    options.count = take_count(bytes);
  }
  if (samples.size() > 0 && bytes.one_in(4))
    for (int k = bytes.below(8); k > 0; --k)
      options.locked.push_back(static_cast<std::int32_t>(bytes.whole() % samples.size()));
  return options;
}

/// Deal the samples out to two or three classes, after all that was read before there were any.
void take_classes(Bytes& bytes, Samples& samples, RelaxOptions& options) {
  if (options.count || !bytes.one_in(4)) return;
  const int classes = 2 + bytes.below(2);
  for (std::int32_t& c : samples.classes) c = bytes.below(classes);
  for (int c = 0; c < classes; ++c)
    options.classes.push_back(
        {.count = take_count(bytes), .radius = bytes.one_in(2) ? bytes.between(0.0, 0.2) : 0.0});
  options.free_counts = bytes.one_in(2);
}

void expect_counts(const Samples& samples, const RelaxOptions& options) {
  for (std::size_t c = 0; c < options.classes.size() && !options.free_counts; ++c)
    EXPECT_EQ(std::count(samples.classes.begin(), samples.classes.end(), static_cast<int>(c)),
              static_cast<std::ptrdiff_t>(options.classes[c].count))
        << "class " << c;
}

std::vector<std::int32_t> ids_of(const Samples& samples, std::span<const std::int32_t> rows) {
  std::vector<std::int32_t> result;
  for (const std::int32_t k : rows) result.push_back(samples.ids[static_cast<std::size_t>(k)]);
  return result;
}

void expect_locked(const Samples& before, const Samples& after,
                   std::span<const std::int32_t> locked) {
  for (const std::int32_t id : ids_of(before, locked))
    EXPECT_EQ(std::count(after.ids.begin(), after.ids.end(), id), 1) << "locked id " << id;
}

}  // namespace

void fuzz_relax(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  auto before = take_solved(bytes, *surface);
  if (!before) return;
  const Surface after = take_changed(bytes, *surface);
  const std::vector<std::int32_t> changed = take_changed_faces(bytes, *surface, after);
  RelaxOptions options = take_relax_options(bytes, *before);
  take_classes(bytes, *before, options);
  const auto samples = answer_of_threads([&](int threads) {
    options.threads = threads;
    return relax(after, *before, changed, options);
  });
  if (!samples) return;
  expect_valid(after, *samples);
  if (options.count) {
    EXPECT_EQ(samples->size(), *options.count);
  }
  expect_counts(*samples, options);
  expect_locked(*before, *samples, options.locked);
  const std::vector<std::int32_t> locked = ids_of(*before, options.locked);
  expect_where_dense(after, *samples, locked);
  const std::set<std::int32_t> faces(changed.begin(), changed.end());
  if (faces.size() == after.face_count())  // else samples elsewhere stay as they were
    expect_filled(after, *samples, Cells::kConnected, locked);
}

}  // namespace dapple::fuzz
