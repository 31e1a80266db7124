// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/islands.hpp"

#include <span>

#include "base/sets.hpp"
#include "surface/on_density.hpp"

namespace dapple {
namespace {

/// Whether the density is positive along a half-edge, on the side of its face.
bool has_density_along(const OrderedSurface& mesh, std::int32_t half_edge) {
  const Vec3 values = mesh.densities(face_of(half_edge));
  return values[half_edge % 3] > 0.0 || values[(half_edge + 1) % 3] > 0.0;
}

/// Per face, whether it has density.
std::vector<char> dense_faces(const Surface& surface) {
  std::vector<char> dense(surface.face_count());
  for (std::size_t f = 0; f < dense.size(); ++f) dense[f] = has_density(surface, nth_face(f));
  return dense;
}

void join_over_edges(const OrderedSurface& mesh, std::span<const char> dense, std::size_t f,
                     Sets& sets) {
  for (std::int32_t k = 0; k < 3; ++k) {
    const std::int32_t h = half_edge(nth_face(f), k);
    if (!has_density_along(mesh, h)) continue;
    for (std::int32_t g = mesh.next_around(h); g != h; g = mesh.next_around(g))
      if (g > h && dense[as_index(face_of(g))] != 0 && has_density_along(mesh, g))
        sets.join(static_cast<std::int32_t>(f), static_cast<std::int32_t>(as_index(face_of(g))));
  }
}

std::vector<std::int32_t> labels_of(const Surface& surface) {
  const OrderedSurface& mesh = surface.ordered();
  const std::vector<char> dense = dense_faces(surface);
  Sets sets(mesh.face_count());
  for (std::size_t f = 0; f < dense.size(); ++f)
    if (dense[f] != 0) join_over_edges(mesh, dense, f, sets);
  std::vector<std::int32_t> labels(dense.size()), numbers(dense.size(), -1);
  std::int32_t count = 1;  // 0: no density
  for (std::size_t f = 0; f < labels.size(); ++f) {
    if (dense[f] == 0) continue;
    std::int32_t& number =
        numbers[static_cast<std::size_t>(sets.find(static_cast<std::int32_t>(f)))];
    if (number < 0) number = count++;
    labels[f] = number;
  }
  return labels;
}

}  // namespace

Islands::Islands(const Surface& surface) : connectivity_(surface.ordered().shared_connectivity()) {
  const OrderedSurface& mesh = surface.ordered();
  if (dapple::has_gaps(surface)) labels_ = labels_of(surface);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::size_t island = at(nth_face(f));
    if (island >= capacities_.size()) capacities_.resize(island + 1, 0.0);
    capacities_[island] += mesh.geometry(nth_face(f)).moments.capacity;
  }
}

std::shared_ptr<const Islands> islands_of(const Surface& surface) {
  return surface.ordered().islands().get([&] { return std::make_shared<const Islands>(surface); });
}

}  // namespace dapple
