// SPDX-License-Identifier: GPL-3.0-or-later
#include "verb_cases.hpp"

#include <array>
#include <dapple/curvature.hpp>
#include <dapple/decals.hpp>
#include <dapple/energy.hpp>
#include <dapple/errors.hpp>
#include <dapple/exposure.hpp>
#include <dapple/line_samples.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/planar_sampler.hpp>
#include <dapple/poisson_start.hpp>
#include <dapple/population.hpp>
#include <dapple/progressive.hpp>
#include <dapple/projector.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/refine_obstacles.hpp>
#include <dapple/refined_samples.hpp>
#include <dapple/relax.hpp>
#include <dapple/remesh.hpp>
#include <dapple/resample.hpp>
#include <dapple/restricted_voronoi.hpp>
#include <dapple/sampler.hpp>
#include <dapple/solids.hpp>
#include <dapple/spectrum.hpp>
#include <dapple/stipple.hpp>
#include <dapple/symmetric_samples.hpp>
#include <dapple/topology.hpp>
#include <dapple/visibility.hpp>
#include <dapple/window_tracker.hpp>
#include <memory>
#include <optional>
#include <ostream>

#include "shapes.hpp"

namespace dapple::test {

Prepare again(Work work) {
  return [work = std::move(work)] { return work; };
}

namespace {

OptimizerOptions few_steps() { return {.max_evaluations = 3}; }
SampleOptions few(int threads) { return {.optimizer = few_steps(), .threads = threads}; }

ResampleOptions few_again(int threads) { return {.optimizer = few_steps(), .threads = threads}; }

Prepare sampling(int threads) {
  return again([surface = two_sheets(3, 0.02).surface(), threads](Hash& hash) {
    hash.add(sample(surface, 60, few(threads)));
  });
}

/// From a quarter of the samples.
Prepare sampling_a_lattice(int threads) {
  return again([surface = blob(2).surface(), threads](Hash& hash) {
    SampleOptions options = few(threads);
    options.optimizer.capacity_weight = 1.0;
    hash.add(sample(surface, 600, options));
  });
}

Prepare sampling_classes(int threads) {
  return again([surface = blob(2).surface(), threads](Hash& hash) {
    const double radius = 0.4 * surface.spacing(60);
    const std::array<SampleClass, 2> classes = {
        {{.count = 15, .radius = radius}, {.count = 45, .radius = radius}}};
    hash.add(sample_classes(surface, classes, {.two_stages = true, .sample = few(threads)}));
  });
}

void add(Hash& hash, const PlanarSamples& samples) {
  hash.add(samples.positions);
  hash.add(samples.classes);
  hash.add(samples.report.energy);
}

Prepare sampling_a_picture(int threads) {
  const Image ramp{2, 2, {0.2, 0.4, 0.6, 1.0}};
  return again([domain = Plane::image(1.0, 1.0, ramp), threads](Hash& hash) {
    add(hash, sample(domain, 40, few(threads)));
  });
}

Prepare sampling_a_torus(int threads) {
  return again([threads](Hash& hash) {
    const std::array<SampleClass, 2> classes = {{{.count = 15}, {.count = 25}}};
    add(hash, sample_classes(Torus(), classes, {.sample = few(threads)}));
  });
}

Prepare sampling_a_polygon(int threads) {
  return again([threads](Hash& hash) {
    const std::vector<Vec2> outline = {{0, 0}, {2, 0}, {2, 1}, {1, 0.5}, {0, 1}};
    add(hash, sample(Plane::polygon(outline), 30, few(threads)));
  });
}

Image sloped_ink() {
  Image ink{8, 8, {}};
  for (int k = 0; k < 64; ++k) ink.values.push_back(0.4 * (k % 8) / 8.0);
  return ink;
}

Prepare stippling(int threads) {
  return again([ink = sloped_ink(), threads](Hash& hash) {
    const Stipples dots =
        stipple_inks(std::array{ink, ink}, 50, {.optimizer = few_steps(), .threads = threads});
    hash.add(dots.positions);
    hash.add(dots.classes);
  });
}

Samples start(const Surface& surface, std::size_t count) { return sample(surface, count, few(1)); }

Prepare resampling(int threads) {
  const Surface surface = blob(2).surface();
  return again([surface, samples = start(surface, 40), threads](Hash& hash) {
    hash.add(resample(surface, samples, 70, few_again(threads)));
    hash.add(resample(surface, samples, 25, few_again(threads)));
  });
}

Prepare relaxing(int threads) {
  const Surface surface = blob(2).surface();
  std::vector<double> density;
  for (const Vec3& x : surface.vertices()) density.push_back(x.z() > 0.7 ? 3.0 : 1.0);
  const Surface after = surface.with_density({DensityAt::kVertices, density});
  return again([surface, after, samples = start(surface, 80), threads](Hash& hash) {
    hash.add(relax(after, samples, changed_faces(surface, after),
                   {.optimizer = few_steps(), .threads = threads}));
  });
}

Prepare relaxing_classes(int threads) {
  const Surface surface = blob(2).surface();
  const std::vector<SampleClass> classes = {{.count = 10, .radius = 0.1}, {.count = 70}};
  std::vector<double> density;
  for (const Vec3& x : surface.vertices()) density.push_back(x.z() > 0.7 ? 3.0 : 1.0);
  const Surface after = surface.with_density({DensityAt::kVertices, density});
  const Samples samples = sample_classes(surface, classes);
  return again([surface, after, samples, classes, threads](Hash& hash) {
    hash.add(relax(after, samples, changed_faces(surface, after),
                   {.optimizer = few_steps(), .threads = threads, .classes = classes}));
  });
}

TrackerOptions tracking(int threads) {
  return {.optimizer = few_steps(), .longest_motion = 0.1, .threads = threads};
}

Prepare beginning_to_track(int threads) {
  const Surface surface = blob(2).surface();
  return again([surface, samples = start(surface, 60), threads](Hash& hash) {
    hash.add(Tracker(surface, samples, tracking(threads)).samples());
  });
}

Prepare tracking_a_frame(int threads) {
  const Shape shape = blob(2);
  const Tracker fresh(shape.surface(), start(shape.surface(), 60), tracking(threads));
  return [fresh, next = deformed(shape.vertices, 1.0)] {
    return [next, tracker = std::make_shared<Tracker>(fresh)](Hash& hash) {
      hash.add(tracker->advance(next));
    };
  };
}

Prepare resuming(int threads) {
  const Shape shape = blob(2);
  const Samples samples = start(shape.surface(), 60);
  const Tracker fresh(shape.surface(), samples, tracking(threads));
  return [fresh, samples, next = deformed(shape.vertices, 1.0)] {
    return [samples, next, tracker = std::make_shared<Tracker>(fresh)](Hash& hash) {
      tracker->resume(next, samples, false);
      hash.add(tracker->samples());
    };
  };
}

Prepare a_population(int threads) {
  const Shape shape = blob(2);
  PopulationOptions options{.fade = 3, .tracker = tracking(threads)};
  Population fresh(shape.surface(), start(shape.surface(), 60), options);
  const auto scaled = [&](double much) {
    return mapped(shape, [&](const Vec3& p) { return Vec3(much * p.x(), p.y(), p.z()); }).vertices;
  };
  fresh.advance(scaled(0.9));  // makes some samples vanish
  return [fresh, next = scaled(1.3)] {
    return [next, population = std::make_shared<Population>(fresh)](Hash& hash) {
      hash.add(population->advance(next));
      hash.add(population->samples().fade);
    };
  };
}

/// Nothing moves, so only reports are made.
Prepare resting(int threads) {
  const Shape shape = blob(2);
  const Population fresh(shape.surface(), start(shape.surface(), 60),
                         {.tracker = tracking(threads)});
  return [fresh, shape] {
    return [shape, population = std::make_shared<Population>(fresh)](Hash& hash) {
      hash.add(population->advance(shape.vertices));
      hash.add(population->samples().report.energies);
    };
  };
}

Prepare a_window(int threads) {
  const Shape shape = blob(2);
  const Surface surface = shape.surface();
  WindowOptions options{.closed = true, .sweeps = 1, .tracker = tracking(threads)};
  const std::vector<std::vector<Vec3>> frames = {shape.vertices, deformed(shape.vertices, 0.3)};
  return again([surface, samples = start(surface, 30), frames, options](Hash& hash) {
    hash.add(track_window(surface, samples, frames, options));
  });
}

Prepare tiling(int threads) {
  const Surface surface = two_sheets(3, 0.02).surface();
  return again([surface, samples = start(surface, 40), threads](Hash& hash) {
    const Mosaic tiles =
        mosaic(surface, samples, {.grout = 0.01, .thickness = 0.01, .threads = threads});
    hash.add(tiles.vertices);
    hash.add(tiles.corners);
  });
}

Prepare sampling_lines(int) {
  const Surface surface = box(2).surface();
  return again([surface](Hash& hash) {
    const LineSamples found = sample_lines(surface, 40, {.corners = true});
    hash.add(found.samples.positions);
    hash.add(found.lines);
  });
}

Prepare sampling_in_pairs(int threads) {
  const Surface surface = with_density(box(2), [](const Vec3& p) { return 1.0 + p[0]; }).surface();
  return again([surface, threads](Hash& hash) {
    SymmetryOptions options{.point = Vec3::Constant(0.5)};
    options.sample.optimizer.max_evaluations = 3;
    options.sample.threads = threads;
    const SymmetricSamples found = sample_symmetric(surface, 41, options);
    hash.add(found.samples);
    hash.add(found.mirror);
  });
}

Prepare remeshing(const Surface& surface, std::size_t count, RemeshOptions options, int threads) {
  options.optimizer.max_evaluations = 3;
  options.threads = threads;
  return again([surface, count, options](Hash& hash) {
    const RemeshResult mesh = remesh(surface, count, options);
    hash.add(mesh.vertices);
    hash.add(mesh.faces);
  });
}

Prepare remeshing_a_box(int threads) { return remeshing(box(2).surface(), 40, {}, threads); }

Prepare remeshing_near(int threads) {
  return remeshing(icosphere(1).surface(), 10, {.max_distance = 0.2}, threads);
}

Prepare remeshing_adapted(int threads) {
  return remeshing(blob(1).surface(), 20, {.adaptive = true}, threads);
}

Prepare remeshing_next(int threads) {
  const Surface before = grid(6).surface();
  const Surface next = mapped(grid(7), [](const Vec3& p) {
                         return Vec3(p[0], p[1], 0.3 * std::max(p[0] - 0.5, 0.0));
                       }).surface();
  RemeshOptions options;
  options.optimizer.max_evaluations = 3;
  options.threads = threads;
  return again([before, next, options, mesh = remesh(before, 60, options)](Hash& hash) {
    const NextRemesh found = remesh_next(before, mesh, next, before.capacity() / 60.0, options);
    hash.add(found.mesh.vertices);
    hash.add(found.mesh.faces);
    hash.add(found.previous);
  });
}

Prepare covering(int) {
  const Surface surface = grid(3).surface();
  std::vector<FaceUv> uv;
  for (const Face& face : surface.faces()) {
    uv.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      uv.back()[k] = surface.vertices()[static_cast<std::size_t>(face[k])].head<2>();
  }
  return again([surface, uv, samples = start(surface, 20)](Hash& hash) {
    const Texels grid_of_texels = texels(surface, uv, 16, 16);
    const std::vector<double> radii(20, 0.1);
    const std::vector<Vec3> tangents(20, Vec3::UnitX());
    hash.add(decal_cover(surface, samples, radii, tangents, grid_of_texels).samples);
  });
}

Prepare refining(int) {
  return again([surface = grid(2).surface()](Hash& hash) {
    const double longest = 0.2;
    const Refined edges = refine_edges(surface, {&longest, 1}, 100000);
    hash.add(edges.surface.vertices());
    const std::vector<Vec3> points = {{0.5, 0.5, 0.0}};
    const std::vector<double> radii = {0.2};
    const Refined holes = refine_obstacles(edges.surface, {points, radii, {}}, {.edge = 0.5});
    hash.add(edges.then(holes).surface.vertices());
    hash.add(edges.deformed(surface.vertices()).surface.area());
  });
}

Prepare leaving_out_hidden_faces(int) {
  const Shape ball = icosphere(1);
  const Surface surface =
      joined(ball, mapped(ball, [](const Vec3& p) { return Vec3(p + Vec3(0.9, 0.1, 0.0)); }))
          .surface();
  return again([surface](Hash& hash) {
    const std::vector<Vec3> moved = deformed(surface.vertices(), 0.4);
    hash.add(refine_outside(surface, {.edge = 0.3, .poses = {moved}}).surface.vertices());
    for (const std::uint8_t seen : seen_from(surface, {3, 1, 1, 1}, surface.vertices()))
      hash.add(seen > 0 ? 1.0 : 0.0);
  });
}

Prepare finding_solids(int) {
  const Shape ball = icosphere(1);
  return again([ball](Hash& hash) {
    const std::vector<std::int32_t> counts(ball.vertices.size() / 3, 3);
    const Solids solids{std::span(ball.vertices).first(3 * counts.size()), counts, 0.05};
    for (const Reach reach : reached_by_solids(ball.vertices, ball.faces, solids))
      hash.add(static_cast<double>(reach));
    for (const auto& pair : touching_solids(solids)) hash.add(static_cast<double>(pair[1]));
  });
}

Prepare refining_to_a_picture(int) {
  const Surface surface = grid(1).surface();
  const std::vector<FaceUv> uv(surface.face_count(), {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1)});
  return again([surface, uv, ink = sloped_ink()](Hash& hash) {
    hash.add(refine_image(surface, uv, ink, {.max_faces = 300}).surface.vertices());
  });
}

Prepare a_spectrum(int threads) {
  Random random(1);
  std::vector<Vec2> points;
  for (int k = 0; k < 40; ++k) points.emplace_back(random.uniform(), random.uniform());
  return again([points, threads](Hash& hash) {
    const std::vector<std::span<const Vec2>> runs = {points, points};
    hash.add(spectrum(runs, {.threads = threads}).periodogram);
  });
}

Prepare a_spectrum_of_a_surface(int threads) {
  const Surface surface = grid(6).surface();
  return again([surface, samples = start(surface, 150), threads](Hash& hash) {
    const std::array<const Samples*, 2> runs = {&samples, &samples};
    const SurfaceSpectrum result =
        surface_spectrum(surface, runs, {.radius = 3.0, .bins = 16, .threads = threads});
    hash.add(result.differentials);
    hash.add(result.power);
  });
}

Prepare projecting(int) {
  return again([surface = blob(2).surface()](Hash& hash) {
    const std::vector<Vec3> points(100, Vec3(2.0, 1.0, 0.5));
    const Projector projector(surface);
    const Projection found = projector.project(points);
    hash.add(found.positions);
    const std::vector<double> radii(points.size(), 2.0);
    hash.add(projector.faces_within(points, radii));
  });
}

Prepare ranking(int) {
  const Samples samples = start(blob(2).surface(), 120);
  std::vector<std::int32_t> classes;
  for (int k = 0; k < 120; ++k) classes.push_back(k % 2);
  return again(
      [samples, classes](Hash& hash) { hash.add(progressive_ranks(samples.positions, classes)); });
}

Prepare making_surfaces(int) {
  return again([loose = soup(blob(2)), whole = blob(2)](Hash& hash) {
    const Surface welded = loose.surface();
    hash.add(welded.welded_faces());
    hash.add(welded.deformed(loose.vertices).area());
    const std::vector<double> density(loose.vertices.size(), 2.0);
    hash.add(welded.with_density({DensityAt::kVertices, density}).capacity());
    hash.add(topology(welded).genus);
    hash.add(curvature_density(whole.surface()));
  });
}

Prepare measuring(int) {
  const Surface walls = two_sheets(3, 0.02).surface();
  return again([walls, samples = start(walls, 40)](Hash& hash) {
    hash.add(analyze(walls, samples).energy);
    hash.add(bind_samples(walls, samples.faces, samples.barycentric));
    for (const CellPolygon& polygon :
         restricted_voronoi_polygons(walls, {samples.positions, samples.faces}, Cells::kEuclidean))
      hash.add(polygon.points);
  });
}

constexpr std::array kCases = {
    Case{"Sample", sampling},
    Case{"Lattice", sampling_a_lattice},
    Case{"Classes", sampling_classes},
    Case{"Picture", sampling_a_picture},
    Case{"Torus", sampling_a_torus},
    Case{"Polygon", sampling_a_polygon, 1},  // a block of CGAL's Compact_container
    Case{"Stipple", stippling},
    Case{"Resample", resampling},
    Case{"Relax", relaxing},
    Case{"RelaxClasses", relaxing_classes},
    Case{"NewTracker", beginning_to_track},
    Case{"Frame", tracking_a_frame},
    Case{"Resume", resuming},
    Case{"Population", a_population},
    Case{"Resting", resting},
    Case{"Window", a_window},
    Case{"Mosaic", tiling},
    Case{"Lines", sampling_lines},
    Case{"Symmetric", sampling_in_pairs},
    Case{"Remesh", remeshing_a_box},
    Case{"RemeshNear", remeshing_near},
    Case{"RemeshAdapted", remeshing_adapted},
    Case{"RemeshNext", remeshing_next},
    Case{"Decals", covering},
    Case{"Refine", refining},
    Case{"RefineOutside", leaving_out_hidden_faces, 1},  // as Polygon
    Case{"Solids", finding_solids},
    Case{"RefineImage", refining_to_a_picture},
    Case{"Spectrum", a_spectrum},
    Case{"SurfaceSpectrum", a_spectrum_of_a_surface},
    Case{"Projector", projecting},
    Case{"Ranks", ranking},
    Case{"Surfaces", making_surfaces},
    Case{"Measures", measuring},
};

}  // namespace

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

std::span<const Case> verb_cases() { return kCases; }

}  // namespace dapple::test
