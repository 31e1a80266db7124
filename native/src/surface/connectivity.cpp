// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/connectivity.hpp"

#include <algorithm>
#include <numeric>

#include "base/morton.hpp"
#include "base/progress.hpp"
#include "base/reorder.hpp"
#include "base/sort_unique.hpp"
#include "surface/weld.hpp"

namespace dapple {
namespace {

// Progress after each step.
constexpr double kVerticesOrdered = 0.12, kFacesOrdered = 0.35, kEdgesLinked = 0.65, kWelded = 0.94;

constexpr std::size_t kLookups = 65536;  // between two checks
constexpr double kFarthest = 1e300;      // a coordinate plus the size of a cell does not overflow
constexpr double kNoTolerance = -1.0;
constexpr std::size_t kDense =
    4;                        // numbers below so many times their count are counted as they are
constexpr double kAll = 2.0;  // in diagonals: exceeds the distance between any two vertices

/// A half-edge, and the higher vertex of its edge.
struct Link {
  std::int32_t high, half_edge;
  auto operator<=>(const Link&) const = default;
};

/// Link half-edges of the same lower vertex into rings where the higher one is the same, too.
void link_same(std::span<Link> links, std::vector<std::int32_t>& next) {
  std::sort(links.begin(), links.end());
  for (std::size_t first = 0; first < links.size();) {
    std::size_t last = first;
    while (last + 1 < links.size() && links[last + 1].high == links[first].high) ++last;
    for (std::size_t k = first; k <= last; ++k)
      next[static_cast<std::size_t>(links[k].half_edge)] =
          links[k == last ? first : k + 1].half_edge;
    first = last + 1;
  }
}

/// Link the half-edges of equal keys into rings, in the order of their faces. A half-edge without a
/// key forms a ring of its own. Few keys have the same lower number, by which they are counted.
/// \param for_each_key calls its argument with the lower and the higher number, the first of them
///                     below `count`, and the half-edge of each key; the same each time
template <typename ForEachKey>
std::vector<std::int32_t> link_rings(const ForEachKey& for_each_key, std::size_t count,
                                     std::size_t half_edges, Context* context) {
  std::vector<std::size_t> ends(count + 1, 0);  // at first one place later, per lower number
  for_each_key([&](std::int32_t low, std::int32_t, std::int32_t) {
    ++ends[static_cast<std::size_t>(low) + 1];
  });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<Link> links(ends.back());
  for_each_key([&](std::int32_t low, std::int32_t high, std::int32_t half_edge) {
    links[ends[static_cast<std::size_t>(low)]++] = {high, half_edge};
  });
  std::vector<std::int32_t> next(half_edges);
  if (links.size() < half_edges) std::iota(next.begin(), next.end(), 0);
  std::size_t begin = 0;
  for (std::size_t low = 0; low < count; ++low) {
    report_at(context, low, count);
    link_same(std::span(links).subspan(begin, ends[low] - begin), next);
    begin = ends[low];
  }
  return next;
}

/// Link the half-edges that share an (undirected) edge.
/// \param left_out faces that connect nothing; empty for none
std::vector<std::int32_t> link_edges(std::span<const Face> faces, std::size_t vertices,
                                     const std::vector<bool>& left_out, Context* context) {
  const auto for_each_key = [&](const auto& visit) {
    for (std::size_t f = 0; f < faces.size(); ++f) {
      check_at(context, f);
      if (!left_out.empty() && left_out[f]) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(faces[f][k], faces[f][(k + 1) % 3]);
        visit(low, high, static_cast<std::int32_t>(3 * f + k));
      }
    }
  };
  return link_rings(for_each_key, vertices, 3 * faces.size(), context);
}

/// Numbers from 0 that are equal where the given ones are, and not many more than there are.
std::vector<std::int32_t> dense(std::span<const std::int32_t> numbers) {
  std::vector<std::int32_t> result(numbers.begin(), numbers.end());
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  if (numbers.empty() || (*least >= 0 && static_cast<std::size_t>(*most) < kDense * numbers.size()))
    return result;
  std::vector<std::int32_t> known = result;
  sort_unique(known);
  for (std::int32_t& number : result)
    number = static_cast<std::int32_t>(std::lower_bound(known.begin(), known.end(), number) -
                                       known.begin());
  return result;
}

std::size_t end_of(std::span<const std::int32_t> numbers) {
  return numbers.empty() ? 0 : static_cast<std::size_t>(*std::ranges::max_element(numbers)) + 1;
}

/// Per number, the first place that has the same one.
/// \param numbers as of dense()
std::vector<std::int32_t> first_with_same(std::span<const std::int32_t> numbers,
                                          const Context* context) {
  std::vector<std::int32_t> first(end_of(numbers), -1), result;
  result.reserve(numbers.size());
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    check_at(context, k);
    std::int32_t& known = first[static_cast<std::size_t>(numbers[k])];
    if (known < 0) known = static_cast<std::int32_t>(k);
    result.push_back(known);
  }
  return result;
}

