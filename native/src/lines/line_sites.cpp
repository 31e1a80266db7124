// SPDX-License-Identifier: GPL-3.0-or-later
#include "lines/line_sites.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kRound = 6.0;  // points of a closed line without corners, if it has so many edges

double density_root(const OrderedSurface& mesh, std::int32_t h, bool end) {
  const Vec3 values = mesh.densities(face_of(h));
  return std::sqrt(std::max(values[(h + (end ? 1 : 0)) % 3], 0.0));
}

/// Length of an edge of a chain in local units.
double metric(const OrderedSurface& mesh, std::int32_t h) {
  const Vec3 along = mesh.vertex(end_of(mesh, h)) - mesh.vertex(start_of(mesh, h));
  return 0.5 * (density_root(mesh, h, false) + density_root(mesh, h, true)) * along.norm();
}

void append_point(Sites& sites, const Sites& point) {
  sites.positions.push_back(point.positions[0]);
  sites.faces.push_back(point.faces[0]);
  sites.barycentric.push_back(point.barycentric[0]);
}

/// Per chain the fewest parts that make a mesh of it: closed ones become triangles at least, and no
/// two chains between the same corners are one edge each.
std::vector<double> fewest_parts(std::span<const LineChain> chains) {
  std::vector<double> result;
  std::map<std::pair<std::int32_t, std::int32_t>, int> between;
  const auto ends = [](const LineChain& chain) {
    const std::int32_t a = chain.vertices.front(), b = chain.vertices.back();
    return std::pair(std::min(a, b), std::max(a, b));
  };
  for (const LineChain& chain : chains) ++between[ends(chain)];
  for (const LineChain& chain : chains) {
    const auto [a, b] = ends(chain);
    const double round = chain.closed ? kRound : 3.0;
    result.push_back(a == b ? std::clamp(static_cast<double>(chain.half_edges.size()), 3.0, round)
                     : between[{a, b}] > 1 ? 2.0
                                           : 1.0);
  }
  return result;
}

/// Lengths along a chain in local units, up to the end of each edge.
std::vector<double> lengths_along(const OrderedSurface& mesh, const LineChain& chain) {
  std::vector<double> ends;
  ends.reserve(chain.half_edges.size());
  double total = 0.0;
  for (const std::int32_t h : chain.half_edges) ends.push_back(total += metric(mesh, h));
  return ends;
}

/// Place a site at each of the ascending lengths along a chain.
void place_at(const OrderedSurface& mesh, const LineChain& chain, std::span<const double> ends,
              std::span<const double> places, std::int32_t number, LineSites& result) {
  std::size_t e = 0;
  for (const double at : places) {
    while (e + 1 < ends.size() && ends[e] < at) ++e;
    const double from = e > 0 ? ends[e - 1] : 0.0;
    const double share =
        ends[e] > from ? std::clamp((at - from) / (ends[e] - from), 0.0, 1.0) : 0.0;
    append_point(result.sites, point_on_chain(mesh, chain, {e, share}));
    result.chains.push_back(number);
  }
}

/// A part of a line between two sites that are there.
struct Gap {
  double from, length;
  double parts;  // that new sites divide it into
};

/// The gaps between places, also those that a line has at its ends.
/// \param stops ascending; at least one on a closed chain
std::vector<Gap> gaps_between(bool closed, double total, std::vector<double> stops) {
  if (closed) {
    stops.push_back(stops.front() + total);
  } else {
    stops.insert(stops.begin(), 0.0);
    stops.push_back(total);
  }
  std::vector<Gap> gaps;
  for (std::size_t k = 0; k + 1 < stops.size(); ++k)
    gaps.push_back({stops[k], stops[k + 1] - stops[k], 1.0});
  return gaps;
}

