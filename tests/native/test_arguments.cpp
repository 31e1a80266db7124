// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/mman.h>
#endif

#include <dapple/decals.hpp>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/optimizer.hpp>
#include <dapple/planar_sampler.hpp>
#include <dapple/poisson_start.hpp>
#include <dapple/population.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/refine_obstacles.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/remesh.hpp>
#include <dapple/resample.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <dapple/spectrum.hpp>
#include <dapple/stipple.hpp>
#include <dapple/window_tracker.hpp>
#include <limits>

#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

using Indices = std::vector<std::int32_t>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Surface small() { return tetrahedron().surface(); }
Surface large() { return icosphere(3).surface(); }

Samples of_the_large() {
  static const Samples samples = sample(large(), 40, {.optimizer = {.max_evaluations = 2}});
  return samples;
}

/// Like of_the_large(), but only on faces that the small surface has as well.
Samples of_its_first_faces() {
  const Indices faces = {0, 1, 2, 3};
  return bind_samples(large(), faces, std::vector<Vec3>(4, Vec3::Constant(1.0 / 3.0)));
}

Samples of_the_small() {
  const Indices faces = {0, 1, 2, 3};
  return bind_samples(small(), faces, std::vector<Vec3>(4, Vec3::Constant(1.0 / 3.0)));
}

Sites sites_of(const Samples& samples) {
  return {samples.positions, samples.faces, samples.barycentric};
}

// ---- a surface, and what lies on another ----

/// A function that takes a surface and what lies on it.
struct Verb {
  std::string name;
  std::function<void(const Surface&, const Samples&)> call;
};
void PrintTo(const Verb& verb, std::ostream* out) { *out << verb.name; }

std::string verb_name(const testing::TestParamInfo<Verb>& info) { return info.param.name; }

void cover_with(const Surface& surface, const Samples& samples) {
  const std::vector<double> radii(samples.size(), 0.1);
  const std::vector<Vec3> tangents(samples.size(), Vec3(1.0, 0.3, 0.7));
  (void)decal_cover(surface, samples, radii, tangents, {1, 1, {0}, {Vec3::UnitX()}});
}

void resume_with(const Surface& surface, const Samples& samples) {
  const Indices faces(samples.size(), 0);
  const Samples own =
      bind_samples(surface, faces, std::vector<Vec3>(faces.size(), Vec3(0.2, 0.3, 0.5)));
  Tracker(surface, own).resume(surface.vertices(), samples, true);
}

/// Functions that read the positions of samples.
std::vector<Verb> readers() {
  return {
      {"Mosaic", [](const auto& s, const auto& p) { (void)mosaic(s, p); }},
      {"Cover", cover_with},
      {"Analyze", [](const auto& s, const auto& p) { (void)analyze(s, p); }},
      {"SurfaceSpectrum",
       [](const auto& s, const auto& p) {
         const Samples* run = &p;
         (void)surface_spectrum(s, {&run, 1});
       }},
      {"Locked",
       [](const auto& s, const auto& p) { (void)sample(s, 50, {.locked = sites_of(p)}); }},
      {"LockedOfAClass",
       [](const auto& s, const auto& p) {
         const std::vector<SampleClass> classes = {{.count = 3},
                                                   {.count = 50, .locked = sites_of(p)}};
         (void)sample_classes(s, classes);
       }},
  };
}

/// Functions that derive positions from faces and barycentric coordinates, followed by all others.
std::vector<Verb> binders() {
  return {
      {"Tracker", [](const auto& s, const auto& p) { (void)Tracker(s, p); }},
      {"Resume", resume_with},
      {"Population", [](const auto& s, const auto& p) { (void)Population(s, p); }},
      {"PopulationOfClasses",
       [](const auto& s, const auto& p) {
         (void)Population(s, p, {.tracker = {.classes = {{.count = 1}}}});
       }},
      {"Window",
       [](const auto& s, const auto& p) {
         const std::vector<std::vector<Vec3>> frames = {s.vertices()};
         (void)track_window(s, p, frames);
       }},
      {"WindowTracker", [](const auto& s, const auto& p) { (void)WindowTracker(s, p); }},
      {"Resample", [](const auto& s, const auto& p) { (void)resample(s, p, 30); }},
      {"ToOriginal",
       [](const auto& s, const auto& p) {
         (void)to_original(refine_edges(s, std::vector{1e9}, 100), p);
       }},
      {"FromOriginal",
       [](const auto& s, const auto& p) {
         (void)from_original(refine_edges(s, std::vector{1e9}, 100), p);
       }},
      {"Optimize",
       [](const auto& s, const auto& p) {
         (void)optimize(SurfaceDomain(s), sites_of(p), {.max_evaluations = 1});
       }},
  };
}