/// Number the sets of faces connected over edges, in the order of their first faces.
void find_components(Connectivity& mesh, const Context* context) {
  mesh.component.assign(mesh.faces.size(), -1);
  const std::vector<bool> left_out = left_out_faces(mesh.doubled, mesh.faces.size());
  std::vector<OrderedFace> pending;
  std::size_t seen = 0;
  const auto push = [&](OrderedFace face) {
    std::int32_t& component = mesh.component[as_index(face)];
    if (component >= 0) return;
    component = mesh.components;
    pending.push_back(face);
  };
  const auto next = [&](std::int32_t h) {
    return mesh.next_around_edge[static_cast<std::size_t>(h)];
  };
  for (std::size_t start = 0; start < mesh.faces.size(); ++start) {
    if (mesh.component[start] >= 0 || (!left_out.empty() && left_out[start])) continue;
    push(nth_face(start));
    while (!pending.empty()) {
      check_at(context, seen++);
      const OrderedFace face = pending.back();
      pending.pop_back();
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t h = half_edge(face, k);
        for (std::int32_t g = next(h); g != h; g = next(g)) push(face_of(g));
      }
    }
    ++mesh.components;
  }
  for (const DoubledFace& doubled : mesh.doubled)
    mesh.component[as_index(doubled.face)] = mesh.component[as_index(doubled.counted)];
}

std::vector<std::int32_t> invert(std::span<const std::int32_t> order, const Context* context) {
  std::vector<std::int32_t> inverse(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    check_at(context, k, kLookups);
    inverse[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
  }
  return inverse;
}

/// The largest distance between vertices at the same place; kNoTolerance if grid cells of that size
/// cannot be numbered. In that case the area of faces of such vertices is 0 or not finite.
double tolerance_of(std::span<const Vec3> vertices, double weld) {
  Vec3 low = vertices[0], high = vertices[0];
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    check_at(v, kLookups);
    low = low.cwiseMin(vertices[v]);
    high = high.cwiseMax(vertices[v]);
  }
  if (low.minCoeff() < -kFarthest || high.maxCoeff() > kFarthest) return kNoTolerance;
  return std::min(weld, kAll) * (high - low).stableNorm();
}

/// Link the edges; with `weld` also edges at the same place.
void link(std::span<const Vec3> vertices, std::optional<double> weld, Connectivity& mesh,
          Context* context) {
  Stretch linking(context, kFacesOrdered, kEdgesLinked), welding(context, kEdgesLinked, kWelded);
  mesh.weld = weld;
  const double tolerance = weld ? tolerance_of(vertices, *weld) : kNoTolerance;
  const bool welds = tolerance >= 0.0;
  const std::vector<Vec3> ordered = gather(vertices, mesh.original_vertex);
  mesh.welded_vertex.resize(vertices.size());
  std::iota(mesh.welded_vertex.begin(), mesh.welded_vertex.end(), 0);
  if (mesh.merge_doubled)
    mesh.doubled =
        find_doubled(mesh.faces, mesh.original_face,
                     welds ? places_of(ordered, tolerance, context) : mesh.welded_vertex, context);
  const std::vector<bool> left_out = left_out_faces(mesh.doubled, mesh.faces.size());
  mesh.next_around_edge = link_edges(mesh.faces, vertices.size(), left_out, linking.context());
  if (welds)
    mesh.welded_vertex = weld_borders(ordered, tolerance, mesh.faces, left_out,
                                      mesh.next_around_edge, welding.context());
}