/// Even places along a chain between those that are there, without its corners; ascending.
std::vector<double> even_places(const LineChain& chain, double total, double unit, double fewest,
                                std::vector<double> stops) {
  std::vector<double> places;
  if (chain.closed && stops.empty()) {
    stops = {0.0};
    places = {0.0};
  }
  std::ranges::sort(stops);
  std::vector<Gap> gaps = gaps_between(chain.closed, total, std::move(stops));
  double parts = 0.0;
  for (Gap& gap : gaps) parts += gap.parts = std::max(std::round(gap.length / unit), 1.0);
  std::ranges::max_element(gaps, {}, &Gap::length)->parts += std::max(fewest - parts, 0.0);
  for (const Gap& gap : gaps)
    for (double k = 1.0; k < gap.parts; ++k)
      places.push_back(gap.from + gap.length * k / gap.parts);
  for (double& place : places)
    if (place >= total) place -= total;  // across the beginning of a closed line
  std::ranges::sort(places);
  return places;
}

}  // namespace

Sites point_on_edge(const OrderedSurface& mesh, std::int32_t half_edge, double t) {
  Vec3 weights = Vec3::Zero();
  weights[half_edge % 3] = 1.0 - t;
  weights[(half_edge + 1) % 3] = t;
  const OrderedFace face = face_of(half_edge);
  return {{mesh.point(face, weights)}, {mesh.original_face(face)}, {weights}};
}

Sites point_on_chain(const OrderedSurface& mesh, const LineChain& chain, bool forward,
                     double distance) {
  const std::size_t count = chain.half_edges.size();
  const Vec3& origin = mesh.vertex(forward ? chain.vertices.front() : chain.vertices.back());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t e = forward ? k : count - 1 - k;
    const std::int32_t next = chain.vertices[forward ? e + 1 : e];
    const std::int32_t before = chain.vertices[forward ? e : e + 1];
    const double far = (mesh.vertex(next) - origin).norm();
    if (far < distance) continue;
    const double near = (mesh.vertex(before) - origin).norm();
    const double share = far > near ? std::clamp((distance - near) / (far - near), 0.0, 1.0) : 0.0;
    const std::int32_t h = chain.half_edges[e];
    return point_on_edge(mesh, h, start_of(mesh, h) == before ? share : 1.0 - share);
  }
  return {};
}

Sites point_on_chain(const OrderedSurface& mesh, const LineChain& chain, const ChainPlace& place) {
  const std::int32_t h = chain.half_edges[place.edge];
  const bool along = start_of(mesh, h) == chain.vertices[place.edge];
  return point_on_edge(mesh, h, along ? place.share : 1.0 - place.share);
}

LineSites sites_on_lines(const Surface& surface, const FeatureLines& lines, double unit,
                         const KeptOnLines& kept) {
  const OrderedSurface& mesh = surface.ordered();
  LineSites result;
  for (std::size_t k = 0; k < lines.corners().size(); ++k) {
    if (!kept.corners.empty() && kept.corners[k]) continue;
    append_point(result.sites, point_on_edge(mesh, lines.half_edge_at(k), 0.0));
    result.chains.push_back(-1);
  }
  result.corners = result.sites.size();
  const std::vector<double> fewest = fewest_parts(lines.chains());
  for (std::size_t k = 0; k < fewest.size(); ++k) {
    const LineChain& chain = lines.chains()[k];
    const std::vector<double> ends = lengths_along(mesh, chain);
    if (!(ends.back() > 0.0)) continue;
    std::vector<double> stops;
    if (!kept.places.empty())
      for (const auto& [e, share] : kept.places[k])
        stops.push_back((e > 0 ? ends[e - 1] : 0.0) + share * metric(mesh, chain.half_edges[e]));
    place_at(mesh, chain, ends, even_places(chain, ends.back(), unit, fewest[k], stops),
             static_cast<std::int32_t>(k), result);
  }
  return result;
}

double metric_length(const Surface& surface, const FeatureLines& lines, bool borders_only) {
  double total = 0.0;
  for (const LineChain& chain : lines.chains())
    for (const std::int32_t h : chain.half_edges)
      if (!borders_only || lines.kind(h) == LineKind::kBorder)
        total += metric(surface.ordered(), h);
  return total;
}

}  // namespace dapple
