// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/doubled.hpp"

#include <algorithm>
#include <map>

#include "base/progress.hpp"
#include "surface/places.hpp"

namespace dapple {
namespace {

/// The places of a face's corners.
Face at_places(const Face& corners, std::span<const std::int32_t> places) {
  const auto place = [&](std::size_t k) { return places[static_cast<std::size_t>(corners[k])]; };
  return {place(0), place(1), place(2)};
}

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

bool has_three_places(const Face& sorted) {
  return sorted[0] != sorted[1] && sorted[1] != sorted[2];
}

std::uint64_t hash(const Face& sorted) {
  const auto part = [&](std::size_t k, std::uint64_t prime) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(sorted[k])) * prime;
  };
  return part(0, 0x9e3779b97f4a7c15u) ^ part(1, 0xc2b2ae3d27d4eb4fu) ^ part(2, 0x165667b19e3779f9u);
}

/// For each face, the first face in the mesh's order that has the same corners.
std::vector<std::int32_t> first_equals(const std::vector<Face>& at, const Context* context) {
  std::vector<std::int32_t> result(at.size());
  Buckets faces(at.size());
  for (std::size_t f = 0; f < at.size(); ++f) {
    check_at(context, f);
    const auto number = result[f] = static_cast<std::int32_t>(f);
    if (!has_three_places(at[f])) continue;
    const std::uint64_t key = hash(at[f]);
    std::int32_t other = faces.first(key);
    while (other >= 0 && at[static_cast<std::size_t>(other)] != at[f]) other = faces.next(other);
    if (other < 0)
      faces.add(key, number);
    else
      result[f] = other;
  }
  return result;
}

DoubledFace doubled_face(OrderedFace face, OrderedFace counted, std::span<const Face> faces,
                         std::span<const std::int32_t> places) {
  const Face own = at_places(faces[as_index(face)], places);
  const Face others = at_places(faces[as_index(counted)], places);
  DoubledFace result{face, counted, {}};
  for (std::size_t k = 0; k < 3; ++k)
    result.corners[k] =
        static_cast<std::uint8_t>(std::find(others.begin(), others.end(), own[k]) - others.begin());
  return result;
}

}  // namespace

std::vector<std::int32_t> places_of(std::span<const Vec3> vertices, double tolerance,
                                    const Context* context) {
  Places places(vertices, tolerance);
  std::vector<std::int32_t> result;
  result.reserve(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    check_at(context, v);
    const auto number = static_cast<std::int32_t>(v);
    const std::int32_t found = places.find(vertices[v]);
    if (found < 0) places.add(number);
    result.push_back(found < 0 ? number : found);
  }
  return result;
}

std::vector<DoubledFace> find_doubled(std::span<const Face> faces,
                                      std::span<const std::int32_t> original_face,
                                      std::span<const std::int32_t> places,
                                      const Context* context) {
  std::vector<Face> at;
  at.reserve(faces.size());
  for (const Face& face : faces) {
    check_at(context, at.size());
    at.push_back(sorted(at_places(face, places)));
  }
  const std::vector<std::int32_t> first = first_equals(at, context);
  std::map<std::int32_t, std::vector<std::int32_t>> sets;  // equal faces, by their first
  for (std::size_t f = 0; f < first.size(); ++f)
    if (first[f] != static_cast<std::int32_t>(f))
      sets.try_emplace(first[f], 1, first[f]).first->second.push_back(static_cast<std::int32_t>(f));
  std::vector<DoubledFace> result;
  for (const auto& [_, equal] : sets) {
    const auto original = [&](std::int32_t f) {
      return original_face[static_cast<std::size_t>(f)];
    };
    const std::int32_t counted = *std::min_element(
        equal.begin(), equal.end(),
        [&](std::int32_t a, std::int32_t b) { return original(a) < original(b); });
    for (const std::int32_t face : equal)
      if (face != counted)
        result.push_back(doubled_face(OrderedFace{face}, OrderedFace{counted}, faces, places));
  }
  std::sort(result.begin(), result.end(),
            [](const DoubledFace& a, const DoubledFace& b) { return a.face < b.face; });
  return result;
}

std::vector<bool> left_out_faces(std::span<const DoubledFace> doubled, std::size_t face_count) {
  if (doubled.empty()) return {};
  std::vector<bool> result(face_count, false);
  for (const DoubledFace& one : doubled) result[as_index(one.face)] = true;
  return result;
}

}  // namespace dapple
