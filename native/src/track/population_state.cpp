// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <dapple/population.hpp>
#include <string>

#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/validate_samples.hpp"
#include "surface/validate_surface.hpp"
#include "track/frame_solver.hpp"

namespace dapple {
namespace {

constexpr std::int64_t kAboveAllIds = std::int64_t{1} << 31;

void check_fades(std::span<const double> fades, std::size_t count) {
  check_same_length("state.fades", fades.size(), "samples", count);
  for (std::size_t k = 0; k < count; ++k)
    if (!(fades[k] >= 0.0 && fades[k] <= 1.0))
      throw ArgumentError(entry("state.fades", k) + " is " + number(fades[k]) + ", outside 0..1");
}

void check_neighbors(const PopulationState& state, std::size_t staying) {
  check_same_length("state.starts", state.starts.size(), "state.first_faces and one more",
                    staying + 1);
  if (state.starts.front() != 0 || state.starts.back() != state.neighbors.size() ||
      !std::is_sorted(state.starts.begin(), state.starts.end()))
    throw ArgumentError("state.starts does not rise from 0 to the length of state.neighbors, " +
                        std::to_string(state.neighbors.size()));
  check_face_indices("state.neighbors", state.neighbors, staying);
}

void check_ids(const Samples& samples, std::int64_t next_id) {
  for (std::size_t k = 0; k < samples.size(); ++k)
    if (samples.ids[k] >= next_id)
      throw ArgumentError("state.next_id is " + std::to_string(next_id) + ", not above " +
                          entry("samples.ids", k) + ", " + std::to_string(samples.ids[k]));
  if (next_id < 0 || next_id > kAboveAllIds)
    throw ArgumentError("state.next_id is " + std::to_string(next_id) + ", outside 0.." +
                        std::to_string(kAboveAllIds));
}

/// A digest of the vertex indices of the faces.
std::int64_t faces_digest(const Surface& surface) {
  std::uint64_t digest = 0xcbf29ce484222325u;  // FNV-1a over integers instead of bytes
  const auto add = [&](std::uint64_t value) { digest = (digest ^ value) * 0x100000001b3u; };
  add(surface.vertex_count());
  const std::vector<Face> faces = surface.faces();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_at(f);
    for (const std::int32_t corner : faces[f]) add(static_cast<std::uint64_t>(corner));
  }
  return static_cast<std::int64_t>(digest >> 1) | 1;  // never 0
}

void check_faces(const Surface& surface, std::int64_t digest) {
  if (digest != 0 && digest != faces_digest(surface))
    throw ArgumentError("state belongs to a frame with other faces than the surface's " +
                        std::to_string(surface.face_count()));
}

/// The positions of samples on the first frame.
Sites first_sites(const Surface& surface, const PopulationState& state) {
  try {
    return sites_of(bind_samples(surface, state.first_faces, state.first_barycentric));
  } catch (const ArgumentError& error) {
    throw ArgumentError(std::string("state.first_") + error.what());
  }
}

/// The first samples, up to a number, on a surface.
Samples first_of(const Surface& surface, const Samples& samples, std::size_t count) {
  return bind_samples(surface, std::span(samples.faces).first(count),
                      std::span(samples.barycentric).first(count),
                      std::span(samples.ids).first(count), std::span(samples.classes).first(count));
}

}  // namespace

PopulationState Population::state() const {
  const Sites& first = tracker_.solver_->first();
  const PatternMemory& memory = tracker_.solver_->memory();
  PopulationState state{.fades = samples_.fade,
                        .first_faces = first.faces,
                        .first_barycentric = first.barycentric,
                        .starts = memory.starts(),
                        .neighbors = memory.neighbors(),
                        .next_id = next_id_,
                        .settled = tracker_.settled(),
                        .faces_digest = faces_digest(surface())};
  for (const Kind& kind : kinds_) state.densities.push_back(kind.density);
  return state;
}

/// A frame of this body with the densities of the classes.
Surface Population::with_kinds(const Surface& frame) const {
  if (kinds_.size() == 1 && !kinds_[0].surface) return frame;
  if (!is_of_this_body(frame)) check_one_kind();
  return surface().deformed(frame.vertices());
}

void Population::resume(const Surface& frame, const Samples& samples,
                        const PopulationState& state) {
  const std::size_t staying = state.first_faces.size();
  if (staying > samples.size())
    throw ArgumentError("state.first_faces has " + std::to_string(staying) + " entries, samples " +
                        std::to_string(samples.size()));
  check_fades(state.fades, samples.size());
  check_neighbors(state, staying);
  check_ids(samples, state.next_id);
  check_same_length("state.densities", state.densities.size(), "the classes", kinds_.size());
  for (const double density : state.densities) check_at_least("state.densities", density, 0.0);
  check_faces(frame, state.faces_digest);
  const Surface there = with_kinds(frame);
  check_lengths(samples);
  check_bound_sites(
      "samples",
      std::array<const Surface*, 2>{&there, is_of_this_body(there) ? &surface() : &there},
      sites_of(samples));
  const Samples all =
      bind_samples(there, samples.faces, samples.barycentric, samples.ids, samples.classes);
  Population next = *this;
  next.tracker_.replace(there, first_of(there, all, staying), first_sites(there, state),
                        PatternMemory(state.starts, state.neighbors), state.settled);
  next.fades_.assign(state.fades.begin(),
                     state.fades.begin() + static_cast<std::ptrdiff_t>(staying));
  next.vanishing_.clear();
  for (std::size_t k = staying; k < all.size(); ++k)
    next.vanishing_.push_back(
        {all.ids[k], all.faces[k], all.barycentric[k], state.fades[k], all.classes[k]});
  for (std::size_t c = 0; c < kinds_.size(); ++c) next.kinds_[c].density = state.densities[c];
  next.next_id_ = state.next_id;
  next.join();
  *this = std::move(next);
}

}  // namespace dapple
