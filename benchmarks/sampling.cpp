// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <cmath>
#include <dapple/domain.hpp>
#include <dapple/energy.hpp>
#include <dapple/poisson_start.hpp>
#include <dapple/sampler.hpp>
#include <dapple/tracker.hpp>
#include <map>
#include <numbers>
#include <utility>

// Run: build/release/benchmarks/dapple_benchmarks
// The figure to watch: whole_optimization, 2,000 samples on 81,920 faces at the paper's tolerance
// (the paper: 16 s).

namespace {

using dapple::Face;
using dapple::Vec3;

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

Mesh icosahedron() {
  const double g = std::numbers::phi;
  Mesh mesh{{{-1, g, 0},
             {1, g, 0},
             {-1, -g, 0},
             {1, -g, 0},
             {0, -1, g},
             {0, 1, g},
             {0, -1, -g},
             {0, 1, -g},
             {g, 0, -1},
             {g, 0, 1},
             {-g, 0, -1},
             {-g, 0, 1}},
            {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (Vec3& p : mesh.vertices) p.normalize();
  return mesh;
}

Mesh subdivided(const Mesh& mesh) {
  Mesh result{mesh.vertices, {}};
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [found, fresh] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(result.vertices.size()));
    if (fresh) result.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
    return found->second;
  };
  for (const auto& [a, b, c] : mesh.faces) {
    const int ab = middle(a, b);
    const int bc = middle(b, c);
    const int ca = middle(c, a);
    for (const Face& face : {Face{a, ab, ca}, Face{ab, b, bc}, Face{ca, bc, c}, Face{ab, bc, ca}})
      result.faces.push_back(face);
  }
  return result;
}

/// A closed, bulging and twisting body; `time` moves it.
std::vector<Vec3> deform(std::vector<Vec3> vertices, double time) {
  for (Vec3& p : vertices) {
    const double bulge =
        1.0 + 0.25 * std::sin(3.0 * p.x() + time) * std::cos(2.0 * p.y()) + 0.2 * p.z() * p.z();
    const double twist = 0.8 * std::sin(time) * p.z();
    const Vec3 q = bulge * p;
    p = {std::cos(twist) * q.x() - std::sin(twist) * q.y(),
         std::sin(twist) * q.x() + std::cos(twist) * q.y(), 1.3 * q.z()};
  }
  return vertices;
}

/// 20 * 4^levels faces: 81,920 at 6, 20,480 at 5.
const Mesh& sphere(int levels) {
  static std::map<int, Mesh> made;
  const auto [found, fresh] = made.try_emplace(levels);
  if (fresh) {
    found->second = icosahedron();
    for (int k = 0; k < levels; ++k) found->second = subdivided(found->second);
  }
  return found->second;
}

dapple::Surface body(int levels) {
  const Mesh& mesh = sphere(levels);
  return {deform(mesh.vertices, 0.3), mesh.faces};
}

void report(benchmark::State& state, const dapple::Report& r) {
  state.counters["evaluations"] = r.evaluations;
  state.counters["energy"] = r.energy;
  state.counters["alpha_min"] = r.evenness.alpha_min;
  state.counters["alpha_mean"] = r.evenness.alpha_mean;
  state.counters["capacity_variation"] = r.evenness.capacity_variation;
}

void whole_optimization(benchmark::State& state) {
  const dapple::Surface surface = body(static_cast<int>(state.range(1)));
  dapple::Samples samples;
  for (auto _ : state) samples = dapple::sample(surface, static_cast<std::size_t>(state.range(0)));
  state.counters["faces"] = static_cast<double>(surface.face_count());
  report(state, samples.report);
}
BENCHMARK(whole_optimization)
    ->Args({2000, 6})
    ->Args({10000, 6})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void one_evaluation(benchmark::State& state) {
  const dapple::Surface surface = body(static_cast<int>(state.range(1)));
  const dapple::Sites sites =
      dapple::poisson_start(surface, static_cast<std::size_t>(state.range(0)), 0);
  const dapple::SurfaceDomain domain(surface);  // keeps what is made of the surface once
  for (auto _ : state) benchmark::DoNotOptimize(dapple::evaluate_energy(domain, sites, 30.0));
}
BENCHMARK(one_evaluation)
    ->Args({2000, 6})
    ->Args({10000, 6})
    ->Args({100000, 6})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void poisson_start(benchmark::State& state) {
  const dapple::Surface surface = body(6);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        dapple::poisson_start(surface, static_cast<std::size_t>(state.range(0)), 0));
}
BENCHMARK(poisson_start)
    ->Arg(2000)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void tracked_frame(benchmark::State& state) {
  const Mesh& mesh = sphere(static_cast<int>(state.range(1)));
  const dapple::Surface first(deform(mesh.vertices, 0.0), mesh.faces);
  dapple::Tracker tracker(first, dapple::sample(first, static_cast<std::size_t>(state.range(0))));
  double time = 0.0;
  for (auto _ : state) tracker.advance(deform(mesh.vertices, time += 0.05));
  report(state, tracker.samples().report);
}
BENCHMARK(tracked_frame)
    ->Args({2000, 6})
    ->Args({2000, 5})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