std::vector<Verb> by_face() {
  return {
      {"Normals", [](const auto& s, const auto& p) { (void)s.normals(p.faces, p.barycentric); }},
      {"Energy",
       [](const auto& s, const auto& p) {
         (void)evaluate_energy(s, sites_of(p), 30.0, Cells::kEuclidean);
       }},
      {"Cells", [](const auto& s,
                   const auto& p) { (void)restricted_voronoi(s, sites_of(p), Cells::kEuclidean); }},
      {"Polygons",
       [](const auto& s, const auto& p) {
         (void)restricted_voronoi_polygons(s, sites_of(p), Cells::kEuclidean);
       }},
      {"Border",
       [](const auto& s, const auto& p) {
         RestrictedVoronoi diagram;
         diagram.cells.resize(p.size());
         diagram.rows.resize(p.size());
         (void)cells_on_border(s, sites_of(p), diagram);
       }},
      {"Hints",
       [](const auto& s, const auto& p) { (void)SurfaceDomain(s).project(p.positions, p.faces); }},
      {"WalkedHints",
       [](const auto& s, const auto& p) {
         const SurfaceDomain domain(s, Cells::kConnected);
         (void)domain.project(p.positions, p.faces);
       }},
  };
}

std::vector<Verb> all_verbs() {
  std::vector<Verb> all = readers();
  for (const auto& more : {binders(), by_face()}) all.insert(all.end(), more.begin(), more.end());
  return all;
}

class EveryVerb : public testing::TestWithParam<Verb> {
 protected:
  static void expect_refused(const Samples& samples, std::initializer_list<std::string> parts) {
    expect_message<ArgumentError>([&] { GetParam().call(small(), samples); }, parts);
  }
};

INSTANTIATE_TEST_SUITE_P(Verbs, EveryVerb, testing::ValuesIn(all_verbs()), verb_name);

TEST_P(EveryVerb, RefusesFacesThatTheSurfaceDoesNotHave) {
  const std::string first = std::to_string(of_the_large().faces[0]);
  ASSERT_GT(of_the_large().faces[0], 3);
  expect_refused(of_the_large(), {"[0] is " + first, "0..3"});
  Samples far = of_the_small();
  far.faces[2] = 1 << 30;
  expect_refused(far, {"[2] is 1073741824", "0..3"});
  far.faces[2] = -1;
  expect_refused(far, {"[2] is -1", "0..3"});
}

TEST_P(EveryVerb, RefusesFacesOfAnotherNumber) {
  Samples samples = of_the_small();
  samples.faces.pop_back();
  expect_refused(samples, {"3", "4"});
}

class EveryVerbOfBindings : public EveryVerb {};

