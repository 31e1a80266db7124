// SPDX-License-Identifier: GPL-3.0-or-later
// Cancels an operation at each of its checks for cancellation: the first run counts them, then each
// one is made to fail. The linker redirects Context::check to the function below.
#include <gtest/gtest.h>

#include <dapple/curvature.hpp>
#include <dapple/decals.hpp>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/exposure.hpp>
#include <dapple/line_samples.hpp>
#include <dapple/mosaic.hpp>
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
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <dapple/solids.hpp>
#include <dapple/spectrum.hpp>
#include <dapple/stipple.hpp>
#include <dapple/symmetric_samples.hpp>
#include <dapple/visibility.hpp>
#include <dapple/window_tracker.hpp>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "base/parallel.hpp"
#include "changing_bodies.hpp"
#include "invariants.hpp"
#include "shapes.hpp"

namespace {

constexpr int kNever = std::numeric_limits<int>::max();
std::atomic<int> checks = 0;
std::atomic<int> cancel_at = kNever;

/// The progress of a context at each check while it is watched.
class Watch {
 public:
  void look_at(const dapple::Context* context) {
    const std::scoped_lock lock(mutex_);
    context_ = context;
    seen_.clear();
  }
  void note() {
    const std::scoped_lock lock(mutex_);
    if (context_) seen_.push_back(context_->progress());
  }
  [[nodiscard]] const std::vector<double>& seen() const { return seen_; }

 private:
  std::mutex mutex_;
  const dapple::Context* context_ = nullptr;
  std::vector<double> seen_;
};

Watch watch;
/// The action of this thread at its next check.
thread_local std::function<void()> at_next_check;

}  // namespace

extern "C" {
void __real__ZNK6dapple7Context5checkEv(const dapple::Context* context);
void __wrap__ZNK6dapple7Context5checkEv(const dapple::Context* context);

void __wrap__ZNK6dapple7Context5checkEv(const dapple::Context* context) {
  watch.note();
  if (++checks == cancel_at) const_cast<dapple::Context*>(context)->cancel();
  if (at_next_check) std::exchange(at_next_check, {})();
  __real__ZNK6dapple7Context5checkEv(context);
}
}

