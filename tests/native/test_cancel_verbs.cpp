// SPDX-License-Identifier: GPL-3.0-or-later
// Every verb, cancelled at each check, and its progress.
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
#include <utility>

#include "cancel_checks.hpp"
#include "changing_bodies.hpp"
#include "invariants.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

std::ptrdiff_t distinct(std::vector<double> sorted) {
  return std::unique(sorted.begin(), sorted.end()) - sorted.begin();
}

/// \param longest_leap the largest allowed increase of the progress between two checks
void expect_watched(const Work& work, double longest_leap = 0.6) {
  cancel_everywhere(work, [] {});
  expect_honest_progress(work, longest_leap);
}

/// A frame that is cancelled leaves the samples as they were.
/// \param next vertices, or a surface of other faces
template <typename Next>
void expect_frame_watched(const Population& fresh, const Next& next) {
  Population population = fresh;
  cancel_everywhere(advancing(fresh, population, next),
                    [&] { EXPECT_TRUE(same_bytes(population.samples(), fresh.samples())); });
  expect_honest_progress([&](Context* context) { Population(fresh).advance(next, context); });
}

OptimizerOptions few_steps() { return {.max_evaluations = 4}; }

TEST(Watched, ASample) {
  const Surface surface = blob(2).surface();
  expect_watched(
      [&](Context* context) { (void)sample(surface, 100, {.optimizer = few_steps()}, context); });
}

TEST(Watched, ALattice) {
  const Surface surface = blob(2).surface();
  const SampleOptions options = {.optimizer = {.capacity_weight = 1.0, .max_evaluations = 2}};
  expect_watched([&](Context* context) { (void)sample(surface, 600, options, context); });
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
  const std::vector<Vec3> moved = deformed(large.vertices, 1.0);
  const std::vector<double> seen =
      expect_honest_progress([&](Context* context) { (void)surface.deformed(moved, context); });
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
  expect_frame_watched(fresh, next);
}

TEST(Watched, AFrameOfOtherFaces) {
  const Shape moved = mapped(
      // leaves unevenness to correct
      remeshed(1), [](const Vec3& p) { return Vec3(1.2 * p.x(), p.y(), p.z()); });
  const Surface first = remeshed(0).surface(), next = moved.surface();
  const Population fresh(first, sample(first, 80), {.tracker = {.optimizer = few_steps()}});
  expect_frame_watched(fresh, next);
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

TEST(Watched, TheRemeshOfTheNextSurface) {
  const Surface before = remeshed(0).surface(), next = remeshed(1).surface();
  const RemeshResult mesh = remesh(before, 100);
  expect_watched([&](Context* context) {
    (void)remesh_next(before, mesh, next, before.capacity() / 100.0, {}, context);
  });
}

TEST(Watched, AnAdaptedRemesh) {
  const Surface surface = blob(1).surface();
  expect_watched([&](Context* context) { (void)remesh(surface, 20, {.adaptive = true}, context); });
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
  std::vector<Vec3> moved = surface.vertices();
  for (std::size_t v = moved.size() / 2; v < moved.size(); ++v) moved[v].y() += 0.3;
  expect_watched([&](Context* context) {
    (void)refine_outside(surface, {.edge = 0.1, .poses = {moved}}, context);
  });
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

}  // namespace
}  // namespace dapple::test
