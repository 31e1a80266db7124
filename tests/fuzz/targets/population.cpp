// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/population.hpp>
#include <dapple/sampler.hpp>
#include <set>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

constexpr double kMostGrowth = 2.0;  // or a frame asks for so many samples that it takes long

bool grows_too_much(const Surface& now, const Surface& before) {
  return now.area() > kMostGrowth * before.area() ||
         now.capacity() > kMostGrowth * before.capacity();
}

std::vector<Vec3> take_small_frame(Bytes& bytes, const Surface& surface) {
  std::vector<Vec3> frame = take_frame(bytes, surface.vertices());
  const auto moved = answer([&] { return surface.deformed(frame); });
  if (moved && grows_too_much(*moved, surface)) return surface.vertices();
  return frame;
}

/// Of the same faces, moved, or a surface of others.
struct Frame {
  std::vector<Vec3> vertices;
  std::optional<Surface> other;
};

/// The body without some of its faces, or with all of them apart, or another body.
std::optional<Surface> take_other(Bytes& bytes, const Shape& shape, const Surface& first) {
  Shape other = shape;
  switch (bytes.below(3)) {
    case 0:
      other.faces.resize(1 + bytes.whole() % shape.faces.size());
      if (shape.density_at != DensityAt::kVertices) other.density.clear();
      break;
    case 1:
      other = test::soup(shape);
      break;
    default:
      other = take_shape(bytes);
  }
  other.vertices = take_frame(bytes, other.vertices);
  const auto surface = take_surface(bytes, other);
  return surface && !grows_too_much(*surface, first) ? surface : std::nullopt;
}

/// Some frames become surfaces of other faces, which those after them move.
void take_others(Bytes& bytes, const Shape& shape, const Surface& first,
                 std::vector<Frame>& frames) {
  std::optional<Surface> now;
  for (Frame& frame : frames)
    if (bytes.one_in(2)) {
      frame.other = take_other(bytes, shape, first);
      if (frame.other) now = frame.other;
    } else if (now) {
      frame.vertices = take_small_frame(bytes, *now);
    }
}

/// A density of its own only where no frame makes much more of it.
std::vector<SampleClass> take_kinds(Bytes& bytes, const Surface& surface,
                                    std::span<const Frame> frames) {
  std::vector<SampleClass> kinds(static_cast<std::size_t>(bytes.between(1, 3)));
  for (SampleClass& kind : kinds) {
    const Values values = take_values(bytes, surface.vertex_count(), surface.face_count());
    kind.surface = answer([&] { return surface.with_density(values.density()); });
    for (const Frame& frame : frames) {
      if (!kind.surface) break;
      const auto moved = answer([&] { return kind.surface->deformed(frame.vertices); });
      if (moved && grows_too_much(*moved, *kind.surface)) kind.surface = std::nullopt;
    }
  }
  return kinds;
}

const Samples& advance(Population& population, const Frame& frame) {
  return frame.other ? population.advance(*frame.other) : population.advance(frame.vertices);
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

/// What follows from a state that is kept is what follows without.
void expect_to_go_on(const Population& begun, const Population& population, const Frame& frame) {
  Population resumed = begun, whole = population;
  resumed.resume(population.surface(), population.samples(), population.state());
  auto expected = answer([&] { return advance(whole, frame); });
  auto found = answer([&] { return advance(resumed, frame); });
  EXPECT_EQ(found.has_value(), expected.has_value()) << "only one of them is refused";
  if (!found || !expected) return;
  found->report = expected->report = {};  // one that rests remembers what it measured before
  EXPECT_TRUE(same_bytes(*found, *expected)) << "resumes with different bytes";
}

template <typename T>
void damage(Bytes& bytes, std::vector<T>& values, const T& value) {
  if (values.empty() || bytes.one_in(4))
    values.push_back(value);
  else if (bytes.one_in(4))
    values.pop_back();
  else
    values[bytes.whole() % values.size()] = value;
}

void damage(Bytes& bytes, PopulationState& state) {
  switch (bytes.below(8)) {
    case 0:
      return damage(bytes, state.fades, bytes.wild());
    case 1:
      return damage(bytes, state.first_faces, static_cast<std::int32_t>(bytes.whole()));
    case 2:
      return damage(bytes, state.first_barycentric, Vec3(bytes.wild(), 0.0, 1.0));
    case 3:
      return damage(bytes, state.starts, std::size_t{bytes.byte()});
    case 4:
      return damage(bytes, state.neighbors, std::int32_t{bytes.byte()});
    case 5:
      return damage(bytes, state.densities, bytes.wild());
    case 6:
      state.next_id = static_cast<std::int64_t>(bytes.whole());
      return;
    default:
      state.settled = !state.settled;
  }
}

/// A state that comes from a file is refused, or taken for what it says.
void expect_an_answer(Bytes& bytes, Population population) {
  PopulationState state = population.state();
  const std::vector<double> densities = state.densities;
  const Samples before = population.samples();
  damage(bytes, state);
  const bool taken = answer([&] {
                       population.resume(population.surface(), before, state);
                       return true;
                     }).has_value();
  EXPECT_TRUE(taken || same_bytes(population.samples(), before)) << "refused, and changed";
  if (!taken || state.densities != densities) return;  // others may ask for millions of samples
  const auto next = answer([&] {
    return population.surface().deformed(test::deformed(population.surface().vertices(), 0.3));
  });
  if (next && !grows_too_much(*next, population.surface()))
    (void)answer([&] { return population.advance(next->vertices()); });
}

/// All but those that vanish, which stay where they were.
void expect_where_dense_now(const Surface& surface, const Samples& after, const Samples& before) {
  for (std::size_t k = 0; k < after.size(); ++k) {
    const auto there = std::find(before.ids.begin(), before.ids.end(), after.ids[k]);
    const bool vanishes = there != before.ids.end() && after.fade[k] < 1.0;
    if (!vanishes) {
      EXPECT_TRUE(test::is_where_dense(surface, after.faces[k], after.barycentric[k])) << k;
    }
  }
}

std::vector<Samples> run(Population& population, std::span<const Frame> frames, bool resumes,
                         std::size_t kinds) {
  const Population begun = population;
  std::vector<Samples> result;
  std::set<std::int32_t> gone;
  for (const Frame& frame : frames) {
    if (resumes) expect_to_go_on(begun, population, frame);
    const Samples before = population.samples();
    const auto after = answer([&] { return advance(population, frame); });
    if (!after) {
      EXPECT_TRUE(same_bytes(population.samples(), before)) << "refused, and changed";
    }
    if (!after) continue;
    test::check_on_surface(population.surface(), {after->positions, after->faces},
                           after->barycentric);
    if (kinds == 1) expect_where_dense_now(population.surface(), *after, before);
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
  std::vector<Frame> frames;
  for (int k = bytes.between(1, 5); k > 0; --k)
    frames.push_back({take_small_frame(bytes, *surface), std::nullopt});
  if (bytes.one_in(2)) take_others(bytes, shape, *surface, frames);
  std::vector<SampleClass> kinds;
  if (bytes.one_in(4)) kinds = take_kinds(bytes, *surface, frames);
  options.tracker.classes = kinds;
  const bool resumes = bytes.one_in(4);
  (void)answer_of_threads([&](int threads) {
    options.tracker.threads = threads;
    Population population(*surface, *first, options);
    auto result = run(population, frames, resumes && threads == 1, kinds.size() + 1);
    if (threads == 1 && !bytes.empty()) expect_an_answer(bytes, population);
    return result;
  });
}

}  // namespace dapple::fuzz
