// SPDX-License-Identifier: GPL-3.0-or-later
// The same input and seed give the same bytes from every compiler, on every system and processor,
// in any number of threads: tests/native/same_bytes.txt has one hash for each case.
#include <gtest/gtest.h>

#include <array>
#include <dapple/mosaic.hpp>
#include <dapple/relax.hpp>
#include <dapple/remesh.hpp>
#include <dapple/resample.hpp>
#include <dapple/sampler.hpp>
#include <dapple/stipple.hpp>
#include <dapple/symmetric_samples.hpp>
#include <dapple/tracker.hpp>
#include <dapple/window_tracker.hpp>
#include <fstream>

#include "hash.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

// The inputs are made with + - * / and square roots only: IEEE 754 defines their rounding, but not
// that of sines.

/// `count` points around the unit circle, from its rational parametrization by t = (-1, 1].
Vec2 on_circle(int k, int count) {
  const int quarter = count / 4;
  const double t = static_cast<double>(k % quarter) / quarter;
  const Vec2 first((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t));
  switch (k / quarter % 4) {
    case 0:
      return first;
    case 1:
      return {-first.y(), first.x()};
    case 2:
      return -first;
    default:
      return {first.y(), -first.x()};
  }
}

/// Radii 1 and 0.4, of 24 x 16 squares.
Shape ring() {
  constexpr int kAround = 24, kTube = 16;
  Shape shape{"ring", {}, {}};
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kTube; ++j) {
      const Vec2 around = on_circle(i, kAround), tube = on_circle(j, kTube);
      const double radius = 1 + 0.4 * tube.x();
      shape.vertices.emplace_back(radius * around.x(), radius * around.y(), 0.4 * tube.y());
      const auto at = [](int a, int b) { return a % kAround * kTube + b % kTube; };
      shape.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      shape.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return shape;
}

/// The vertices rotated around the z axis by an angle that grows with the height.
std::vector<Vec3> twisted(const std::vector<Vec3>& vertices, double much) {
  std::vector<Vec3> moved;
  for (const Vec3& p : vertices) {
    const double t = 0.5 * much * p.z(), c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
    moved.emplace_back(c * p.x() - s * p.y(), s * p.x() + c * p.y(), (1 + 0.2 * much) * p.z());
  }
  return moved;
}

std::vector<std::vector<Vec3>> motion(int frames) {
  std::vector<std::vector<Vec3>> all;
  for (int frame = 1; frame <= frames; ++frame)
    all.push_back(twisted(ring().vertices, 0.1 * frame));
  return all;
}

Shape sloped() {
  return with_density(ring(), [](const Vec3& p) { return 1.5 + p.x(); });
}

Samples start(int threads, std::size_t count = 300) {
  return sample(ring().surface(), count, {.threads = threads});
}

void hash_sample(Hash& hash, int threads) {
  hash.add(start(threads, 500));
  hash.add(sample(sloped().surface(), 400, {.seed = 7, .threads = threads}));
  hash.add(sample(ring().surface(), 200, {.cells = Cells::kEuclidean, .threads = threads}));
}

void hash_classes(Hash& hash, int threads) {
  const std::array<SampleClass, 3> classes{
      {{.count = 150}, {.count = 90}, {.count = 30, .radius = 0.08}}};
  hash.add(sample_classes(ring().surface(), classes, {.sample = {.threads = threads}}));
}

void hash_tracker(Hash& hash, int threads) {
  Tracker tracker(ring().surface(), start(threads), {.threads = threads});
  for (const std::vector<Vec3>& frame : motion(20)) hash.add(tracker.advance(frame));
}

void hash_window(Hash& hash, int threads) {
  WindowOptions options;
  options.tracker.threads = threads;
  for (const Samples& samples :
       track_window(ring().surface(), start(threads, 200), motion(8), options))
    hash.add(samples);
}

void hash_resample(Hash& hash, int threads) {
  hash.add(resample(sloped().surface(), start(threads), 340, {.threads = threads}));
}