namespace dapple::test {
namespace {

using Work = std::function<void(Context*)>;

int count_checks(const Work& work) {
  Context context;
  checks = 0;
  cancel_at = kNever;
  work(&context);
  return checks;
}

/// Run the work once per check and cancel it there; `after` inspects the state.
void cancel_everywhere(const Work& work, const std::function<void()>& after) {
  const int total = count_checks(work);
  std::cout << total << " checks\n";
  ASSERT_GT(total, 3) << "the work hardly ever asks";
  for (int k = 1; k <= total; ++k) {
    Context context;
    checks = 0;
    cancel_at = k;
    EXPECT_THROW(work(&context), Cancelled) << "at check " << k << " of " << total;
    EXPECT_GE(context.progress(), 0.0);
    EXPECT_LE(context.progress(), 1.0);
    after();
    if (testing::Test::HasFailure()) return;
  }
  cancel_at = kNever;
}

/// Check that progress rises without large jumps and reaches 1 only after the last check.
/// \return the progress at each check
std::vector<double> expect_honest_progress(const Work& work, double longest_leap = 0.5) {
  Context context;
  checks = 0;
  cancel_at = kNever;
  watch.look_at(&context);
  work(&context);
  EXPECT_EQ(context.progress(), 1.0);
  const std::vector<double> seen = watch.seen();
  watch.look_at(nullptr);
  EXPECT_FALSE(seen.empty());
  if (seen.empty()) return seen;
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_LT(seen.back(), 1.0) << "it was said to be done while it worked";
  for (std::size_t k = 1; k < seen.size(); ++k)
    EXPECT_LE(seen[k] - seen[k - 1], longest_leap) << "at check " << k << " of " << seen.size();
  EXPECT_LE(1.0 - seen.back(), longest_leap) << "at the end";
  return seen;
}

std::ptrdiff_t distinct(std::vector<double> sorted) {
  return std::unique(sorted.begin(), sorted.end()) - sorted.begin();
}

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
  cancel_everywhere(
      [&](Context* context) {
        if (cancel_at == kNever)
          Tracker(fresh).advance(next, context);
        else
          tracker.advance(next, context);
      },
      [&] {
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

// ---- every verb: cancelled at each check, and its progress ----

/// \param longest_leap the largest allowed increase of the progress between two checks
void expect_watched(const Work& work, double longest_leap = 0.6) {
  cancel_everywhere(work, [] {});
  expect_honest_progress(work, longest_leap);
}

OptimizerOptions few_steps() { return {.max_evaluations = 4}; }

TEST(Watched, ASample) {
  const Surface surface = blob(2).surface();
  expect_watched(
      [&](Context* context) { (void)sample(surface, 100, {.optimizer = few_steps()}, context); });
}

TEST(Watched, AnEvaluation) {
  const Surface surface = blob(4).surface();
  const std::vector<double> seen = expect_honest_progress([&](Context* context) {
    (void)sample(surface, 2000, {.optimizer = {.max_evaluations = 2}}, context);
  });
  const auto half = std::lower_bound(seen.begin(), seen.end(), 0.5);
  EXPECT_GT(distinct({half, seen.end()}), 8) << "its cells come without a word";
}

TEST(Watched, ClassesInTwoStagesWithRadii) {
  const Surface surface = blob(2).surface();
  const double radius = 0.4 * surface.spacing(80);
  const std::vector<SampleClass> classes = {{.count = 20, .radius = radius},
                                            {.count = 60, .radius = radius}};
  ClassOptions options;
  options.sample.optimizer = few_steps();
  options.two_stages = true;
  expect_watched(
      [&](Context* context) { (void)sample_classes(surface, classes, options, context); });
}

TEST(Watched, ClassesInThePlane) {
  const std::vector<SampleClass> classes = {{.count = 20}, {.count = 60}};
  ClassOptions options;
  options.sample.optimizer = few_steps();
  options.two_stages = true;
  const Plane square = Plane::rectangle(1.0, 1.0);
  expect_watched(
      [&](Context* context) { (void)sample_classes(square, classes, options, context); });
  const Torus torus;
  expect_watched([&](Context* context) { (void)sample_classes(torus, classes, options, context); });
}

TEST(Watched, AnotherNumberOfSamples) {
  const Surface surface = blob(2).surface();
  const Samples samples = sample(surface, 60);
  expect_watched([&](Context* context) {
    (void)resample(surface, samples, 200, {.optimizer = few_steps()}, context);
  });
}

TEST(Watched, ClassesThatAreMadeEvenAgain) {
  const Surface surface = blob(3).surface();
  const std::vector<SampleClass> classes = {{.count = 20, .radius = 0.1}, {.count = 150}};
  const Samples samples = sample_classes(surface, classes);
  std::vector<double> density;
  for (const Vec3& x : surface.vertices()) density.push_back(x.z() > 0.7 ? 3.0 : 1.0);
  const Surface after = surface.with_density({DensityAt::kVertices, density});
  const std::vector<std::int32_t> changed = changed_faces(surface, after);
  const Work work = [&](Context* context) {
    (void)relax(after, samples, changed, {.optimizer = few_steps(), .classes = classes}, context);
  };
  expect_watched(work);
  cancel_everywhere(work, [] {});
}

TEST(Watched, APartThatIsMadeEvenAgain) {
  const Surface surface = blob(3).surface();
  const Samples samples = sample(surface, 200);
  std::vector<double> density;
  for (const Vec3& x : surface.vertices()) density.push_back(x.z() > 0.7 ? 3.0 : 1.0);
  const Surface after = surface.with_density({DensityAt::kVertices, density});
  const std::vector<std::int32_t> changed = changed_faces(surface, after);
  const Work work = [&](Context* context) {
    (void)relax(after, samples, changed, {.optimizer = few_steps()}, context);
  };
  expect_watched(work);
  cancel_everywhere(work, [] {});
}

TEST(Watched, SamplesThatArePutIn) {
  const Surface surface = blob(2).surface();
  const Samples samples = sample(surface, 60);
  const double no_optimization = 0.7;
  const std::vector<double> seen = expect_honest_progress(
      [&](Context* context) {
        (void)resample(surface, samples, 1500, {.optimizer = {.max_evaluations = 1}}, context);
      },
      no_optimization);
  EXPECT_GT(distinct(seen), 8) << "new samples come without a word";
}

TEST(Watched, SurfacesOfAllKinds) {
  const Shape loose = soup(blob(3));
  const Surface expected = loose.surface();
  expect_watched([&](Context* context) {
    const Surface surface(loose.vertices, loose.faces, Density{}, SurfaceOptions{}, context);
    EXPECT_EQ(surface.welded_faces(), expected.welded_faces());
  });
  const Shape large = blob(6);
  const Surface surface = large.surface();
  const std::vector<double> seen = expect_honest_progress(
      [&](Context* context) { (void)surface.deformed(large.vertices, context); });
  EXPECT_GT(distinct({seen.begin(), std::lower_bound(seen.begin(), seen.end(), 0.4)}), 10)
      << "room is made without a word";
  Context cancelled;
  cancelled.cancel();
  EXPECT_THROW((void)expected.deformed(loose.vertices, &cancelled), Cancelled);
  EXPECT_THROW((void)expected.with_density({}, &cancelled), Cancelled);
}

TEST(Watched, Curvature) {
  const Surface surface = blob(3).surface();
  expect_watched([&](Context* context) { (void)curvature_density(surface, {}, context); });
}

TEST(Watched, NewTrackersAndMeasures) {
  const Surface surface = blob(2).surface();
  const Samples samples = sample(surface, 400);
  const double all_covered = 0.5;
  expect_watched([&](Context* context) { (void)Tracker(surface, samples, {}, context); },
                 all_covered);
  expect_watched([&](Context* context) { (void)Population(surface, samples, {}, context); },
                 all_covered);
  expect_watched(
      [&](Context* context) { (void)analyze(surface, samples, 30.0, Cells::kConnected, context); },
      all_covered);
}

TEST(Watched, CellsOfAllKinds) {
  const Surface walls = two_sheets(4, 0.02).surface();
  const Sites sites = sites_of(sample(walls, 400));
  const double chunk = 0.2, all_covered = 0.5;
  for (const Cells cells : {Cells::kConnected, Cells::kEuclidean}) {
    // Cells that follow the surface leave no uncovered part of the two sheets to assign.
    const double leap = cells == Cells::kConnected ? all_covered : chunk;
    expect_watched(
        [&](Context* context) { (void)restricted_voronoi(walls, sites, cells, context); }, leap);
    expect_watched(
        [&](Context* context) { (void)restricted_voronoi_polygons(walls, sites, cells, context); },
        leap);
    expect_watched(
        [&](Context* context) { (void)evaluate_energy(walls, sites, 30.0, cells, context); }, leap);
  }
  std::vector<Vec2> points;
  Random random(1);
  for (int k = 0; k < 400; ++k) points.emplace_back(random.uniform(), random.uniform());
  const Plane square = Plane::rectangle(1.0, 1.0);
  const Sites on_square = square.sites(points);
  expect_watched([&](Context* context) { (void)square.cells(on_square, context); }, all_covered);
  const Torus torus;
  const Sites on_torus = torus.sites(points);
  expect_watched([&](Context* context) { (void)torus.cells(on_torus, context); }, chunk);
}

TEST(Watched, LargeFacesThatAreCut) {
  const Surface surface = grid(1).surface();
  const Sites sites = sites_of(sample(surface, 3000, {.optimizer = {.max_evaluations = 1}}));
  const std::vector<double> seen = expect_honest_progress(
      [&](Context* context) { (void)SurfaceDomain(surface).cells(sites, context); });
  const auto cutting = std::lower_bound(seen.begin(), seen.end(), 0.3);
  EXPECT_GT(distinct({seen.begin(), cutting}), 8) << "they are cut without a word";
  const double expected = SurfaceDomain(surface).cells(sites, nullptr).cells[7].area;
  std::unique_ptr<SurfaceDomain> domain;
  cancel_everywhere(
      [&](Context* context) {
        domain = std::make_unique<SurfaceDomain>(surface);
        (void)domain->cells(sites, context);
      },
      [&] { EXPECT_EQ(domain->cells(sites, nullptr).cells[7].area, expected); });
}

TEST(Watched, AProjector) {
  const Surface surface = blob(5).surface();
  const std::vector<Vec3> points(3, Vec3(2.0, 1.0, 0.5));
  const int before_the_tree = 4;
  EXPECT_GT(count_checks([&](Context* context) { (void)Projector(surface, false, context); }),
            before_the_tree)
      << "Embree is not asked";
  const std::vector<Vec3> expected = SurfaceDomain(surface).project(points, {}).positions;
  std::unique_ptr<SurfaceDomain> domain;
  cancel_everywhere(
      [&](Context* context) {
        domain = std::make_unique<SurfaceDomain>(surface);
        (void)domain->project(points, {}, context);
      },
      [&] { EXPECT_TRUE(same_bytes(domain->project(points, {}).positions, expected)); });
}

TEST(Watched, AFrameInParts) {
  const Shape shape = blob(2);
  const std::vector<Vec3> next = deformed(shape.vertices, 2.0);
  const Tracker fresh(shape.surface(), sample(shape.surface(), 80),
                      {.optimizer = few_steps(), .longest_motion = 0.1});
  expect_watched([&](Context* context) {
    Tracker tracker = fresh;
    EXPECT_GT(tracker.advance(next, context).report.parts, 1);
  });
}

TEST(Watched, AFrameOfAPopulation) {
  const Shape shape = blob(2);
  const std::vector<Vec3> next =
      mapped(shape, [](const Vec3& p) { return Vec3(1.3 * p.x(), p.y(), p.z()); }).vertices;
  const Population fresh(shape.surface(), sample(shape.surface(), 80),
                         {.tracker = {.optimizer = few_steps()}});
  Population population = fresh;
  cancel_everywhere(
      [&](Context* context) {
        if (cancel_at == kNever)
          Population(fresh).advance(next, context);
        else
          population.advance(next, context);
      },
      [&] { EXPECT_TRUE(same_bytes(population.samples(), fresh.samples())); });
  expect_honest_progress([&](Context* context) { Population(fresh).advance(next, context); });
}

TEST(Watched, AFrameOfOtherFaces) {
  const Shape moved = mapped(
      // leaves unevenness to correct
      remeshed(1), [](const Vec3& p) { return Vec3(1.2 * p.x(), p.y(), p.z()); });
  const Surface first = remeshed(0).surface(), next = moved.surface();
  const Population fresh(first, sample(first, 80), {.tracker = {.optimizer = few_steps()}});
  Population population = fresh;
  cancel_everywhere(
      [&](Context* context) {
        if (cancel_at == kNever)
          Population(fresh).advance(next, context);
        else
          population.advance(next, context);
      },
      [&] { EXPECT_TRUE(same_bytes(population.samples(), fresh.samples())); });
  expect_honest_progress([&](Context* context) { Population(fresh).advance(next, context); });
}

TEST(Watched, AWindowOfFrames) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  const Samples samples = sample(surface, 60);
  std::vector<std::vector<Vec3>> frames;
  for (const double time : {0.3, 0.6, 0.3}) frames.push_back(deformed(shape.vertices, time));
  WindowOptions options;
  options.tracker.optimizer.max_evaluations = 3;
  options.sweeps = 1;
  options.closed = true;
  expect_watched(
      [&](Context* context) { (void)track_window(surface, samples, frames, options, context); },
      0.2);
}

TEST(Watched, APieceOfAMotion) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  std::vector<std::vector<Vec3>> frames;
  for (const double time : {0.2, 0.4, 0.6, 0.8, 1.0})
    frames.push_back(deformed(shape.vertices, time));
  const std::span<const std::vector<Vec3>> all(frames);
  WindowOptions options;
  options.tracker.optimizer.max_evaluations = 3;
  options.sweeps = 1;
  WindowTracker second(surface, sample(surface, 60), options);
  (void)second.advance(all.first(3), 1);
  expect_watched(
      [&](Context* context) {
        WindowTracker tracker = second;
        (void)tracker.advance(all.subspan(1), 4, context);
      },
      0.2);
}

TEST(Watched, AMosaic) {
  const Surface surface = two_sheets(4, 0.02).surface();  // uncovered faces make all passes run
  const Samples samples = sample(surface, 120);
  expect_watched([&](Context* context) {
    (void)mosaic(surface, samples, {.grout = 0.01, .thickness = 0.01}, context);
  });
}

TEST(Watched, SamplesOnLines) {
  const Surface surface = box(4).surface();
  expect_watched([&](Context* context) { (void)sample_lines(surface, 200, {}, context); });
}

TEST(Watched, SamplesInPairs) {
  const Surface surface = with_density(box(4), [](const Vec3& p) { return 1.0 + p[0]; }).surface();
  SymmetryOptions options;
  options.point = Vec3::Constant(0.5);
  expect_watched([&](Context* context) { (void)sample_symmetric(surface, 200, options, context); });
}

TEST(Watched, ARemesh) {
  const Surface surface = box(4).surface();
  expect_watched([&](Context* context) { (void)remesh(surface, 200, {}, context); });
}

TEST(Watched, ARemeshWithinADistance) {
  const Surface surface = icosphere(1).surface();
  expect_watched(
      [&](Context* context) { (void)remesh(surface, 12, {.max_distance = 0.2}, context); });
}

TEST(Watched, Stipples) {
  Image ink{16, 16, {}}, other{16, 16, {}};
  for (int k = 0; k < 256; ++k) {
    ink.values.push_back(0.4 * (k % 16) / 16.0);
    other.values.push_back(0.4 * (k / 16) / 16.0);
  }
  const std::vector<Image> inks = {ink, other};
  expect_watched(
      [&](Context* context) { (void)stipple_inks(inks, 90, {.optimizer = few_steps()}, context); });
}

TEST(Watched, ASpectrum) {
  Random random(1);
  std::vector<Vec2> points;
  for (int k = 0; k < 100; ++k) points.emplace_back(random.uniform(), random.uniform());
  const std::vector<std::span<const Vec2>> runs = {points, points};
  expect_watched([&](Context* context) { (void)spectrum(runs, {}, context); });
}

TEST(Watched, ASpectrumOnASurface) {
  const Surface surface = blob(3).surface();
  const Samples samples = sample(surface, 300);
  const std::vector<const Samples*> runs = {&samples, &samples};
  expect_watched([&](Context* context) { (void)surface_spectrum(surface, runs, {}, context); });
}

TEST(Watched, ProgressiveRanks) {
  const Samples samples = sample(blob(3).surface(), 3000, {.optimizer = few_steps()});
  std::vector<std::int32_t> classes(samples.size());
  for (std::size_t k = 0; k < classes.size(); ++k) classes[k] = static_cast<std::int32_t>(k % 2);
  expect_watched(
      [&](Context* context) { (void)progressive_ranks(samples.positions, classes, context); });
}

TEST(Watched, Refinements) {
  const Surface surface = grid(4).surface();
  const double longest = 0.02;
  expect_watched(
      [&](Context* context) { (void)refine_edges(surface, {&longest, 1}, 100000, context); });
  std::vector<FaceUv> uv;
  for (const Face& face : surface.faces()) {
    uv.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      uv.back()[k] = surface.vertices()[static_cast<std::size_t>(face[k])].head<2>();
  }
  Image picture{8, 8, std::vector<double>(64, 0.1)};
  picture.values[27] = 1.0;
  const double few_rounds = 0.7;
  expect_watched([&](Context* context) { (void)refine_image(surface, uv, picture, {}, context); },
                 few_rounds);
  const std::vector<Vec3> points = {{0.5, 0.5, 0.0}};
  const std::vector<double> radii = {0.2};
  expect_watched(
      [&](Context* context) { (void)refine_obstacles(surface, {points, radii, {}}, {}, context); });
}

TEST(Watched, RefineOutside) {
  const Surface surface =
      joined(icosphere(3),
             mapped(icosphere(3), [](const Vec3& p) { return Vec3(p + Vec3::UnitX()); }))
          .surface();
  expect_watched([&](Context* context) { (void)refine_outside(surface, {.edge = 0.05}, context); });
  expect_watched([&](Context* context) { (void)exposure(surface, context); });
  const std::vector<Vec3> points = surface.vertices();
  expect_watched(
      [&](Context* context) { (void)seen_from(surface, {3, 1, 1, 1}, points, context); });
}

TEST(Watched, Solids) {
  const Surface surface = icosphere(4).surface();
  const std::vector<Vec3> vertices = surface.vertices();
  const std::vector<std::int32_t> counts(vertices.size() / 2, 2);
  const Solids solids{std::span(vertices).first(2 * counts.size()), counts, 0.01};
  const std::vector<Face> faces = surface.faces();
  expect_watched(
      [&](Context* context) { (void)reached_by_solids(vertices, faces, solids, context); });
  expect_watched([&](Context* context) { (void)touching_solids(solids, context); });
}

TEST(Watched, Decals) {
  const Surface surface = grid(4).surface();
  const Samples samples = sample(surface, 50);
  Texels texels;
  texels.rows = texels.columns = 128;
  for (int k = 0; k < 128 * 128; ++k) {
    texels.faces.push_back(k % 32);
    texels.barycentric.push_back(Vec3::Constant(1.0 / 3.0));
  }
  const std::vector<double> radii(50, 0.05);
  const std::vector<Vec3> tangents(50, Vec3::UnitX());
  expect_watched([&](Context* context) {
    (void)decal_cover(surface, samples, radii, tangents, texels, context);
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
