// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/mesh_editor.hpp"

#include <algorithm>

#include "base/sort_unique.hpp"

namespace dapple {
namespace {

std::size_t corner_of(const Face& t, std::int32_t v) {
  return static_cast<std::size_t>(std::ranges::find(t, v) - t.begin());
}

std::int32_t after(const Face& t, std::int32_t v) { return t[(corner_of(t, v) + 1) % 3]; }
std::int32_t before(const Face& t, std::int32_t v) { return t[(corner_of(t, v) + 2) % 3]; }

}  // namespace

MeshEditor::MeshEditor(const RemeshSites& sites, std::span<const Face> triangles,
                       std::span<const std::array<std::int32_t, 2>> lines)
    : sites_(sites), around_(sites.size()), lines_(lines.begin(), lines.end()) {
  MeshChange all;
  all.made.assign(triangles.begin(), triangles.end());
  apply(all);
}

std::vector<std::int32_t> MeshEditor::neighbors(std::int32_t v) const {
  std::vector<std::int32_t> result;
  for (const std::int32_t t : around(v))
    for (const std::int32_t w : triangle(t))
      if (w != v) result.push_back(w);
  sort_unique(result);
  return result;
}

std::vector<std::int32_t> MeshEditor::along_lines(std::int32_t v) const {
  std::vector<std::int32_t> result = neighbors(v);
  std::erase_if(result, [&](std::int32_t w) { return !is_line(v, w); });
  return result;
}

/// The triangle that has an edge in this direction; -1 if there is none, or several.
std::int32_t MeshEditor::beside(std::int32_t a, std::int32_t b) const {
  std::int32_t found = -1;
  for (const std::int32_t t : around(a)) {
    if (after(triangle(t), a) != b) continue;
    if (found >= 0) return -1;
    found = t;
  }
  return found;
}

std::vector<std::int32_t> MeshEditor::at_edge(std::int32_t a, std::int32_t b) const {
  std::vector<std::int32_t> result;
  for (const std::int32_t t : around(a))
    if (std::ranges::count(triangle(t), b) > 0) result.push_back(t);
  return result;
}

/// The triangles around a vertex, counter-clockwise, from a border or another line if it has one;
/// none if they are not one fan.
std::vector<std::int32_t> MeshEditor::fan(std::int32_t v) const {
  const std::span<const std::int32_t> all = around(v);
  if (all.empty()) return {};
  std::int32_t first = all.front();
  for (const std::int32_t t : all) {
    const std::int32_t w = after(triangle(t), v);
    if (is_line(v, w)) first = t;
    if (beside(w, v) < 0) {
      first = t;
      break;
    }
  }
  std::vector<std::int32_t> result;
  for (std::int32_t t = first; t >= 0;) {
    if (at_edge(v, after(triangle(t), v)).size() > 2) return {};
    result.push_back(t);
    if (result.size() > all.size()) return {};
    t = beside(v, before(triangle(t), v));
    if (t == first) break;
  }
  if (result.size() != all.size()) return {};
  if (at_edge(v, before(triangle(result.back()), v)).size() > 2) return {};
  return result;
}

MeshChange MeshEditor::moved(std::int32_t v) const {
  MeshChange change;
  change.gone = fan(v);
  std::int32_t sheet = 0;
  for (std::size_t k = 0; k < change.gone.size(); ++k) {
    const Face& t = triangle(change.gone[k]);
    if (k > 0 && is_line(v, after(t, v))) ++sheet;
    change.made.push_back(t);
    change.made_sheets.push_back(sheet);
  }
  change.gone_sheets = change.made_sheets;
  return change;
}

MeshChange MeshEditor::flipped(std::int32_t a, std::int32_t b) const {
  const std::int32_t t = beside(a, b), u = beside(b, a);
  if (is_line(a, b) || t < 0 || u < 0 || at_edge(a, b).size() != 2) return {};
  const std::int32_t c = before(triangle(t), a), d = before(triangle(u), b);
  if (c == d || !at_edge(c, d).empty()) return {};
  for (const std::int32_t v : {a, b})
    if (sites_.kinds[as_index(v)] == SiteKind::kFree && around(v).size() < 4) return {};
  return {{t, u}, {{a, d, c}, {d, b, c}}, {0, 0}, {0, 0}};
}

bool MeshEditor::may_collapse(std::int32_t a, std::int32_t b) const {
  const SiteKind kind = sites_.kinds[as_index(a)];
  if (kind == SiteKind::kCorner || (kind == SiteKind::kLine && !is_line(a, b))) return false;
  std::vector<std::int32_t> others;  // that both have as neighbors
  std::ranges::set_intersection(neighbors(a), neighbors(b), std::back_inserter(others));
  const std::vector<std::int32_t> between = at_edge(a, b);
  if (others.size() != between.size()) return false;
  for (const std::int32_t c : others)
    if (around(c).size() < 4 && sites_.kinds[as_index(c)] == SiteKind::kFree) return false;
  if (kind == SiteKind::kFree) return true;
  // A line stays one: its edges become no others.
  const std::vector<std::int32_t> along = along_lines(a);
  return along.size() == 2 &&
         std::ranges::none_of(others, [&](std::int32_t c) { return is_line(a, c); });
}

MeshChange MeshEditor::collapsed(std::int32_t a, std::int32_t b) const {
  if (!may_collapse(a, b)) return {};
  MeshChange change = moved(a);
  MeshChange result;
  result.gone = change.gone;
  result.gone_sheets = change.gone_sheets;
  for (std::size_t k = 0; k < change.made.size(); ++k) {
    Face t = change.made[k];
    if (std::ranges::count(t, b) > 0) continue;
    t[corner_of(t, a)] = b;
    result.made.push_back(t);
    result.made_sheets.push_back(change.made_sheets[k]);
  }
  return result;
}

MeshChange MeshEditor::split(std::int32_t a, std::int32_t b, std::int32_t vertex) const {
  const std::int32_t t = beside(a, b), u = beside(b, a);
  if (is_line(a, b) || t < 0 || u < 0 || at_edge(a, b).size() != 2) return {};
  const std::int32_t c = before(triangle(t), a), d = before(triangle(u), b);
  if (c == d) return {};
  return {{t, u},
          {{a, vertex, c}, {vertex, b, c}, {b, vertex, d}, {vertex, a, d}},
          {0, 0, 0, 0},
          {0, 0}};
}

void MeshEditor::apply(const MeshChange& change) {
  around_.resize(sites_.size());
  for (const std::int32_t t : change.gone) {
    for (const std::int32_t v : triangle(t)) std::erase(around_[as_index(v)], t);
    triangles_[as_index(t)] = {-1, -1, -1};
  }
  for (const Face& face : change.made) {
    for (const std::int32_t v : face)
      around_[as_index(v)].push_back(static_cast<std::int32_t>(triangles_.size()));
    triangles_.push_back(face);
  }
}

void MeshEditor::collapse(const MeshChange& change, std::int32_t a, std::int32_t b) {
  for (const std::int32_t w : along_lines(a)) {
    lines_.erase({std::min(a, w), std::max(a, w)});
    if (w != b) lines_.insert({std::min(b, w), std::max(b, w)});
  }
  apply(change);
}

std::vector<Face> MeshEditor::triangles() const {
  std::vector<Face> result;
  std::ranges::copy_if(triangles_, std::back_inserter(result),
                       [](const Face& t) { return t[0] >= 0; });
  return result;
}

}  // namespace dapple
