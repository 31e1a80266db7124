// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/kept_triangles.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace dapple {
namespace {

using Edge = std::array<std::int32_t, 2>;

bool any_of(std::span<const std::int32_t> vertices, const std::vector<bool>& chosen) {
  return std::ranges::any_of(vertices, [&](std::int32_t v) { return chosen[as_index(v)]; });
}

/// Edges between others of triangles at chosen vertices, in the direction of the triangles, and
/// lines from chosen vertices to others. Both are sorted.
struct Rim {
  std::vector<Edge> edges, lines;

  Rim(std::span<const Face> triangles, std::span<const Edge> all_lines,
      const std::vector<bool>& chosen) {
    for (const Face& t : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (chosen[as_index(t[k])] && !chosen[as_index(t[(k + 1) % 3])] &&
            !chosen[as_index(t[(k + 2) % 3])])
          edges.push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
    for (const Edge& line : all_lines)
      if (chosen[as_index(line[0])] != chosen[as_index(line[1])]) lines.push_back(line);
    std::ranges::sort(edges);
    std::ranges::sort(lines);
  }
};

std::vector<Edge> differing(const std::vector<Edge>& a, const std::vector<Edge>& b) {
  std::vector<Edge> result;
  std::ranges::set_symmetric_difference(a, b, std::back_inserter(result));
  return result;
}

/// A mesh of which both, the one before and the dual, have vertices.
struct Mesh {
  std::span<const Face> triangles;
  std::span<const Edge> lines;
};

/// Take vertices out until the triangles at the others cover the same in both meshes.
void fit_together(const Mesh& one, const Mesh& other, std::vector<bool>& chosen) {
  for (;;) {
    const Rim a(one.triangles, one.lines, chosen), b(other.triangles, other.lines, chosen);
    std::vector<bool> apart(chosen.size(), false);
    for (const Edge& edge : differing(a.edges, b.edges))
      for (const std::int32_t v : edge) apart[as_index(v)] = true;
    for (const Edge& edge : differing(a.lines, b.lines))
      for (const std::int32_t v : edge) apart[as_index(v)] = true;
    bool changed = false;
    const auto take_out = [&](std::span<const std::int32_t> vertices) {
      if (!any_of(vertices, apart)) return;
      for (const std::int32_t v : vertices) {
        changed = changed || chosen[as_index(v)];
        chosen[as_index(v)] = false;
      }
    };
    for (const Mesh& mesh : {one, other})
      for (const Face& t : mesh.triangles) take_out(t);
    if (!changed) return;
  }
}

/// The sites of vertices that stay; -1 for others.
std::vector<std::int32_t> sites_of_vertices(const RemeshSites& sites) {
  std::vector<std::int32_t> result;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const Origin& origin = sites.origins[k];
    if (!origin.stays) continue;
    if (as_index(origin.vertex) >= result.size()) result.resize(as_index(origin.vertex) + 1, -1);
    result[as_index(origin.vertex)] = static_cast<std::int32_t>(k);
  }
  return result;
}

/// Triangles or lines with sites in place of vertices, as far as all of these stay.
template <typename Item>
std::vector<Item> renamed(std::span<const Item> items, std::span<const std::int32_t> site_of,
                          std::vector<bool>& chosen) {
  std::vector<Item> result;
  const auto name = [&](std::int32_t v) {
    return as_index(v) < site_of.size() ? site_of[as_index(v)] : -1;
  };
  for (Item item : items) {
    std::ranges::transform(item, item.begin(), name);
    if (std::ranges::find(item, -1) == item.end()) {
      result.push_back(item);
      continue;
    }
    for (const std::int32_t site : item)
      if (site >= 0) chosen[as_index(site)] = false;
  }
  return result;
}

}  // namespace

KeptTriangles::KeptTriangles(const RemeshResult& mesh)
    : triangles_(mesh.faces), lines_(mesh.lines), flawless_(mesh.report.flaws == 0) {}

void KeptTriangles::put_into(const RemeshSites& sites, Dual& dual) const {
  if (triangles_.empty()) return;
  const std::vector<std::int32_t> site_of = sites_of_vertices(sites);
  if (site_of.empty()) return;  // none stays
  std::vector<bool> chosen(sites.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) chosen[k] = sites.origins[k].stays;
  const std::vector<Face> triangles = renamed(std::span(triangles_), site_of, chosen);
  std::vector<Edge> lines = renamed(std::span(lines_), site_of, chosen);
  for (Edge& line : lines) std::ranges::sort(line);
  fit_together({triangles, lines}, {dual.triangles, dual.lines}, chosen);
  Dual result;
  const auto take = [&](const Face& t, const Place& corner) {
    result.triangles.push_back(t);
    result.corners.push_back(corner);
  };
  for (std::size_t k = 0; k < dual.triangles.size(); ++k)
    if (!any_of(dual.triangles[k], chosen)) take(dual.triangles[k], dual.corners[k]);
  for (const Face& t : triangles) {
    if (!any_of(t, chosen)) continue;
    const auto site = as_index(t[0]);
    take(t, {sites.sites.positions[site], sites.sites.faces[site], -1});
  }
  for (const Edge& line : dual.lines)
    if (!any_of(line, chosen)) result.lines.push_back(line);
  for (const Edge& line : lines)
    if (any_of(line, chosen)) result.lines.push_back(line);
  std::ranges::sort(result.lines);
  std::ranges::copy_if(
      dual.violations, std::back_inserter(result.violations),
      [&](const Violation& one) { return !flawless_ || !chosen[as_index(one.site)]; });
  dual = std::move(result);
}

}  // namespace dapple
