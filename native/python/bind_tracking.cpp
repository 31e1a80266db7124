// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <dapple/errors.hpp>
#include <dapple/population.hpp>
#include <dapple/window_tracker.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "classes.hpp"
#include "guarded.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple::python {
namespace {

constexpr const char* kNotPickled =
    "it is a motion under way. Keep what resume() takes, and go on with one made of the first "
    "frame";

using SharedTracker = Guarded<Tracker>;
using SharedPopulation = Guarded<Population>;
using SharedWindowTracker = Guarded<WindowTracker>;

/// The classes of its samples that a tracker receives.
std::vector<SampleClass> wanted_classes(const Surface& surface, const py::object& classes) {
  if (classes.is_none()) return {};
  return classes_on(surface, py::sequence(classes));
}

std::shared_ptr<SharedTracker> make_tracker(const Surface& surface, const Samples& samples,
                                            const py::kwargs& keywords) {
  const Keywords given(kTracker, keywords, {"classes", "context"});
  TrackerOptions options = given.options();
  options.classes = wanted_classes(surface, given.other("classes"));
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<SharedTracker>(surface, samples, options, watched);
  });
}

std::shared_ptr<Samples> advance_tracker(SharedTracker& shared, const py::object& vertices,
                                         const ContextPtr& context) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const SharedTracker::Change tracker(shared);
  return run(context, [&](Context* watched) {
    return std::make_shared<Samples>(tracker->advance(as_points(points), watched));
  });
}

void resume_tracker(SharedTracker& shared, const py::object& vertices, const Samples& samples,
                    bool settled) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  const SharedTracker::Change tracker(shared);
  run([&] { tracker->resume(as_points(points), samples, settled); });
}

void resume_tracker_on(SharedTracker& shared, const Surface& surface, const py::object& vertices,
                       const Samples& samples, const Samples& first, const py::object& classes,
                       bool anywhere, const ContextPtr& context) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  std::vector<SampleClass> wanted = wanted_classes(surface, classes);
  const SharedTracker::Change tracker(shared);
  run(context, [&](Context* watched) {
    tracker->resume_on(surface, as_points(points), samples, first, std::move(wanted), anywhere,
                       watched);
  });
}

std::shared_ptr<SharedPopulation> make_population(const Surface& surface, const Samples& samples,
                                                  const py::kwargs& keywords) {
  const Keywords given(kPopulation, keywords, {"classes", "context"});
  PopulationOptions options = given.options();
  options.tracker.classes = wanted_classes(surface, given.other("classes"));
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<SharedPopulation>(surface, samples, options, watched);
  });
}

/// A frame with different faces; the body must not have a density.
Surface surface_like(const Surface& before, std::span<const Vec3> vertices,
                     std::span<const Face> faces, Context* context) {
  if (!before.uniform())
    throw ArgumentError(
        "faces differ from the last frame, and the surface has a density: pass the frame as a "
        "Surface "
        "with its density");
  return {vertices, faces, Density{},
          SurfaceOptions{.weld = before.weld(),
                         .sharp_angle = before.sharp_angle(),
                         .merge_doubled = before.merge_doubled()},
          context};
}

std::shared_ptr<Samples> advance_population(SharedPopulation& shared, const py::object& vertices,
                                            const py::object& faces, const ContextPtr& context) {
  if (py::isinstance<Surface>(vertices)) {
    if (!faces.is_none())
      throw ArgumentError("faces must not be given with a Surface, which has its own");
    const auto next = vertices.cast<std::shared_ptr<Surface>>();
    const SharedPopulation::Change population(shared);
    return run(context, [&](Context* watched) {
      return std::make_shared<Samples>(population->advance(*next, watched));
    });
  }
  const DoubleArray points = doubles("vertices", vertices, 3);
  const IntArray triangles = faces.is_none() ? IntArray() : integers("faces", faces, 3);
  const bool same_faces = faces.is_none();
  const SharedPopulation::Change population(shared);
  return run(context, [&](Context* watched) {
    const Surface& before = population->surface();
    if (same_faces || (static_cast<std::size_t>(points.shape(0)) == before.vertex_count() &&
                       std::ranges::equal(as_faces(triangles), before.faces())))
      return std::make_shared<Samples>(population->advance(as_points(points), watched));
    const Surface next = surface_like(before, as_points(points), as_faces(triangles), watched);
    return std::make_shared<Samples>(population->advance(next, watched));
  });
}

