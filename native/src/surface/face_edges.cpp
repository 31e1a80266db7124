// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/face_edges.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "base/pair_hash.hpp"
#include "base/parallel.hpp"

namespace dapple {
namespace {

/// Numbers the edges of one chunk in the order of their first face.
class EdgeNumbers {
 public:
  explicit EdgeNumbers(std::vector<FaceEdges::Ends>& ends) : ends_(ends) {}

  std::uint16_t number_of(const FaceEdges::Ends& ends) {
    for (std::uint64_t k = pair_hash(ends[0], ends[1]) >> 51;; ++k) {
      std::uint16_t& slot = slots_[k % kSlots];
      if (slot == kFree) {
        slot = static_cast<std::uint16_t>(ends_.size());
        ends_.push_back(ends);
      }
      if (ends_[slot] == ends) return slot;
    }
  }

 private:
  static constexpr std::size_t kSlots = 8192;  // more than twice the edges of a chunk
  static constexpr std::uint16_t kFree = std::numeric_limits<std::uint16_t>::max();
  static_assert(std::size_t{6} * FaceEdges::kFaces < kSlots);

  std::vector<FaceEdges::Ends>& ends_;
  std::vector<std::uint16_t> slots_ = std::vector<std::uint16_t>(kSlots, kFree);
};

/// The faces with a vertex that lead from one to the next over the edges beside it, as far as each
/// of these edges has two faces.
class Fan {
 public:
  Fan(const OrderedSurface& mesh, std::span<const Face> corners, std::int32_t vertex,
      std::int32_t degree)
      : mesh_(mesh), corners_(corners), vertex_(vertex), degree_(degree) {}

  /// \return how many there are, `first` included, or -1 at an edge of three faces, or where faces
  ///         are not oriented alike
  std::int32_t size(OrderedFace first) {
    const std::int32_t ahead = walk(first, /*turn=*/0);
    if (ahead < 0 || closed_) return ahead;
    const std::int32_t back = walk(first, /*turn=*/2);
    return back < 0 ? back : ahead + back - 1;
  }

 private:
  /// \param turn 0 to leave a face by the edge that begins at the vertex, 2 by the one before it
  std::int32_t walk(OrderedFace first, std::int32_t turn) {
    std::int32_t count = 0;
    OrderedFace face = first;
    do {
      const std::int32_t corner = corner_of(face);
      if (corner < 0) return count;  // the surface goes on with another copy of the vertex
      if (++count > degree_) return -1;
      const std::int32_t h = half_edge(face, (corner + turn) % 3), g = mesh_.next_around(h);
      if (g == h) return count;
      if (mesh_.next_around(g) != h) return -1;
      face = face_of(g);
    } while (face != first);
    closed_ = true;
    return count;
  }

  std::int32_t corner_of(OrderedFace face) const {
    const Face& corners = corners_[as_index(face)];
    const auto at = std::find(corners.begin(), corners.end(), vertex_);
    return at == corners.end() ? -1 : static_cast<std::int32_t>(at - corners.begin());
  }

  const OrderedSurface& mesh_;
  std::span<const Face> corners_;
  std::int32_t vertex_, degree_;
  bool closed_ = false;
};

}  // namespace

FaceEdges::FaceEdges(const OrderedSurface& mesh)
    : corners_(mesh.connectivity().faces), face_at_(mesh.vertex_count(), -1) {
  copy_shared_vertices(mesh);
  number_edges();
  find_faces_of_vertices(mesh);
}

void FaceEdges::copy_shared_vertices(const OrderedSurface& mesh) {
  if (mesh.components() < 2) return;
  std::vector<std::int32_t> component(mesh.vertex_count(), -1);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> copies;
  for (std::size_t f = 0; f < corners_.size(); ++f)
    for (std::int32_t& v : corners_[f]) {
      const std::int32_t own = mesh.component(nth_face(f));
      if (component[as_index(v)] < 0) component[as_index(v)] = own;
      if (component[as_index(v)] == own) continue;
      const auto next = static_cast<std::int32_t>(mesh.vertex_count() + copied_.size());
      const auto [copy, is_new] = copies.try_emplace({v, own}, next);
      if (is_new) copied_.push_back(v);
      v = copy->second;
    }
  face_at_.resize(mesh.vertex_count() + copied_.size(), -1);
}

void FaceEdges::number_edges() {
  const std::size_t count = corners_.size(), chunks = (count + kFaces - 1) / kFaces;
  faces_.resize(count);
  std::vector<std::vector<Ends>> ends(chunks);
  parallel_chunks(count, kFaces, [&](std::size_t begin, std::size_t end) {
    EdgeNumbers numbers(ends[begin / kFaces]);
    ends[begin / kFaces].reserve(2 * kFaces);
    for (std::size_t f = begin; f < end; ++f) {
      faces_[f].upward = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = corners_[f][k], b = corners_[f][(k + 1) % 3];
        faces_[f].edges[k] = numbers.number_of({std::min(a, b), std::max(a, b)});
        faces_[f].upward = static_cast<std::uint16_t>(faces_[f].upward | (a < b ? 1U << k : 0U));
      }
    }
  });
  first_.assign(1, 0);
  for (const std::vector<Ends>& chunk : ends) first_.push_back(first_.back() + chunk.size());
  ends_.reserve(first_.back());
  for (const std::vector<Ends>& chunk : ends) ends_.insert(ends_.end(), chunk.begin(), chunk.end());
}

void FaceEdges::find_faces_of_vertices(const OrderedSurface& mesh) {
  before_.resize(vertex_count());
  std::vector<std::int32_t> degrees(vertex_count(), 0);
  for (std::size_t v = 0; v < before_.size(); ++v)
    before_[v] = static_cast<std::int32_t>(v % kVertices == 0 ? v : v - 1);
  for (std::size_t f = 0; f < corners_.size(); ++f) {
    if (!mesh.connectivity().doubled.empty() && !mesh.counts(nth_face(f))) continue;
    for (const std::int32_t v : corners_[f]) {
      ++degrees[as_index(v)];
      if (face_at_[as_index(v)] >= 0) continue;
      face_at_[as_index(v)] = static_cast<std::int32_t>(f);
      for (const std::int32_t u : corners_[f])
        if (u < v && as_index(u) / kVertices == as_index(v) / kVertices) before_[as_index(v)] = u;
    }
  }
  find_pinched(mesh, degrees);
}

void FaceEdges::find_pinched(const OrderedSurface& mesh, std::span<const std::int32_t> degrees) {
  std::vector<char> pinched(degrees.size(), 0);
  parallel_chunks(degrees.size(), kVertices, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (face_at_[v] < 0) continue;
      Fan fan(mesh, corners_, static_cast<std::int32_t>(v), degrees[v]);
      pinched[v] = fan.size(OrderedFace{face_at_[v]}) != degrees[v] ? 1 : 0;
    }
  });
  for (std::size_t v = 0; v < pinched.size(); ++v)
    if (pinched[v] != 0) pinched_.push_back(static_cast<std::int32_t>(v));
}

std::shared_ptr<const FaceEdges> face_edges_of(const OrderedSurface& mesh) {
  return mesh.connectivity().face_edges->get(
      [&] { return std::make_shared<const FaceEdges>(mesh); });
}

}  // namespace dapple