void hash_relax(Hash& hash, int threads) {
  const Surface before = ring().surface();
  std::vector<double> density(ring().vertices.size(), 1.0);
  std::fill_n(density.begin(), 40, 3.0);
  const Surface after = before.with_density({DensityAt::kVertices, density});
  hash.add(relax(after, start(threads), changed_faces(before, after), {.threads = threads}));
}

void hash_relax_classes(Hash& hash, int threads) {
  const Surface before = ring().surface();
  const std::vector<SampleClass> classes = {{.count = 30, .radius = 0.1}, {.count = 220}};
  std::vector<double> density(ring().vertices.size(), 1.0);
  std::fill_n(density.begin(), 40, 3.0);
  const Surface after = before.with_density({DensityAt::kVertices, density});
  const Samples samples = sample_classes(before, classes, {.sample = {.threads = threads}});
  hash.add(relax(after, samples, changed_faces(before, after),
                 {.threads = threads, .classes = classes}));
}

void hash_stipple(Hash& hash, int threads) {
  Image ink{12, 16, {}};
  for (std::size_t k = 0; k < ink.rows * ink.columns; ++k)
    ink.values.push_back(static_cast<double>(k * k % 97) / 128);
  const Stipples dots = stipple_inks(std::array{ink}, 400, {.threads = threads});
  hash.add(dots.positions);
  hash.add(dots.radius);
}

void hash_mosaic(Hash& hash, int threads) {
  const Mosaic tiles = mosaic(ring().surface(), start(threads),
                              {.grout = 0.01, .thickness = 0.02, .threads = threads});
  hash.add(tiles.vertices);
  hash.add(tiles.corners);
  hash.add(tiles.starts);
  hash.add(tiles.sites);
}

void hash_remesh(Hash& hash, int threads) {
  const RemeshResult mesh = remesh(box(3).surface(), 300, {.threads = threads});
  hash.add(mesh.vertices);
  hash.add(mesh.faces);
  hash.add(mesh.source_faces);
}

void hash_remesh_next(Hash& hash, int threads) {
  const Surface before = box(3).surface(), next = sloped().surface();
  const RemeshOptions options{.threads = threads};
  const NextRemesh found =
      remesh_next(before, remesh(before, 300, options), next, before.capacity() / 300.0, options);
  hash.add(found.mesh.vertices);
  hash.add(found.mesh.faces);
  hash.add(found.previous);
}

void hash_symmetric(Hash& hash, int threads) {
  for (const Shape& shape : {ring(), sloped()}) {
    SymmetryOptions options;
    options.sample.threads = threads;
    const SymmetricSamples found = sample_symmetric(shape.surface(), 301, options);
    hash.add(found.samples);
    hash.add(found.mirror);
  }
}

struct Case {
  const char* name;
  void (*run)(Hash&, int threads);
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

constexpr std::array kCases = {
    Case{"sample", hash_sample},
    Case{"classes", hash_classes},
    Case{"tracker", hash_tracker},
    Case{"window", hash_window},
    Case{"resample", hash_resample},
    Case{"relax", hash_relax},
    Case{"relax_classes", hash_relax_classes},
    Case{"stipple", hash_stipple},
    Case{"mosaic", hash_mosaic},
    Case{"remesh", hash_remesh},
    Case{"remesh_next", hash_remesh_next},
    Case{"symmetric", hash_symmetric},
};

std::string recorded(const std::string& name) {
  std::ifstream file(DAPPLE_SAME_BYTES);
  std::string found, hash;
  while (file >> found >> hash)
    if (found == name) return hash;
  return "nothing";
}

class SameBytes : public testing::TestWithParam<Case> {};

TEST_P(SameBytes, OnEverySystemInAnyNumberOfThreads) {
  for (const int threads : {1, 2, 8, 0}) {
    Hash hash;
    GetParam().run(hash, threads);
    ASSERT_EQ(hash.text(), recorded(GetParam().name)) << "in " << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, SameBytes, testing::ValuesIn(kCases),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace dapple::test