py::dict state_of(const SharedPopulation& population) {
  PopulationState state = population.read().state();
  py::dict result;
  result["fades"] = give(std::move(state.fades));
  result["first_faces"] = give(std::move(state.first_faces));
  result["first_barycentric"] = give(std::move(state.first_barycentric));
  result["starts"] = give(std::vector<std::int64_t>(state.starts.begin(), state.starts.end()));
  result["neighbors"] = give(std::move(state.neighbors));
  result["densities"] = give(std::move(state.densities));
  result["next_id"] = state.next_id;
  result["settled"] = state.settled;
  result["faces_digest"] = state.faces_digest;
  return result;
}

PopulationState state_from(const py::dict& given) {
  const auto of = [&given](const char* name) {
    if (!given.contains(name)) throw ArgumentError(std::string("state has no '") + name + "'");
    return py::object(given[name]);
  };
  const auto all = [](const auto& array) {
    const auto span = as_span(array);
    return std::vector(span.begin(), span.end());
  };
  const IntArray rows = integers("state.starts", of("starts"), 0);
  const std::span<const std::int32_t> starts = as_span(rows);
  const DoubleArray first = doubles("state.first_barycentric", of("first_barycentric"), 3);
  const std::span<const Vec3> places = as_points(first);
  return {.fades = all(doubles("state.fades", of("fades"), 0)),
          .first_faces = all(integers("state.first_faces", of("first_faces"), 0)),
          .first_barycentric = {places.begin(), places.end()},
          .starts = {starts.begin(), starts.end()},
          .neighbors = all(integers("state.neighbors", of("neighbors"), 0)),
          .densities = all(doubles("state.densities", of("densities"), 0)),
          .next_id = of("next_id").cast<std::int64_t>(),
          .settled = of("settled").cast<bool>(),
          .faces_digest = given.contains("faces_digest")  // missing in older states
                              ? of("faces_digest").cast<std::int64_t>()
                              : 0};
}

void resume_population(SharedPopulation& shared, const Surface& surface, const Samples& samples,
                       const py::dict& state) {
  const PopulationState given = state_from(state);
  const SharedPopulation::Change population(shared);
  run([&] { population->resume(surface, samples, given); });
}

std::vector<std::shared_ptr<Samples>> shared(std::vector<Samples> frames) {
  std::vector<std::shared_ptr<Samples>> result;
  result.reserve(frames.size());
  for (Samples& one : frames) result.push_back(std::make_shared<Samples>(std::move(one)));
  return result;
}

std::vector<std::vector<Vec3>> vertices_of(const py::iterable& frames) {
  std::vector<std::vector<Vec3>> vertices;
  for (const py::handle frame : frames) {
    const DoubleArray points = doubles("frames", py::reinterpret_borrow<py::object>(frame), 3);
    const std::span<const Vec3> span = as_points(points);
    vertices.emplace_back(span.begin(), span.end());
  }
  return vertices;
}

std::vector<std::shared_ptr<Samples>> window_of(const Surface& surface, const Samples& samples,
                                                const py::iterable& frames,
                                                const py::kwargs& keywords) {
  const Keywords given(kTrackWindow, keywords, {"classes", "context"});
  WindowOptions options = given.options();
  options.tracker.classes = wanted_classes(surface, given.other("classes"));
  const ContextPtr context = given.context();
  const std::vector<std::vector<Vec3>> vertices = vertices_of(frames);
  return run(context, [&](Context* watched) {
    return shared(track_window(surface, samples, vertices, options, watched));
  });
}

std::shared_ptr<SharedWindowTracker> make_window_tracker(const Surface& surface,
                                                         const Samples& samples,
                                                         const py::kwargs& keywords) {
  const Keywords given(kWindowTracker, keywords, {"classes", "context"});
  WindowOptions options = given.options();
  options.tracker.classes = wanted_classes(surface, given.other("classes"));
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<SharedWindowTracker>(surface, samples, options, watched);
  });
}

std::vector<std::shared_ptr<Samples>> advance_window(SharedWindowTracker& window,
                                                     const py::iterable& frames, Done done,
                                                     const ContextPtr& context) {
  const std::vector<std::vector<Vec3>> vertices = vertices_of(frames);
  const SharedWindowTracker::Change tracker(window);
  return run(context,
             [&](Context* watched) { return shared(tracker->advance(vertices, done, watched)); });
}

