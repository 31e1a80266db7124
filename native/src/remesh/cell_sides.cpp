// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/cell_sides.hpp"

#include <algorithm>
#include <limits>

#include "base/segment.hpp"
#include "base/sets.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kNothing = 1e-8;         // of a border: shorter edges are rounding
constexpr double kUnknownNothing = 1e-6;  // the same where no neighbor is known
constexpr double kOnSite = 1e-6;          // of a line's distance from a site: the site is on it

}  // namespace

CellSides CellWalk::sides_of(std::size_t site) {
  site_ = static_cast<std::int32_t>(site);
  begin_ = pieces_.first_edge(pieces_.first_piece(site));
  end_ = pieces_.first_edge(pieces_.first_piece(site + 1));
  CellSides result;
  if (begin_ == end_) return result;
  pair_edges();
  count_sheets();
  walked_.assign(mates_.size(), false);
  for (std::int32_t e = begin_; e < end_; ++e)
    if (mate(e) < 0 && !walked_[local(e)]) walk(e, result);
  judge(result);
  return result;
}

/// Connect pieces over edges of the mesh that are no lines.
void CellWalk::pair_edges() {
  const OrderedSurface& mesh = surface_.ordered();
  mates_.assign(as_index(end_ - begin_), -1);
  on_edges_.clear();
  for (std::int32_t e = begin_; e < end_; ++e) {
    const std::int32_t h = pieces_.half_edge(e);
    if (h >= 0 && !lines_.is_line(h)) on_edges_.push_back({std::min(h, mesh.next_around(h)), e});
  }
  std::ranges::sort(on_edges_);
  for (std::size_t k = 1; k < on_edges_.size(); ++k) {
    const auto [h, e] = on_edges_[k - 1];
    const auto [other, f] = on_edges_[k];
    if (h != other || pieces_.half_edge(e) == pieces_.half_edge(f)) continue;
    mate(e) = f;
    mate(f) = e;
    ++k;
  }
}

/// Find the sheets: pieces that are connected, and the Euler characteristic of each.
void CellWalk::count_sheets() {
  Sets pieces(mates_.size()), corners(mates_.size());  // a piece by its first edge
  const auto number = [&](std::int32_t e) { return static_cast<std::int32_t>(local(e)); };
  for (std::int32_t e = begin_; e < end_; ++e) {
    pieces.join(number(e), number(pieces_.first_edge(pieces_.piece_of(e))));
    const std::int32_t m = mate(e);
    if (m < 0) continue;
    pieces.join(number(e), number(m));
    corners.join(number(e), number(pieces_.next(m)));
    corners.join(number(pieces_.next(e)), number(m));
  }
  sheets_.clear();
  sheet_numbers_.assign(mates_.size(), -1);
  std::vector<std::int32_t> numbers(mates_.size(), -1);
  for (std::int32_t e = begin_; e < end_; ++e) {
    std::int32_t& sheet = numbers[as_index(pieces.find(number(e)))];
    if (sheet < 0) {
      sheet = static_cast<std::int32_t>(sheets_.size());
      sheets_.push_back({.root = e});
    }
    sheet_numbers_[local(e)] = sheet;
    std::int32_t& euler = sheets_[as_index(sheet)].euler;
    if (pieces_.first_edge(pieces_.piece_of(e)) == e) ++euler;
    if (corners.find(number(e)) == number(e)) ++euler;
    if (mate(e) < e) --euler;  // each edge once
  }
}

CellWalk::Sheet& CellWalk::sheet_of(std::int32_t edge) {
  return sheets_[as_index(sheet_numbers_[local(edge)])];
}

std::int32_t CellWalk::next_on_border(std::int32_t edge) const {
  std::int32_t next = pieces_.next(edge);
  while (mate(next) >= 0) next = pieces_.next(mate(next));
  return next;
}

