// SPDX-License-Identifier: GPL-3.0-or-later
// Eight threads run all verbs on the same surfaces at once, and some of the calls are cancelled.
// tests/sanitize.sh runs it under ThreadSanitizer; the results are compared by bytes in any case.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <dapple/crowding.hpp>
#include <dapple/curvature.hpp>
#include <dapple/decals.hpp>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/neighbors.hpp>
#include <dapple/planar_sampler.hpp>
#include <dapple/population.hpp>
#include <dapple/progressive.hpp>
#include <dapple/projector.hpp>
#include <dapple/refine.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/refine_obstacles.hpp>
#include <dapple/relax.hpp>
#include <dapple/remesh.hpp>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>
#include <dapple/spectrum.hpp>
#include <dapple/stipple.hpp>
#include <dapple/surface_record.hpp>
#include <dapple/texture.hpp>
#include <dapple/topology.hpp>
#include <dapple/window_tracker.hpp>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <thread>

#include "changing_bodies.hpp"
#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

constexpr int kThreads = 8;
constexpr int kRounds = 3;

/// The inputs shared by all threads; they do not change.
struct Shared {
  Shape shape = blob(2);
  Surface surface = shape.surface();
  std::vector<Vec3> next = deformed(shape.vertices, 0.4);
  SampleOptions options = [] {
    SampleOptions few;
    few.optimizer.max_evaluations = 4;
    return few;
  }();
  Samples samples = sample(surface, 80, options);
  std::unique_ptr<const Plane> shared_polygon = polygon();  // cut when it is first used
  std::vector<FaceUv> uv = charts(surface.face_count());
  Image image = [] {
    Image picture{8, 8, {}};
    for (int k = 0; k < 64; ++k) picture.values.push_back(k % 7 / 6.0);
    return picture;
  }();

  static std::unique_ptr<const Plane> polygon() {
    return std::make_unique<const Plane>(
        Plane::polygon({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}));
  }
  static std::vector<FaceUv> charts(std::size_t faces) {
    Random random(1);
    std::vector<FaceUv> uv(faces);
    for (FaceUv& row : uv)
      for (Vec2& corner : row) corner = {random.uniform(), random.uniform()};
    return uv;
  }
};

/// Numbers that identify a result.
using Outcome = std::vector<double>;
using Work = std::function<Outcome(const Shared&, Context*)>;

Outcome of(const std::vector<Vec3>& points) {
  Outcome result;
  for (const Vec3& p : points) result.insert(result.end(), {p.x(), p.y(), p.z()});
  return result;
}

Outcome flat(const std::vector<Vec2>& points) {
  Outcome result;
  for (const Vec2& p : points) result.insert(result.end(), {p.x(), p.y()});
  return result;
}

Outcome tracked(const Shared& s, Context* context) {
  TrackerOptions options;
  options.optimizer.max_evaluations = 3;
  Tracker tracker(s.surface, s.samples, options, context);
  return of(tracker.advance(s.next, context).positions);
}

Outcome windowed(const Shared& s, Context* context) {
  WindowOptions options;
  options.tracker.optimizer.max_evaluations = 2;
  const std::vector<std::vector<Vec3>> frames = {s.next, s.shape.vertices};
  return of(track_window(s.surface, s.samples, frames, options, context).back().positions);
}