/// Copies of the samples, because a sequence that creates its items on the fly may drop them.
std::vector<Samples> samples_ahead(const py::object& ahead) {
  std::vector<Samples> result;
  for (const py::object& one : items_of(ahead)) {
    if (!py::isinstance<Samples>(one))
      refuse_type("ahead[" + std::to_string(result.size()) + "]", one, "a Samples");
    result.push_back(one.cast<const Samples&>());
  }
  return result;
}

void resume_window(SharedWindowTracker& window, const py::object& vertices, const Samples& samples,
                   const py::iterable& ahead) {
  const DoubleArray points = doubles("vertices", vertices, 3);
  std::vector<Samples> frames = samples_ahead(ahead);
  const SharedWindowTracker::Change tracker(window);
  run([&] { tracker->resume(as_points(points), samples, std::move(frames)); });
}

void bind_tracker(py::module_& m) {
  const std::string documentation =
      documented(kTracker, R"(Carries samples over a deforming surface.

They move with the vertices by their barycentric coordinates and are then optimized until they are as even as in
the first frame; index and id of each stay (Chen et al. 2012, section 5.4).

Args:
    surface: the Surface of the first frame.
    samples: its Samples.
    {options}
    classes: the SampleClass of each class of the samples (their counts are the samples'), or None: all are one class.
    context: a Context for progress and cancel.

Raises:
    ValueError: the samples do not belong to the surface, or their class is not given; an option out of range.
    Cancelled: through the context.)");
  py::class_<SharedTracker, std::shared_ptr<SharedTracker>> type(m, "Tracker",
                                                                 documentation.c_str());
  def_init(type, kTracker, &make_tracker,
           "__init__(self: Tracker, surface: Surface, samples: Samples, *, {signature}, "
           "classes: Sequence[SampleClass | int] | None = None, "
           "context: Context | None = None) -> None",
           py::arg("surface"), py::arg("samples"));
  type.def("__reduce_ex__", refusal(kNotPickled));
  type.def(
          "resume", &resume_tracker, py::arg("vertices"), py::arg("samples"), py::kw_only(),
          py::arg("settled") = false,
          R"(Continue from a frame that was solved before: the next frames have the same bytes as without an interruption.

Args:
    vertices: (v, 3) float64, of that frame.
    samples: Samples with its faces and barycentric coordinates, as many as the tracker has, made on that frame's
        surface, the present one or the first; ids and classes stay.
    settled: the value of the property on that frame.

Raises:
    SurfaceError: the number of vertices differs, or they are not finite.
    ValueError: samples of another number, or of another surface: naming the first that is elsewhere.)")
      .def(
          "resume_on", &resume_tracker_on, py::arg("surface"), py::arg("vertices"),
          py::arg("samples"), py::arg("first"), py::kw_only(), py::arg("classes") = py::none(),
          py::arg("anywhere") = false, py::arg("context") = nullptr,
          R"(Continue on other faces or another density of the same body, which has not moved since the last frame.

If inputs of the density move, the surface is refined again: the samples continue there, with the evenness
of the first frame as target. advance() then moves samples on density 0 to the nearest point with density.

Args:
    surface: a Surface with the other faces or density, wherever the body is.
    vertices: (v, 3) float64, of that surface on the last frame.
    samples: Samples with the present samples' faces and barycentric coordinates there; ids and classes stay.
    first: Samples of the surface, at the positions of the first frame.
    classes: as when the tracker was made, on this surface.
    anywhere: whether samples may move to any free area, as on a surface with new parts; otherwise only
        those that the density pushes together.
    context: a Context for progress and cancel.

Raises:
    SurfaceError: the number of vertices differs, or they are not finite.
    ValueError: samples, first or classes of another number than before, or of another surface.
    Cancelled: through the context.)")
      .def_property_readonly(
          "settled", [](const SharedTracker& t) { return t.read().settled(); },
          "Whether nothing was left to be caught up when the last frame was done.")
      .def("advance", &advance_tracker, py::arg("vertices"), py::kw_only(),
           py::arg("context") = nullptr,
           R"(Move to the next frame; the tracker is unchanged if this raises.

A frame with the same vertices as the last one costs nothing once the tracker is settled: report.evaluations is 0.

Args:
    vertices: (v, 3) float64, as many as the surface has, in the same order.
    context: a Context for progress and cancel.

Returns:
    Samples of the new frame; report.slide_mean and slide_max are distances from the carried positions, in spacings.

Raises:
    SurfaceError: the number of vertices differs, or they are not finite.
    Cancelled: through the context.)")
      .def_property_readonly(
          "surface",
          [](const SharedTracker& t) { return std::make_shared<Surface>(t.read().surface()); },
          "The Surface of the current frame.")
      .def_property_readonly(
          "samples",
          [](const SharedTracker& t) { return std::make_shared<Samples>(t.read().samples()); },
          "The Samples of the current frame.");
}

void bind_population(py::module_& m) {
  const std::string documentation =
      documented(kPopulation, R"(Samples on a deforming surface at a constant density per area.

Where the surface grows samples appear, where it shrinks some vanish; they never pop (Samples.fade goes from 0 to 1 or
back), and an id is never used again. Frames may have other faces: fluids, remeshed and torn bodies. Apart from that it
is a Tracker.

Args:
    surface: the Surface of the first frame.
    samples: its Samples; their number per capacity is kept.
    {options}
    classes: the SampleClass of each class of the samples, whose number per capacity is kept by itself (their counts are the
        samples'), or None: all are one class.
    context: a Context for progress and cancel.

Raises:
    ValueError: the samples do not belong to the surface, or their class is not given; an option out of range.
    Cancelled: through the context.)");
  py::class_<SharedPopulation, std::shared_ptr<SharedPopulation>> type(m, "Population",
                                                                       documentation.c_str());
  def_init(type, kPopulation, &make_population,
           "__init__(self: Population, surface: Surface, samples: Samples, *, {signature}, "
           "classes: Sequence[SampleClass | int] | None = None, "
           "context: Context | None = None) -> None",
           py::arg("surface"), py::arg("samples"));
  type.def("__reduce_ex__", refusal(kNotPickled));
  type.def("advance", &advance_population, py::arg("vertices"), py::arg("faces") = py::none(),
           py::kw_only(), py::arg("context") = nullptr,
           R"(Move to the next frame; the population is unchanged if this raises.

On other faces each sample continues from the nearest point on its side of the surface, which the winding of the faces
determines, if there is one within `reach`; otherwise it has lost its surface and vanishes. Apart from those no
more are born or die than the change of area requires, plus 0.5 % of them. Meshes of one shape differ a little in area, so there
their number may be off by 0.25 %.

Args:
    vertices: (v, 3) float64, or a Surface with its faces and density.
    faces: (m, 3) int32, of the vertices; None: those of the surface, which has as many vertices in the same order.
    context: a Context for progress and cancel.

Returns:
    Samples of the new frame: those that stay, then those that vanish; see their fade. report.births and
    deaths count those that do so from this frame on; on other faces slides are measured from the points where samples continue.

Raises:
    SurfaceError: vertices of another number without faces, or not finite; faces of no vertices.
    ValueError: the surface has grown so much that more samples or ids are needed than there can be; other faces on a
        surface with a density, without one of their own; other faces for samples of several classes.
    Cancelled: through the context.)")
      .def(
          "resume", &resume_population, py::arg("surface"), py::arg("samples"), py::arg("state"),
          R"(Continue from a frame that was solved before: the next frames have the same bytes as without an interruption.

The population must have the same beginning as the one that solved the frame; it is unchanged if this raises.

Args:
    surface: the Surface of that frame. To the last byte: where its faces are those of a frame before, that one's,
        deformed.
    samples: Samples with its faces, barycentric coordinates, ids and classes, made on that surface.
    state: the value of the property on that frame.

Raises:
    ValueError: naming the first entry of the samples or the state that does not match.)")
      .def_property_readonly(
          "state", &state_of,
          R"(The data of the current frame that resume() needs, beside its surface and samples: a dict of arrays and numbers, for a file.

fades (n,) float64 per sample; first_faces (m,) int32 and first_barycentric (m, 3) float64, where each of the m samples
that stay was on the first frame, on the current faces; starts (m + 1,) int64 and neighbors (k,) int32, rows of their
neighbors there; densities (c,) float64, samples per capacity of each class; next_id, above all ids so far; settled; faces_digest, by
which resume() tells a surface of other faces.)")
      .def_property_readonly(
          "surface",
          [](const SharedPopulation& p) { return std::make_shared<Surface>(p.read().surface()); },
          "The Surface of the current frame.")
      .def_property_readonly(
          "samples",
          [](const SharedPopulation& p) { return std::make_shared<Samples>(p.read().samples()); },
          "The Samples of the current frame.");
}

void bind_window(py::module_& m) {
  def_verb(
      m, kTrackWindow, &window_of,
      R"(track_window(surface: Surface, samples: Samples, frames: Iterable[numpy.ndarray], *, {signature}, classes: Sequence[SampleClass | int] | None = None, context: Context | None = None) -> list[Samples]

Samples on all frames of a motion, solved together, smooth in both directions of time.

A Tracker runs first; then sweeps go forward and backward over the frames and draw each sample to the middle between
where the surface carries it from the frame before and from the one after, as far as evenness allows.

Args:
    surface: the Surface of the first frame, which is not changed.
    frames: vertices, (v, 3) float64, of each frame after it.
    samples: Samples of the first frame.
    {options}
    classes: the SampleClass of each class of the samples (their counts are the samples'), or None: all are one class.
    context: a Context for progress and cancel.

Returns:
    list of Samples, of the first frame and of all after it; report.slide_mean and slide_max are distances from where
    the surface carries the samples of the frame before.

Raises:
    SurfaceError: the number of vertices differs, or they are not finite.
    ValueError: samples that are not of the surface, or of a class that is not given; an option out of range.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("frames"), py::arg("samples"));
}

void bind_window_tracker(py::module_& m) {
  const std::string documentation = documented(
      kWindowTracker,
      R"(Samples on a long motion, as smooth in both directions of time as with track_window(), some frames at a time.

Pieces of the motion overlap: the last frames of each are solved again with the piece after it, over which what was
found first passes into what is found then. So motion is as smooth at the seams as elsewhere, and no more than one piece
has to be in memory. track_pieces() does that for any number of frames.

Args:
    surface: the Surface of the first frame.
    samples: its Samples, which are not changed.
    {options}
    classes: the SampleClass of each class of the samples (their counts are the samples'), or None: all are one class.
    context: a Context for progress and cancel.

Raises:
    ValueError: the samples do not belong to the surface, or their class is not given; an option out of range.
    Cancelled: through the context.)");
  py::class_<SharedWindowTracker, std::shared_ptr<SharedWindowTracker>> type(m, "WindowTracker",
                                                                             documentation.c_str());
  def_init(type, kWindowTracker, &make_window_tracker,
           "__init__(self: WindowTracker, surface: Surface, samples: Samples, *, {signature}, "
           "classes: Sequence[SampleClass | int] | None = None, "
           "context: Context | None = None) -> None",
           py::arg("surface"), py::arg("samples"));
  type.def("__reduce_ex__", refusal(kNotPickled));
  type.def("advance", &advance_window, py::arg("frames"), py::arg("done"), py::kw_only(),
           py::arg("context") = nullptr,
           R"(Solve the frames after the present one; the tracker is unchanged if this raises.

Args:
    frames: vertices, (v, 3) float64, of each; first of those that were ahead so far.
    done: how many of them are final: the last of these becomes the present frame, the others are ahead. If all are,
        the motion ends there, and a closed one leads back to its first frame.
    context: a Context for progress and cancel.

Returns:
    list of Samples, of all these frames, as track_window() returns them.

Raises:
    SurfaceError: the number of vertices differs, or they are not finite.
    ValueError: fewer frames than are ahead or done.
    Cancelled: through the context.)")
      .def(
          "resume", &resume_window, py::arg("vertices"), py::arg("samples"), py::arg("ahead"),
          R"(Continue from frames that were solved before: the next ones have the same bytes as without an interruption.

Args:
    vertices: (v, 3) float64, of the present frame.
    samples: Samples with its faces and barycentric coordinates, as many as the tracker has, made on that frame's
        surface, the present one or the first; ids and classes stay.
    ahead: list of Samples with those of the frames ahead.

Raises:
    SurfaceError: the number of vertices differs, or they are not finite.
    ValueError: samples of another number, or of another surface: naming the first that is elsewhere.)")
      .def_property_readonly(
          "surface",
          [](const SharedWindowTracker& t) {
            return std::make_shared<Surface>(t.read().surface());
          },
          "The Surface of the present frame.")
      .def_property_readonly(
          "samples",
          [](const SharedWindowTracker& t) {
            return std::make_shared<Samples>(t.read().samples());
          },
          "The Samples of the present frame.")
      .def_property_readonly(
          "ahead", [](const SharedWindowTracker& t) { return shared(t.read().ahead()); },
          "list of the Samples of the frames that are to be solved again.");
}

}  // namespace

void bind_tracking(py::module_& m) {
  bind_tracker(m);
  bind_population(m);
  bind_window(m);
  bind_window_tracker(m);
}

}  // namespace dapple::python