/// The site beyond an edge of the border, or kLine, kUnknown.
std::int32_t CellWalk::beyond(std::int32_t edge) const {
  const std::int32_t h = pieces_.half_edge(edge);
  if (h < 0) return pieces_.rival(edge);
  if (lines_.is_line(h)) return Side::kLine;
  const std::int32_t g = surface_.ordered().next_around(h);
  double longest = 0.0;
  std::int32_t found = Side::kUnknown;
  const Vec3 &from = pieces_.from(edge), &to = pieces_.to(edge);
  const auto share = [&](const Vec3& p) { return nearest_share(p, from, to); };
  for (const std::int32_t piece : pieces_.on_face(face_of(g))) {
    if (pieces_.site_of(piece) == site_) continue;
    for (std::int32_t e = pieces_.first_edge(piece); e < pieces_.first_edge(piece + 1); ++e) {
      if (pieces_.half_edge(e) != g) continue;
      const double covered = std::abs(share(pieces_.from(e)) - share(pieces_.to(e)));
      if (covered > longest) found = pieces_.site_of(piece);
      longest = std::max(longest, covered);
    }
  }
  return found;
}

void CellWalk::walk(std::int32_t start, CellSides& result) {
  std::vector<std::int32_t> loop;
  for (std::int32_t e = start; !walked_[local(e)]; e = next_on_border(e)) {
    walked_[local(e)] = true;
    loop.push_back(e);
  }
  ++sheet_of(start).loops;
  add_sides(loop, result);
}

void CellWalk::add_sides(std::span<const std::int32_t> loop, CellSides& result) {
  std::vector<std::int32_t> labels, edges;
  double total = 0.0;
  for (const std::int32_t e : loop) total += pieces_.length(e);
  for (const std::int32_t e : loop) {
    const std::int32_t label = beyond(e);
    const double least = label == Side::kUnknown ? kUnknownNothing : kNothing;
    if (label != Side::kLine && pieces_.length(e) <= least * total) continue;
    labels.push_back(label);
    edges.push_back(e);
  }
  if (edges.empty()) return;
  std::size_t begin = 0;  // where a side begins
  while (begin < labels.size() &&
         labels[begin] == labels[(begin + labels.size() - 1) % labels.size()])
    ++begin;
  if (begin == labels.size()) begin = 0;
  const auto first = static_cast<std::int32_t>(result.sides.size());
  double longest = -1.0, nearest = 0.0;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const std::size_t at = (begin + k) % labels.size();
    if (k == 0 || labels[at] != result.sides.back().neighbor) {
      result.sides.push_back({.site = site_, .neighbor = labels[at], .first = edges[at]});
      longest = -1.0;
      nearest = std::numeric_limits<double>::infinity();
    }
    Side& side = result.sides.back();
    const double length = pieces_.length(edges[at]);
    side.length += length;
    side.last = edges[at];
    if (length > longest) side.longest = edges[at];
    longest = std::max(longest, length);
    const Vec3 middle = 0.5 * (pieces_.from(edges[at]) + pieces_.to(edges[at]));
    const double distance = (middle - sites_.positions[as_index(site_)]).squaredNorm();
    if (distance < nearest) side.nearest = edges[at];
    nearest = std::min(nearest, distance);
  }
  const auto last = static_cast<std::int32_t>(result.sides.size()) - 1;
  Sheet& sheet = sheet_of(loop.front());
  for (std::int32_t s = first; s <= last; ++s) {
    Side& side = result.sides[as_index(s)];
    side.before = s == first ? last : s - 1;
    side.after = s == last ? first : s + 1;
    if (side.neighbor == Side::kLine) look_at_line(side, loop, sheet, result);
    if (side.neighbor >= 0) ++sheet.neighbors;
  }
}

/// Whether a line that a cell reaches is that of its site.
void CellWalk::look_at_line(const Side& side, std::span<const std::int32_t> loop, Sheet& sheet,
                            CellSides& result) {
  const Vec3& site = sites_.positions[as_index(site_)];
  double least = std::numeric_limits<double>::infinity(), passed = 0.0;
  Place nearest, middle;
  const auto at = static_cast<std::size_t>(std::ranges::find(loop, side.first) - loop.begin());
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::int32_t e = loop[(at + k) % loop.size()];
    const Vec3 &a = pieces_.from(e), &b = pieces_.to(e);
    const double share = nearest_share(site, a, b), length = (b - a).norm();
    const double distance = (a + share * (b - a) - site).norm();
    if (distance < least) nearest = place_on(e, share);
    least = std::min(least, distance);
    if (const double half = 0.5 * side.length; passed <= half && half <= passed + length)
      middle = place_on(e, length > 0.0 ? (half - passed) / length : 0.0);
    passed += length;
    if (e == side.last) break;
  }
  const double reach = std::max(passed, least);
  if (kinds_[as_index(site_)] != SiteKind::kFree && least <= kOnSite * reach) {
    ++sheet.own_lines;
    return;
  }
  sheet.foreign = true;
  if (middle.half_edge < 0) middle = nearest;
  result.violations.push_back({site_, Flaw::kForeignLine, middle, nearest});
}

