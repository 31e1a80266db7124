// SPDX-License-Identifier: GPL-3.0-or-later
// Cancels an operation at each of its checks for cancellation: the first run counts them, then each
// one is made to fail.
#include <gtest/gtest.h>

#include <dapple/domain.hpp>
#include <dapple/errors.hpp>
#include <dapple/planar.hpp>
#include <dapple/population.hpp>
#include <dapple/sampler.hpp>
#include <dapple/window_tracker.hpp>
#include <memory>
#include <thread>

#include "base/parallel.hpp"
#include "cancel_checks.hpp"
#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

SampleOptions few_evaluations(int threads) {
  SampleOptions options;
  options.optimizer.max_evaluations = 6;
  options.threads = threads;
  return options;
}

class CancelWithThreads : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Threads, CancelWithThreads, testing::Values(1, 2));

TEST_P(CancelWithThreads, EverywhereInASample) {
  const Surface surface = two_sheets(4, 0.02).surface();  // uncovered faces make all passes run
  const SampleOptions options = few_evaluations(GetParam());
  const Samples expected = sample(surface, 120, options);
  cancel_everywhere([&](Context* context) { (void)sample(surface, 120, options, context); }, [] {});
  EXPECT_TRUE(same_bytes(sample(surface, 120, options), expected))
      << "a cancelled run left something behind";
}

TEST_P(CancelWithThreads, EverywhereInATrackedFrame) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  const std::vector<Vec3> next = deformed(shape.vertices, 0.8);
  TrackerOptions options;
  options.threads = GetParam();
  options.optimizer.max_evaluations = 6;
  const Samples samples = sample(surface, 120);
  const Tracker fresh(surface, samples, options);
  Tracker tracker = fresh;
  cancel_everywhere(advancing(fresh, tracker, next), [&] {
    EXPECT_TRUE(same_bytes(tracker.samples(), fresh.samples()));
    EXPECT_TRUE(same_bytes(tracker.surface().vertices(), shape.vertices));
  });
  Tracker untouched = fresh;
  EXPECT_TRUE(same_bytes(tracker.advance(next), untouched.advance(next)));
}

/// Every operation that computes checks more than once.
TEST(Cancel, AnUnchangedFrameChecksOnce) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  const Samples samples = sample(surface, 120);
  Tracker tracker(surface, samples);
  EXPECT_EQ(count_checks([&](Context* context) { tracker.advance(shape.vertices, context); }), 1);
  Population population(surface, samples);
  EXPECT_EQ(count_checks([&](Context* context) { population.advance(shape.vertices, context); }),
            1);
  EXPECT_EQ(population.samples().report.evaluations, 0);
}

/// The sweeps check only once, because all frames are equal.
TEST(Cancel, AnUnchangedWindowChecksRarely) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  const Samples samples = sample(surface, 120);
  const auto checks_of = [&](std::size_t frames) {
    const std::vector<std::vector<Vec3>> still(frames, shape.vertices);
    return count_checks(
        [&](Context* context) { (void)track_window(surface, samples, still, {}, context); });
  };
  const int by_itself = 4;  // the pass and its tracker, and each sweep
  EXPECT_EQ(checks_of(10) - checks_of(5), 5 * by_itself);
}

TEST(Cancel, EverywhereInAPoissonStart) {
  const Surface surface = blob(3).surface();
  const SampleOptions options = [] {
    SampleOptions only_start;
    only_start.optimizer.max_evaluations = 1;
    return only_start;
  }();
  cancel_everywhere([&](Context* context) { (void)sample(surface, 2000, options, context); },
                    [] {});
}

// ---- a check that works itself, as a signal's handler in Python may ----

/// Start `work` once per check and there run all of it on the same object.
/// \param make makes a fresh object
template <typename Make, typename Use>
void work_at_each_check(const Make& make, const Use& use) {
  const int total = count_checks([&](Context* context) { use(*make(), context); });
  ASSERT_GT(total, 1);
  for (int k = 1; k <= total; ++k) {
    const auto object = make();
    Context context, another;
    int left = k;
    std::function<void()> at_check = [&] {
      if (--left == 0)
        use(*object, &another);
      else
        at_next_check = at_check;
    };
    at_next_check = at_check;
    use(*object, &context);
    at_next_check = {};
    EXPECT_LE(left, 0) << "check " << k << " of " << total;
  }
}

TEST(ACheckThatWorks, MayCutTheDomainThatIsBeingCut) {
  const std::vector<Vec2> outline = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}};
  const Plane first = Plane::polygon(outline);
  const Sites sites = first.start(Start::kRandom, 400, 0, nullptr);
  const double expected = first.cells(sites, nullptr).cells[7].area;
  work_at_each_check(
      [&] { return std::make_unique<Plane>(Plane::polygon(outline)); },
      [&](const Plane& domain, Context* context) {
        with_threads(1, [&] { EXPECT_EQ(domain.cells(sites, context).cells[7].area, expected); });
      });
}

TEST(ACheckThatWorks, MayUseTheSurfaceDomainThatIsBeingMade) {
  const Surface surface = grid(1).surface();
  const Sites sites = sites_of(sample(surface, 300, {.optimizer = {.max_evaluations = 1}}));
  const double expected = SurfaceDomain(surface).cells(sites, nullptr).cells[7].area;
  const std::vector<Vec3> points(3, Vec3(2.0, 1.0, 0.5));
  work_at_each_check([&] { return std::make_unique<SurfaceDomain>(surface); },
                     [&](const SurfaceDomain& domain, Context* context) {
                       with_threads(1, [&] {
                         EXPECT_EQ(domain.cells(sites, context).cells[7].area, expected);
                         EXPECT_EQ(domain.project(points, {}, context).size(), points.size());
                       });
                     });
}

/// Cancels from another thread while hundreds of evaluations remain.
TEST(Cancel, FromAnotherThreadWhileItWorks) {
  const Surface surface = blob(4).surface();
  SampleOptions options;
  options.optimizer.tolerance = 0.0;
  options.optimizer.max_evaluations = 500;
  cancel_at = kNever;
  for (const double when : {0.0, 0.01, 0.05, 0.2}) {
    Context context;
    std::jthread watcher([&] {
      while (context.progress() < when) std::this_thread::yield();
      context.cancel();
    });
    EXPECT_THROW((void)sample(surface, 2000, options, &context), Cancelled)
        << "at progress " << when;
  }
}

TEST(Cancel, ProgressNeverFalls) {
  const Surface surface = blob(4).surface();
  cancel_at = kNever;
  Context context;
  std::vector<double> seen;
  {
    std::jthread watcher([&](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const double now = context.progress();
        if (seen.empty() || now != seen.back()) seen.push_back(now);
        std::this_thread::yield();
      }
    });
    (void)sample(surface, 2000, {}, &context);
  }
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_GT(seen.size(), 3u) << "progress hardly moves";
  EXPECT_EQ(context.progress(), 1.0);
}

}  // namespace
}  // namespace dapple::test