std::vector<Verb> verbs_of_bindings() {
  std::vector<Verb> all = readers();
  const std::vector<Verb> more = binders();
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

INSTANTIATE_TEST_SUITE_P(Verbs, EveryVerbOfBindings, testing::ValuesIn(verbs_of_bindings()),
                         verb_name);

TEST_P(EveryVerbOfBindings, RefusesBarycentricsOfAnotherNumber) {
  Samples samples = of_the_small();
  samples.barycentric.pop_back();
  expect_refused(samples, {"3", "4"});
}

TEST_P(EveryVerbOfBindings, RefusesBarycentricsThatAreNotFinite) {
  Samples samples = of_the_small();
  samples.barycentric[1].y() = kNan;
  expect_refused(samples, {"barycentric[1]", "nan"});
}

class EveryVerbOfPlaces : public EveryVerb {};

INSTANTIATE_TEST_SUITE_P(Verbs, EveryVerbOfPlaces, testing::ValuesIn(readers()), verb_name);

TEST_P(EveryVerbOfPlaces, RefusesSamplesOfAnotherSurfaceOnFacesThatItHas) {
  expect_refused(of_its_first_faces(), {"positions[0]", "another surface"});
}

TEST_P(EveryVerbOfPlaces, RefusesPositionsThatAreNotFiniteOrOfAnotherNumber) {
  Samples samples = of_the_small();
  samples.positions[3].x() = kNan;
  expect_refused(samples, {"positions[3]", "nan"});
  samples.positions.pop_back();
  expect_refused(samples, {"3", "4"});
}

TEST(Arguments, RefuseSamplesWhoseOtherArraysAreShort) {
  const auto shortened = [](auto member) {
    Samples samples = of_the_small();
    (samples.*member).pop_back();
    return samples;
  };
  for (const Samples& samples :
       {shortened(&Samples::normals), shortened(&Samples::classes), shortened(&Samples::ids)})
    expect_message<ArgumentError>([&] { (void)mosaic(small(), samples); }, {"samples.", "3", "4"});
}

TEST(Arguments, RefuseLockedSitesWithoutBarycentrics) {
  Sites locked = sites_of(of_the_small());
  locked.barycentric.clear();
  expect_message<ArgumentError>([&] { (void)sample(small(), 8, {.locked = locked}); },
                                {"locked.barycentric", "0", "4"});
}

TEST(Arguments, RefuseLockedSitesThatWouldBeIgnored) {
  const Sites locked = sites_of(of_the_small());
  const std::vector<SampleClass> classes = {{.count = 8}, {.count = 8}};
  expect_message<ArgumentError>(
      [&] { (void)sample_classes(small(), classes, {.sample = {.locked = locked}}); },
      {"sample.locked", "classes"});
  const Plane square = Plane::rectangle(1.0, 1.0);
  const std::vector<SampleClass> planar = {{.count = 8}, {.count = 8}};
  expect_message<ArgumentError>(
      [&] { (void)sample_classes(square, planar, {.sample = {.locked = locked}}); },
      {"sample.locked", "classes"});
}

TEST(Arguments, RefuseOffsetsOfAnotherNumber) {
  const RestrictedVoronoi diagram =
      restricted_voronoi(small(), sites_of(of_the_small()), Cells::kEuclidean);
  const std::vector<Vec3> normals(3, Vec3::UnitZ());
  expect_message<ArgumentError>([&] { (void)bond_order(diagram, normals); }, {"normals", "3", "4"});
  expect_message<ArgumentError>(
      [&] { (void)bond_order(diagram, of_the_small().normals, {true, false}); },
      {"left_out", "2", "4"});
  RestrictedVoronoi other = diagram;
  other.cells.pop_back();
  expect_message<ArgumentError>(
      [&] { (void)cells_on_border(small(), sites_of(of_the_small()), other); }, {"3", "4"});
}

TEST(Arguments, NameTheFrameOfAWindowThatDoesNotFitTheSurface) {
  std::vector<std::vector<Vec3>> frames(5, small().vertices());
  frames[3].pop_back();
  expect_message<ArgumentError>([&] { (void)track_window(small(), of_the_small(), frames); },
                                {"frames[3]", "3", "4"});
  frames[3] = frames[0];
  frames[4][1].z() = kNan;
  expect_message<ArgumentError>([&] { (void)track_window(small(), of_the_small(), frames); },
                                {"frames[4][1]", "nan"});
}

// ---- numbers ----

TEST(Arguments, RefuseSitesFarOutsideBeforeReadingTheirFaces) {
  Sites start = sites_of(of_the_small());
  start.faces[0] = 1 << 30;
  expect_message<ArgumentError>([&] { (void)optimize(SurfaceDomain(small()), start, {}); },
                                {"faces[0]"});
}

TEST(Arguments, RefuseTooManyThreads) {
  const std::vector<Image> ink = {{1, 1, {1.0}}};
  const Plane square = Plane::rectangle(1.0, 1.0);
  const std::vector<Vec2> points = {{0.5, 0.5}};
  const std::span<const Vec2> run = points;
  const Samples samples = of_the_small();
  const Samples* pointer = &samples;
  const std::vector<std::vector<Vec3>> frames = {small().vertices()};
  const SampleClass one{.count = 3};
  for (const int threads : {-1, 10'000'000, std::numeric_limits<int>::max()}) {
    const auto refused = [&](const auto& action) {
      expect_message<ArgumentError>(action, {"threads", std::to_string(threads)});
    };
    refused([&] { (void)sample(small(), 3, {.threads = threads}); });
    refused([&] { (void)sample_classes(small(), {&one, 1}, {.sample = {.threads = threads}}); });
    refused([&] { (void)resample(small(), samples, 3, {.threads = threads}); });
    refused([&] { (void)sample(square, 3, {.threads = threads}); });
    refused([&] { (void)stipple_inks(ink, 3, {.threads = threads}); });
    refused([&] { (void)spectrum({&run, 1}, {.threads = threads}); });
    refused([&] { (void)surface_spectrum(small(), {&pointer, 1}, {.threads = threads}); });
    refused([&] { (void)mosaic(small(), samples, {.threads = threads}); });
    refused([&] { (void)remesh(small(), 5, {.threads = threads}); });
    refused([&] { (void)Tracker(small(), samples, {.threads = threads}); });
    refused([&] { (void)Population(small(), samples, {.tracker = {.threads = threads}}); });
    refused(
        [&] { (void)track_window(small(), samples, frames, {.tracker = {.threads = threads}}); });
    refused([&] { (void)WindowTracker(small(), samples, {.tracker = {.threads = threads}}); });
  }
}

TEST(Arguments, AcceptThreadsOfTheLargestMachines) {
  EXPECT_EQ(sample(small(), 5, {.threads = 4096}).size(), 5u);
}

TEST(Arguments, RefuseTooManySamples) {
  const std::vector<Image> ink = {{1, 1, {1.0}}};
  const Plane square = Plane::rectangle(1.0, 1.0);
  const std::vector<SampleClass> classes = {{.count = 60'000'000}, {.count = 60'000'000}};
  const std::vector<SampleClass> planar = {{.count = 60'000'000}, {.count = 60'000'000}};
  for (const std::size_t count : {std::size_t{100'000'001}, ~std::size_t{0}}) {
    const auto refused = [&](const auto& action) {
      expect_message<ArgumentError>(action, {"count", std::to_string(count), "100000000"});
    };
    refused([&] { (void)sample(small(), count); });
    refused([&] { (void)resample(small(), of_the_small(), count); });
    refused([&] { (void)sample(square, count); });
    refused([&] { (void)sample(Torus(), count); });
    refused([&] { (void)stipple_inks(ink, count); });
    refused([&] { (void)random_start(small(), count, 0); });
    refused([&] { (void)poisson_start(small(), count, 0); });
    refused([&] { (void)square.start(Start::kRandom, count, 0, nullptr); });
  }
  const auto refused = [&](const auto& action) {
    expect_message<ArgumentError>(action, {"count", "120000000", "100000000"});
  };
  refused([&] { (void)sample_classes(small(), classes); });
  refused([&] { (void)sample_classes(square, planar); });
}

TEST(Arguments, RefuseCountsOfInksWhoseSumOverflows) {
  const std::vector<Image> inks(3, {1, 1, {1.0}});
  const std::size_t half = std::size_t{1} << 63;
  expect_message<ArgumentError>([&] { (void)stipple_inks(inks, 5, {.counts = {half, half, 5}}); },
                                {"counts[0]", "100000000"});
}

TEST(Arguments, RefuseTooManyPixels) {
  const std::vector<FaceUv> uv(4);
  expect_message<ArgumentError>([&] { (void)texels(small(), uv, 1 << 30, 1 << 30); },
                                {"rows", "columns", "1073741824"});
}

#ifndef _WIN32
/// The faces are reserved memory that is never written, so they occupy none.
TEST(Arguments, RefuseFacesWhoseHalfEdgesOverflow) {
  constexpr std::size_t kCount = 715'827'883;
  void* memory = mmap(nullptr, kCount * sizeof(Face), PROT_READ,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) GTEST_SKIP() << "no address space for so many faces";
  const std::span<const Face> faces(static_cast<const Face*>(memory), kCount);
  const std::vector<Vec3> vertices = tetrahedron().vertices;
  expect_message<SurfaceError>([&] { (void)Surface(vertices, faces); },
                               {"faces", "715827883", "715827882"});
  munmap(memory, kCount * sizeof(Face));
}
#endif

}  // namespace
}  // namespace dapple::test