void CellWalk::judge(CellSides& result) {
  for (const Sheet& sheet : sheets_) {
    if (sheet.foreign) continue;  // said already
    if (sheet.own_lines == 0 && !holds_site(sheet)) {
      result.violations.push_back({site_, Flaw::kNoDisc, middle(sheet), {}});
      continue;
    }
    const bool disc = sheet.loops == 1 && sheet.euler == 1 && sheet.own_lines <= 1;
    if (!disc)
      result.violations.push_back({site_, Flaw::kNoDisc, farthest(sheet), {}});
    else if (sheet.neighbors < (sheet.own_lines > 0 ? 2 : 3))
      result.violations.push_back({site_, Flaw::kFewSides, farthest(sheet), {}});
  }
}

Place CellWalk::place_on(std::int32_t edge, double share) const {
  const OrderedSurface& mesh = surface_.ordered();
  Place result;
  result.position = pieces_.from(edge) + share * (pieces_.to(edge) - pieces_.from(edge));
  result.face = pieces_.face_of_piece(pieces_.piece_of(edge));
  const std::int32_t h = pieces_.half_edge(edge);
  if (h < 0 || !lines_.is_line(h)) return result;
  const auto& corners = mesh.corners(face_of(h));
  const Vec3 &a = mesh.vertex(corners[as_index(h % 3)]),
             &b = mesh.vertex(corners[as_index((h + 1) % 3)]);
  result.half_edge = h;
  result.position = a + nearest_share(result.position, a, b) * (b - a);
  return result;
}

/// Whether the site lies in a sheet: a cell can go through a wall, to where its site is not.
bool CellWalk::holds_site(const Sheet& sheet) const {
  const Vec3& site = sites_.positions[as_index(site_)];
  for (std::int32_t e = begin_; e < end_; ++e) {
    if (!is_in(e, sheet)) continue;
    if (pieces_.face_of_piece(pieces_.piece_of(e)) == sites_.faces[as_index(site_)]) return true;
    if ((pieces_.from(e) - site).norm() <= kOnSite * pieces_.length(e)) return true;
  }
  return false;
}

bool CellWalk::is_in(std::int32_t edge, const Sheet& sheet) const {
  return sheet_numbers_[local(edge)] == sheet_numbers_[local(sheet.root)];
}

/// A place within a sheet: the middle of its piece with the longest edge.
Place CellWalk::middle(const Sheet& sheet) const {
  double most = -1.0;
  std::int32_t at = sheet.root;
  for (std::int32_t e = begin_; e < end_; ++e) {
    if (!is_in(e, sheet) || pieces_.length(e) <= most) continue;
    most = pieces_.length(e);
    at = e;
  }
  Place result = place_on(at, 0.0);
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  const std::int32_t piece = pieces_.piece_of(at);
  for (std::int32_t e = pieces_.first_edge(piece); e < pieces_.first_edge(piece + 1); ++e) {
    sum += pieces_.from(e);
    ++count;
  }
  result.position = sum / count;
  result.half_edge = -1;
  return result;
}

/// The corner of a sheet that is farthest from the site.
Place CellWalk::farthest(const Sheet& sheet) const {
  double most = -1.0;
  std::int32_t at = sheet.root;
  for (std::int32_t e = begin_; e < end_; ++e) {
    if (!is_in(e, sheet)) continue;
    const double distance = (pieces_.from(e) - sites_.positions[as_index(site_)]).squaredNorm();
    if (distance > most) at = e;
    most = std::max(most, distance);
  }
  return place_on(at, 0.0);
}

}  // namespace dapple