/// Link the edges that the caller has identified.
void link(std::span<const std::int32_t> edges, std::span<const std::int32_t> places,
          Connectivity& mesh, Context* context) {
  Stretch linking(context, kFacesOrdered, kEdgesLinked);
  const std::vector<std::int32_t> place_of = gather(places, mesh.original_vertex);
  if (mesh.merge_doubled)
    mesh.doubled = find_doubled(mesh.faces, mesh.original_face, place_of, context);
  const std::vector<bool> left_out = left_out_faces(mesh.doubled, mesh.faces.size());
  const std::vector<std::int32_t> numbers = dense(edges);
  const auto for_each_key = [&](const auto& visit) {
    for (std::size_t h = 0; h < numbers.size(); ++h) {
      check_at(h, kLookups);
      if (!left_out.empty() && left_out[h / 3]) continue;
      const auto face = static_cast<std::size_t>(mesh.original_face[h / 3]);
      visit(numbers[3 * face + h % 3], 0, static_cast<std::int32_t>(h));
    }
  };
  mesh.next_around_edge =
      link_rings(for_each_key, end_of(numbers), numbers.size(), linking.context());
  mesh.welded_vertex = first_with_same(dense(place_of), context);
}

/// Order the faces and vertices; everything except the links.
Connectivity ordered_faces(std::span<const Vec3> vertices, std::span<const Face> faces,
                           Context* context) {
  Connectivity result;
  Stretch first(context, 0.0, kVerticesOrdered), second(context, kVerticesOrdered, kFacesOrdered);
  result.original_vertex = morton_order(vertices, first.context());
  const std::vector<std::int32_t> ordered_vertex = invert(result.original_vertex, context);
  std::vector<Vec3> centroids(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_at(context, f);
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return vertices[static_cast<std::size_t>(faces[f][k])];
    };
    centroids[f] = (corner(0) + corner(1) + corner(2)) / 3.0;
  }
  result.original_face = morton_order(centroids, second.context());
  result.ordered_face.reserve(faces.size());
  for (const std::int32_t face : invert(result.original_face, context)) {
    check_at(context, result.ordered_face.size(), kLookups);
    result.ordered_face.push_back(OrderedFace{face});
  }
  result.faces.reserve(faces.size());
  for (const std::int32_t f : result.original_face) {
    check_at(context, result.faces.size());
    const Face& face = faces[static_cast<std::size_t>(f)];
    const auto ordered = [&](std::size_t k) {
      return ordered_vertex[static_cast<std::size_t>(face[k])];
    };
    result.faces.push_back({ordered(0), ordered(1), ordered(2)});
  }
  return result;
}

}  // namespace

Connectivity connect(std::span<const Vec3> vertices, std::span<const Face> faces,
                     std::optional<double> weld, bool merge_doubled, Context* context) {
  Connectivity result = ordered_faces(vertices, faces, context);
  result.merge_doubled = merge_doubled;
  link(vertices, weld, result, context);
  if (context) context->advance(kWelded);
  find_components(result, context);
  return result;
}

Connectivity connect(std::span<const Vec3> vertices, std::span<const Face> faces,
                     const Joints& joints, bool merge_doubled, Context* context) {
  Connectivity result = ordered_faces(vertices, faces, context);
  result.merge_doubled = merge_doubled;
  link(joints.edges, joints.places, result, context);
  result.body = gather<std::int32_t>(joints.bodies, result.original_face);
  if (context) context->advance(kWelded);
  find_components(result, context);
  return result;
}

}  // namespace dapple