const std::vector<Work>& works() {
  static const std::vector<Work> kWorks = {
      [](const Shared& s, Context* c) { return of(sample(s.surface, 90, s.options, c).positions); },
      [](const Shared& s, Context* c) {
        const std::vector<SampleClass> classes = {{.count = 30}, {.count = 50}};
        ClassOptions options;
        options.sample = s.options;
        return of(sample_classes(s.surface, classes, options, c).positions);
      },
      [](const Shared& s, Context* c) {
        return of(
            resample(s.surface, s.samples, 95, {.optimizer = s.options.optimizer}, c).positions);
      },
      [](const Shared& s, Context* c) {
        std::vector<std::int32_t> faces(s.surface.face_count() / 3);
        std::iota(faces.begin(), faces.end(), 0);
        RelaxOptions options;
        options.optimizer = s.options.optimizer;
        return of(relax(s.surface, s.samples, faces, options, c).positions);
      },
      tracked,
      [](const Shared& s, Context* c) {
        PopulationOptions options;
        options.tracker.optimizer.max_evaluations = 3;
        Population population(s.surface, s.samples, options, c);
        return of(population.advance(s.next, c).positions);
      },
      windowed,
      [](const Shared& s, Context* c) {
        return flat(sample(*s.shared_polygon, 40, s.options, c).positions);
      },
      [](const Shared& s, Context* c) {
        return of(mosaic(s.surface, s.samples, MosaicOptions{.grout = 0.01}, c).vertices);
      },
      [](const Shared& s, Context* c) {
        RemeshOptions options;
        options.optimizer.max_evaluations = 3;
        return of(remesh(s.surface, 90, options, c).vertices);
      },
      [](const Shared& s, Context* c) { return curvedness(s.surface, 3, c); },
      [](const Shared& s, Context* c) {
        return of(refine_edges(s.surface, std::vector{0.2}, 20'000, c).surface.vertices());
      },
      [](const Shared& s, Context* c) {
        return Projector(s.surface, false, c).project(s.next, {}, c).distances;
      },
      [](const Shared& s, Context*) { return nearest_distances(s.samples.positions); },
      [](const Shared& s, Context*) { return of(away_from_neighbors(s.samples.positions)); },
      [](const Shared& s, Context* c) {
        const auto ranks = progressive_ranks(s.samples.positions, {}, c);
        return Outcome(ranks.begin(), ranks.end());
      },
      [](const Shared& s, Context* c) {
        const Surface back = restored(record_of(s.surface.deformed(s.next, c)), c);
        return of(back.corner_normals());
      },
      [](const Shared& s, Context*) {
        const Topology found = topology(s.surface);
        return Outcome{double(found.genus), double(found.components)};
      },
      [](const Shared& s, Context* c) {
        const Energy energy =
            evaluate_energy(s.surface, sites_of(s.samples), 30.0, Cells::kEuclidean, c);
        return of(energy.gradient);
      },
      [](const Shared& s, Context* c) {
        const Sites sites = s.shared_polygon->start(Start::kRandom, 60, 0, c);
        return of(evaluate_energy(*s.shared_polygon, sites, 30.0, c).gradient);
      },
      [](const Shared& s, Context* c) {
        const Samples* const runs[] = {&s.samples, &s.samples};
        return surface_spectrum(s.surface, runs, {.radius = 3.0, .bins = 32}, c).power;
      },
      [](const Shared& s, Context* c) {
        const Texels found = texels(s.surface, s.uv, 24, 24, 2, c);
        const std::vector<double> radii(s.samples.size(), 0.2);
        const std::vector<Vec3> tangents(s.samples.size(), Vec3(1.0, 0.1, 0.2));
        const auto covered = decal_cover(s.surface, s.samples, radii, tangents, found, c).samples;
        return Outcome(covered.begin(), covered.end());
      },
      [](const Shared& s, Context* c) {
        return of(
            refine_image(s.surface, s.uv, s.image, {.max_faces = 4000}, c).surface.vertices());
      },
      [](const Shared& s, Context* c) {
        const std::vector<double> radii(s.samples.size(), 0.1);
        const Obstacles obstacles{.points = s.samples.positions, .radii = radii};
        return of(
            refine_obstacles(s.surface, obstacles, {.max_faces = 4000}, c).surface.vertices());
      },
      [](const Shared& s, Context* c) {
        StippleOptions options;
        options.optimizer = s.options.optimizer;
        const std::vector<Image> inks = {s.image};
        return flat(stipple_inks(inks, 50, options, c).positions);
      },
      [](const Shared& s, Context* c) {
        const Report report = analyze(s.surface, s.samples, 30.0, Cells::kConnected, c);
        return Outcome{report.energy, report.bond_order, report.evenness.alpha_min};
      }};
  return kWorks;
}

/// The same verb again, cancelled by its Context or by the thread's Poll.
void cancel(const Shared& shared, const Work& work, int turn) {
  Context context;
  Poll poll([turn] { return turn % 3 != 0; });
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::microseconds(300 * (turn % 7)));
    turn % 2 ? context.cancel() : poll.stop();
  });
  std::string stopped;
  try {
    (void)work(shared, turn % 4 ? &context : nullptr);
  } catch (const Cancelled& error) {  // expected if the cancellation came in time
    stopped = error.what();
  }
  other.join();
}

TEST(Stress, EightThreadsDoEverythingAtOnce) {
  Shared shared;
  std::vector<Outcome> expected;
  expected.reserve(works().size());
  for (const Work& work : works()) expected.push_back(work(shared, nullptr));
  shared.shared_polygon = Shared::polygon();
  std::atomic<int> turn = 0, different = 0;
  const int turns = kRounds * static_cast<int>(works().size());
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&] {
      for (int k = turn++; k < turns; k = turn++) {
        const auto which = static_cast<std::size_t>(k) % works().size();
        Context context;
        if (works()[which](shared, &context) != expected[which]) ++different;
        cancel(shared, works()[which], k);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(different, 0);
}

}  // namespace
}  // namespace dapple::test
