// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/chunk_cells.hpp"

#include <algorithm>
#include <cmath>

#include "base/pair_hash.hpp"
#include "base/prefetch.hpp"

namespace dapple {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rounding error of x . (x_j - x_i), relative to r |x_j - x_i|, where r is the radius of a polygon.
constexpr double kTie = 1e-14;
constexpr double kParallel = 1e-10;  // relative determinant of bisectors that hardly cross
constexpr std::size_t kFewPairs = 1024;
constexpr std::size_t kAhead = 12;  // faces: memory takes as long as that

/// The integrals of a region with a constant density from those with density 1.
Integrals flat(double density, double area, const Triple& first, double second) {
  const double squared = density * density;
  return {area, density * area, squared * area, squared * second, squared * first};
}

}  // namespace

void ChunkParts::clear() {
  cells.clear();
  boundaries.clear();
  islands.clear();
}

ChunkCells::ChunkCells(const LabeledMesh& mesh)
    : mesh_(&mesh), uniform_(mesh.surface.uniform()), pairs_(kFewPairs) {}

void ChunkCells::integrate(const ChunkFaces& faces, ChunkParts& parts) {
  begin(faces, parts);
  add_wholes();
  stage_chords();
  for (std::size_t k = 0; k < rest_.size(); ++k) {
    const std::size_t ahead = as_index(rest_[std::min(k + kAhead, rest_.size() - 1)]);
    prefetch(&mesh_->moments[ahead]);
    prefetch(&mesh_->normals[ahead]);
    divide(rest_[k]);
  }
  flush_segments();
}

void ChunkCells::begin(const ChunkFaces& faces, ChunkParts& parts) {
  faces_ = &faces;
  parts_ = &parts;
  originals_ = mesh_->sites.originals.data();
  parts.clear();
  rest_.clear();
  slots_.resize(std::max(slots_.size(), mesh_->sites.size()));
  if (++stamp_ == 0) {
    std::fill(slots_.begin(), slots_.end(), Slot());
    std::fill(pairs_.begin(), pairs_.end(), PairSlot());
    stamp_ = 1;
  }
  last_pair_ = std::numeric_limits<std::size_t>::max();
}

void ChunkCells::add_wholes() {
  const OrderedSurface& mesh = mesh_->surface.ordered();
  const Face* const corners = mesh_->edges.corners().data();
  const VertexLabel* const labels = mesh_->labels.data();
  const Vec3* const sites = mesh_->lists.positions();
  const std::vector<OrderedFace>& whole = faces_->whole;
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const OrderedFace face = whole[k], ahead = whole[std::min(k + kAhead, whole.size() - 1)];
    if (!mesh_->divided.of(face).empty()) {
      rest_.push_back(face);
      continue;
    }
    const std::int32_t site = labels[corners[as_index(face)][0]].site;
    prefetch(&mesh_->moments[as_index(ahead)]);
    if (!uniform_ && flat_density(ahead) < 0.0) mesh.prefetch(ahead);
    if (site < 0) continue;
    if (const double density = flat_density(face); density >= 0.0)
      add_flat(cell(site), face, density, Triple(sites[site]));
    else
      add_whole(face, site);
  }
}

/// A whole face of constant density.
void ChunkCells::add_flat(CellPart& part, OrderedFace face, double density, const Triple& x) const {
  const FaceMoments& whole = mesh_->moments[as_index(face)];
  const Triple offset = whole.centroid - x;
  const double mass = density * density * whole.area;
  part.pieces += whole.area > 0.0 ? mark_of(face) : 0;
  part.sum.area += whole.area;
  part.sum.capacity += density * whole.area;
  part.sum.mass += mass;
  part.sum.first = part.sum.first + mass * offset;
  part.sum.second += whole.second + mass * offset.squared_norm();
}

void ChunkCells::add_whole(OrderedFace face, std::int32_t site) {
  const FaceGeometry& geometry = mesh_->surface.ordered().geometry(face);
  const Moments& whole = geometry.moments;
  if (!(whole.area > 0.0)) return;
  CellPart& part = cell(site);
  part.pieces += mark_of(face);
  add_shifted(part.sum, whole, Triple(geometry.centroid) - position(site));
}

/// Divide the faces with two labels and one cut on each of two edges; the others go to rest_.
void ChunkCells::stage_chords() {
  const std::vector<OrderedFace>& cut = faces_->cut;
  for (std::size_t k = 0; k < cut.size(); ++k) {
    const std::size_t ahead = as_index(cut[std::min(k + kAhead, cut.size() - 1)]);
    prefetch(&mesh_->moments[ahead]);
    prefetch(&mesh_->normals[ahead]);
    if (!stage_chord(cut[k])) rest_.push_back(cut[k]);
  }
  cut_chords();
}

bool ChunkCells::stage_chord(OrderedFace face) {
  constexpr std::array<std::size_t, 8> kOdd = {3, 2, 0, 3, 1, 3, 3, 3};
  const Face& corners = mesh_->edges.corners()[as_index(face)];
  const VertexLabel* const labels = mesh_->labels.data();
  const std::array<std::int32_t, 3> label = {labels[corners[0]].site, labels[corners[1]].site,
                                             labels[corners[2]].site};
  const std::size_t odd = kOdd[(label[0] == label[1] ? 1U : 0U) | (label[1] == label[2] ? 2U : 0U) |
                               (label[2] == label[0] ? 4U : 0U)];
  if (odd == 3) return false;
  const std::int32_t j = label[odd], i = label[odd == 2 ? 0 : odd + 1];
  const double density = flat_density(face);
  if (i < 0 || j < 0 || !mesh_->divided.of(face).empty()) return false;
  const FaceEdges::OfFace& edges = mesh_->edges.of(face);
  const EdgeCuts::Link* const after = faces_->cuts.single(edges.edges[odd]);
  const EdgeCuts::Link* const before = faces_->cuts.single(edges.edges[odd == 0 ? 2 : odd - 1]);
  if (!after || !before || !(mesh_->moments[as_index(face)].area > 0.0)) return false;
  if (density < 0.0) {
    cut_linear_chord(face, odd, i, j, after->x, before->x);
    return true;
  }
  Chords& s = chords_;
  const std::size_t k = chord_count_++;
  const Vec3* const sites = mesh_->lists.positions();
  const Triple t(mesh_->vertices[as_index(corners[odd])]), xi(sites[i]);
  const Triple n(mesh_->normals[as_index(face)]);
  const Triple r = t - xi, d = Triple(sites[j]) - xi, u = after->x - t, v = before->x - t;
  s.cx[k] = r.x, s.cy[k] = r.y, s.cz[k] = r.z;
  s.ux[k] = u.x, s.uy[k] = u.y, s.uz[k] = u.z;
  s.vx[k] = v.x, s.vy[k] = v.y, s.vz[k] = v.z;
  s.dx[k] = d.x, s.dy[k] = d.y, s.dz[k] = d.z;
  s.nx[k] = n.x, s.ny[k] = n.y, s.nz[k] = n.z;
  s.density[k] = density;
  s.face[k] = face;
  s.i[k] = i;
  s.j[k] = j;
  if (chord_count_ == kStaged) cut_chords();
  return true;
}

/// The whole face goes to i, and the triangle at the odd corner from i to j.
void ChunkCells::cut_chords() {
  Chords& s = chords_;
  const std::size_t count = std::exchange(chord_count_, 0);
  integrate_chords(count);
  const Vec3* const sites = mesh_->lists.positions();
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t i = s.i[k], j = s.j[k];
    const double density = s.density[k];
    CellPart& rest = cell(i);
    add_flat(rest, s.face[k], density, Triple(sites[i]));
    add_integrals(rest.sum, flat(density, -s.area[k], {-s.ix[k], -s.iy[k], -s.iz[k]}, -s.i2[k]));
    CellPart& part = cell(j);
    part.pieces += mark_of(s.face[k]);
    add_integrals(part.sum, flat(density, s.area[k], {s.jx[k], s.jy[k], s.jz[k]}, s.j2[k]));
    add_boundary(i, j, density * Triple(s.flux_x[k], s.flux_y[k], s.flux_z[k]),
                 density * s.weight[k], s.length[k], s.path[k]);
  }
}

/// The same where the density varies: the face goes to i, and the triangle from i to j.
void ChunkCells::cut_linear_chord(OrderedFace face, std::size_t odd, std::int32_t i, std::int32_t j,
                                  const Triple& after, const Triple& before) {
  const FaceDensity density = linear_density(face, odd);
  const double at_after = density.at(after), at_before = density.at(before);
  const Triple u = after - density.corner, v = before - density.corner;
  const FaceGeometry& geometry = mesh_->surface.ordered().geometry(face);
  const Triple centroid(geometry.centroid), corner = density.corner - centroid;
  const double area = 0.5 * Triple(mesh_->normals[as_index(face)]).dot(u.cross(v));
  Integrals part;
  add_linear_triangle(part, area, corner, corner + u, corner + v, density.at_corner, at_after,
                      at_before);
  const Moments& whole = geometry.moments;
  const Integrals rest = {whole.area - part.area, whole.capacity - part.capacity,
                          whole.mass - part.mass, whole.second - part.second,
                          Triple(whole.first) - part.first};
  const auto add = [&](std::int32_t site, const Integrals& sum) {
    CellPart& to = cell(site);
    to.pieces += mark_of(face);
    add_shifted(to.sum, sum, centroid - position(site));
  };
  add(i, rest);
  add(j, part);
  add_segment(face, i, j, after, before, at_after, at_before);
}

void ChunkCells::integrate_chords(std::size_t count) {
  Chords& s = chords_;
  for (std::size_t k = 0; k < count; ++k) {
    const double ux = s.ux[k], uy = s.uy[k], uz = s.uz[k];
    const double vx = s.vx[k], vy = s.vy[k], vz = s.vz[k];
    const double area = 0.5 * (s.nx[k] * (uy * vz - uz * vy) + s.ny[k] * (uz * vx - ux * vz) +
                               s.nz[k] * (ux * vy - uy * vx));
    // The second moment about the triangle's own centroid.
    const double own =
        area * (1.0 / 18.0) *
        (ux * ux + uy * uy + uz * uz + vx * vx + vy * vy + vz * vz - (ux * vx + uy * vy + uz * vz));
    const double gx = s.cx[k] + (1.0 / 3.0) * (ux + vx), gy = s.cy[k] + (1.0 / 3.0) * (uy + vy),
                 gz = s.cz[k] + (1.0 / 3.0) * (uz + vz);
    const double hx = gx - s.dx[k], hy = gy - s.dy[k], hz = gz - s.dz[k];
    s.area[k] = area;
    s.ix[k] = area * gx, s.iy[k] = area * gy, s.iz[k] = area * gz;
    s.i2[k] = own + area * (gx * gx + gy * gy + gz * gz);
    s.jx[k] = area * hx, s.jy[k] = area * hy, s.jz[k] = area * hz;
    s.j2[k] = own + area * (hx * hx + hy * hy + hz * hz);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const double rx = s.cx[k] + s.ux[k], ry = s.cy[k] + s.uy[k], rz = s.cz[k] + s.uz[k];
    const double ax = s.vx[k] - s.ux[k], ay = s.vy[k] - s.uy[k], az = s.vz[k] - s.uz[k];
    const double nx = s.nx[k], ny = s.ny[k], nz = s.nz[k];
    const double dx = s.dx[k], dy = s.dy[k], dz = s.dz[k];
    const double dn = dx * nx + dy * ny + dz * nz;
    const double tx = dx - dn * nx, ty = dy - dn * ny, tz = dz - dn * nz;
    const double squared = ax * ax + ay * ay + az * az;
    const double length = std::sqrt(squared);
    const double weight = length / std::sqrt(tx * tx + ty * ty + tz * tz);
    s.flux_x[k] = weight * (rx + 0.5 * ax);
    s.flux_y[k] = weight * (ry + 0.5 * ay);
    s.flux_z[k] = weight * (rz + 0.5 * az);
    s.weight[k] = weight;
    s.length[k] = length;
    double t = -(rx * ax + ry * ay + rz * az) / squared;
    t = t > 0.0 ? t : 0.0;
    t = t < 1.0 ? t : 1.0;
    const double px = rx + t * ax, py = ry + t * ay, pz = rz + t * az;
    s.path[k] = px * px + py * py + pz * pz;
  }
}

/// A segment of the boundary between i and j, with the flux relative to i.
void ChunkCells::add_boundary(std::int32_t i, std::int32_t j, const Triple& flux, double weight,
                              double length, double squared_path) {
  if (!(length > 0.0) || !(std::abs(weight) < kInfinity)) return;
  const bool ordered = originals_[i] < originals_[j];
  BoundaryPart& part = ordered ? boundary(i, j) : boundary(j, i);
  part.flux = part.flux + flux;
  // About the other site: x - x_j = (x - x_i) - (x_j - x_i).
  if (!ordered) part.flux = part.flux - weight * (position(j) - position(i));
  part.weight += weight;
  part.length += length;
  part.squared_path = std::min(part.squared_path, squared_path);
}

/// A face that neither lies in one cell nor is staged.
void ChunkCells::divide(OrderedFace face) {
  if (!(mesh_->moments[as_index(face)].area > 0.0)) return;
  for_each_on_border(*mesh_, faces_->cuts, face,
                     [&](std::int32_t site) { cell(site).pieces += mark_of(face); });
  const std::span<const std::int32_t> owners = mesh_->divided.of(face);
  if (!owners.empty()) return divide_among(face, owners);
  const Face& corners = mesh_->edges.corners()[as_index(face)];
  for (const std::int32_t v : corners)
    if (label(v) < 0) return;
  if (divide_in_three(face)) return;
  if (divide_by_arcs(face)) {
    for (const FaceArcs::Arc& piece : arcs_.pieces())
      if (piece.points().size() >= 3) add_polygon(face, piece.site, piece.points());
    for (const FaceArcs::Chord& chord : arcs_.chords())
      add_segment(face, chord.i, chord.j, chord.p, chord.q);
    return;
  }
  clip(face);
}

/// A face with three labels and one cut on each edge, whose cells meet in one point.
bool ChunkCells::divide_in_three(OrderedFace face) {
  const Face& corners = mesh_->edges.corners()[as_index(face)];
  const FaceEdges::OfFace& edges = mesh_->edges.of(face);
  const std::array<std::int32_t, 3> sites = {label(corners[0]), label(corners[1]),
                                             label(corners[2])};
  if (sites[0] == sites[1] || sites[1] == sites[2] || sites[2] == sites[0]) return false;
  std::array<const EdgeCuts::Link*, 3> cuts;
  for (std::size_t k = 0; k < 3; ++k) {
    cuts[k] = faces_->cuts.single(edges.edges[k]);
    if (!cuts[k]) return false;
  }
  Triple x;
  if (!meeting_point(face, sites[0], sites[1], sites[2], x)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::array<Triple, 4> points = {Triple(mesh_->vertices[as_index(corners[k])]), cuts[k]->x,
                                          x, cuts[(k + 2) % 3]->x};
    add_polygon(face, sites[k], points);
    add_segment(face, sites[k], sites[(k + 1) % 3], cuts[k]->x, x);
  }
  return true;
}

bool ChunkCells::divide_by_arcs(OrderedFace face) {
  const Face& corners = mesh_->edges.corners()[as_index(face)];
  const FaceEdges::OfFace& edges = mesh_->edges.of(face);
  arcs_.start();
  bool fits = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t here = label(corners[k]), next = label(corners[(k + 1) % 3]);
    fits = fits && arcs_.add(Triple(mesh_->vertices[as_index(corners[k])]), here, next,
                             faces_->cuts.of(edges.edges[k]), (edges.upward >> k & 1) != 0);
  }
  return fits && arcs_.divide([&](std::int32_t i, std::int32_t j, std::int32_t k, Triple& x) {
    return meeting_point(face, i, j, k, x);
  });
}

/// The point of the face's plane that is as far from i as from j and k, if it is in the face and no
/// other site is nearer to it.
bool ChunkCells::meeting_point(OrderedFace face, std::int32_t i, std::int32_t j, std::int32_t k,
                               Triple& x) const {
  const Face& corners = mesh_->edges.corners()[as_index(face)];
  const Triple origin = position(i), dj = position(j) - origin, dk = position(k) - origin;
  const Triple a(mesh_->vertices[as_index(corners[0])]), r = a - origin;
  const Triple u = Triple(mesh_->vertices[as_index(corners[1])]) - a,
               v = Triple(mesh_->vertices[as_index(corners[2])]) - a;
  const double uj = u.dot(dj), vj = v.dot(dj), bj = 0.5 * dj.squared_norm() - r.dot(dj);
  const double uk = u.dot(dk), vk = v.dot(dk), bk = 0.5 * dk.squared_norm() - r.dot(dk);
  const double determinant = uj * vk - vj * uk;
  if (!(std::abs(determinant) > kParallel * (std::abs(uj * vk) + std::abs(vj * uk)))) return false;
  const double s = (bj * vk - bk * vj) / determinant, t = (uj * bk - uk * bj) / determinant;
  if (!(s >= 0.0 && t >= 0.0 && s + t <= 1.0)) return false;
  x = a + s * u + t * v;
  return mesh_->lists.nearer(x, mesh_->lists.squared_distance(i, x), i, j, k) < 0;
}

/// Clip the face to one cell after another, from those of its corners on.
void ChunkCells::clip(OrderedFace face) {
  const Face& corners = mesh_->edges.corners()[as_index(face)];
  const auto know = [this](std::int32_t site) {
    if (std::find(owners_.begin(), owners_.end(), site) == owners_.end()) owners_.push_back(site);
  };
  owners_.clear();
  for (const std::int32_t v : corners) know(label(v));
  for (std::size_t k = 0; k < owners_.size(); ++k) {
    const std::int32_t site = owners_[k];
    start_polygon(face, site);
    mesh_->lists.near_rivals(site, rivals_);
    cut_by_rivals(site);
    if (!polygon_.empty() && 4.0 * squared_radius_ >= mesh_->lists.known_reach(site)) {
      mesh_->lists.far_rivals(site, 4.0 * squared_radius_, rivals_);
      cut_by_rivals(site);
    }
    if (taken_by_ >= 0) know(taken_by_);
    if (!add_clipped(face, site)) continue;
    for (const Corner& corner : polygon_)
      if (corner.beyond >= 0) know(corner.beyond);
    const bool inside = std::all_of(polygon_.begin(), polygon_.end(),
                                    [](const Corner& corner) { return corner.beyond >= 0; });
    if (inside && mesh_->sites.faces[as_index(site)] != face) parts_->islands.push_back(face);
  }
}

void ChunkCells::start_polygon(OrderedFace face, std::int32_t site) {
  const Face& corners = mesh_->edges.corners()[as_index(face)];
  polygon_.clear();
  taken_by_ = -1;
  squared_radius_ = 0.0;
  for (std::int32_t k = 0; k < 3; ++k) {
    polygon_.push_back(
        {Triple(mesh_->vertices[as_index(corners[as_index(k)])]) - position(site), -1 - k});
    squared_radius_ = std::max(squared_radius_, polygon_.back().x.squared_norm());
  }
}

/// Only sites within twice the polygon's radius can cut it.
void ChunkCells::cut_by_rivals(std::int32_t site) {
  for (const Rival& rival : rivals_) {
    if (polygon_.empty() || rival.squared_distance > 4.0 * squared_radius_) return;
    cut_by(site, rival.site);
  }
}

/// Divide the face among some sites alone.
void ChunkCells::divide_among(OrderedFace face, std::span<const std::int32_t> owners) {
  owners_.assign(owners.begin(), owners.end());
  std::sort(owners_.begin(), owners_.end(),
            [this](std::int32_t a, std::int32_t b) { return originals_[a] < originals_[b]; });
  for (const std::int32_t site : owners_) {
    start_polygon(face, site);
    rivals_.clear();
    for (const std::int32_t other : owners_)
      if (other != site)
        rivals_.push_back(
            {mesh_->lists.squared_distance(other, position(site)), originals_[other], other});
    std::sort(rivals_.begin(), rivals_.end());
    cut_by_rivals(site);
    (void)add_clipped(face, site);
  }
}

/// Keep the part of the polygon that is nearer to a site than to another one. A polygon in their
/// bisector, up to rounding, belongs to the first of them.
void ChunkCells::cut_by(std::int32_t site, std::int32_t other) {
  const Triple d = position(other) - position(site);
  const double offset = 0.5 * d.squared_norm();
  sides_.resize(polygon_.size());
  double low = kInfinity, high = -kInfinity;
  for (std::size_t k = 0; k < polygon_.size(); ++k) {
    sides_[k] = polygon_[k].x.dot(d) - offset;
    low = std::min(low, sides_[k]);
    high = std::max(high, sides_[k]);
  }
  const double tie = kTie * std::sqrt(squared_radius_ * d.squared_norm());
  if (low >= -tie && high <= tie) {
    if (originals_[site] < originals_[other]) return;
    taken_by_ = other;
    polygon_.clear();
    return;
  }
  if (high <= 0.0) return;
  kept_.clear();
  for (std::size_t k = 0; k < polygon_.size(); ++k) {
    const std::size_t next = k + 1 < polygon_.size() ? k + 1 : 0;
    const double here = sides_[k], there = sides_[next];
    const Triple& x = polygon_[k].x;
    if (here <= 0.0) kept_.push_back(polygon_[k]);
    if ((here <= 0.0) != (there <= 0.0))
      kept_.push_back({x + here / (here - there) * (polygon_[next].x - x),
                       here <= 0.0 ? other : polygon_[k].beyond});
  }
  polygon_.swap(kept_);
  squared_radius_ = 0.0;
  for (const Corner& corner : polygon_)
    squared_radius_ = std::max(squared_radius_, corner.x.squared_norm());
}

/// \return whether there is a piece
bool ChunkCells::add_clipped(OrderedFace face, std::int32_t site) {
  if (polygon_.size() < 3) return false;
  points_.clear();
  for (const Corner& corner : polygon_) points_.push_back(corner.x + position(site));
  add_polygon(face, site, points_);
  for (std::size_t k = 0; k < polygon_.size(); ++k) {
    const std::int32_t other = polygon_[k].beyond;
    if (other >= 0 && mesh_->sites.original(site) < mesh_->sites.original(other))
      add_segment(face, site, other, points_[k], points_[k + 1 < points_.size() ? k + 1 : 0]);
  }
  return true;
}

ChunkCells::FaceDensity ChunkCells::linear_density(OrderedFace face, std::size_t corner) const {
  const OrderedSurface& mesh = mesh_->surface.ordered();
  const std::int32_t vertex = mesh_->edges.corners()[as_index(face)][corner];
  return {Triple(mesh.geometry(face).density_gradient), Triple(mesh_->vertices[as_index(vertex)]),
          mesh.density_unit() * mesh.densities(face)[static_cast<Eigen::Index>(corner)]};
}

/// A convex polygon of a cell.
void ChunkCells::add_polygon(OrderedFace face, std::int32_t site, std::span<const Triple> points) {
  if (const double flat = flat_density(face); flat >= 0.0)
    add_flat_polygon(face, flat, site, points);
  else
    add_linear_polygon(face, site, points);
}

void ChunkCells::add_linear_polygon(OrderedFace face, std::int32_t site,
                                    std::span<const Triple> points) {
  const Triple n(mesh_->normals[as_index(face)]), x = position(site), a = points[0] - x;
  const FaceDensity density = linear_density(face, 0);
  Integrals& sum = cell(site).sum;
  const double at_a = density.at(points[0]);
  Triple b = points[1] - x;
  double at_b = density.at(points[1]);
  for (std::size_t k = 2; k < points.size(); ++k) {
    const Triple c = points[k] - x;
    const double area = 0.5 * n.dot((b - a).cross(c - a)), at_c = density.at(points[k]);
    add_linear_triangle(sum, area, a, b, c, at_a, at_b, at_c);
    b = c;
    at_b = at_c;
  }
}

/// The same where the density is constant.
void ChunkCells::add_flat_polygon(OrderedFace face, double density, std::int32_t site,
                                  std::span<const Triple> points) {
  const Triple n(mesh_->normals[as_index(face)]), x = position(site), a = points[0] - x;
  Triple b = points[1] - x, first(0.0, 0.0, 0.0);
  double area = 0.0, second = 0.0;
  for (std::size_t k = 2; k < points.size(); ++k) {
    const Triple c = points[k] - x, sum = a + b + c;
    const double part = 0.5 * n.dot((b - a).cross(c - a));
    area += part;
    first = first + (part / 3.0) * sum;
    second += (part / 12.0) *
              (a.squared_norm() + b.squared_norm() + c.squared_norm() + sum.squared_norm());
    b = c;
  }
  add_integrals(cell(site).sum, flat(density, area, first, second));
}

/// The segment from p to q between the cells of i and j.
void ChunkCells::add_segment(OrderedFace face, std::int32_t i, std::int32_t j, const Triple& p,
                             const Triple& q) {
  const double flat = flat_density(face);
  if (flat >= 0.0) return add_segment(face, i, j, p, q, flat, flat);
  const FaceDensity density = linear_density(face, 0);
  add_segment(face, i, j, p, q, density.at(p), density.at(q));
}

void ChunkCells::add_segment(OrderedFace face, std::int32_t i, std::int32_t j, const Triple& p,
                             const Triple& q, double density_at_p, double density_at_q) {
  Segments& s = segments_;
  const std::size_t k = segment_count_++;
  const Triple n(mesh_->normals[as_index(face)]), x = position(i);
  const Triple d = position(j) - x, r = p - x, along = q - p;
  s.rx[k] = r.x, s.ry[k] = r.y, s.rz[k] = r.z;
  s.ax[k] = along.x, s.ay[k] = along.y, s.az[k] = along.z;
  s.dx[k] = d.x, s.dy[k] = d.y, s.dz[k] = d.z;
  s.nx[k] = n.x, s.ny[k] = n.y, s.nz[k] = n.z;
  s.fp[k] = density_at_p;
  s.fq[k] = density_at_q;
  s.i[k] = i;
  s.j[k] = j;
  if (segment_count_ == kStaged) flush_segments();
}

// Points of a bisector have equal distance from both sites, so a path through such a point has
// twice that length. Along a bisector phi (x - x_i) has degree 2: Simpson's rule is exact.
void ChunkCells::flush_segments() {
  Segments& s = segments_;
  const std::size_t count = std::exchange(segment_count_, 0);
  for (std::size_t k = 0; k < count; ++k) {
    const double nx = s.nx[k], ny = s.ny[k], nz = s.nz[k];
    const double dx = s.dx[k], dy = s.dy[k], dz = s.dz[k];
    const double ax = s.ax[k], ay = s.ay[k], az = s.az[k];
    const double rx = s.rx[k], ry = s.ry[k], rz = s.rz[k];
    const double squared = ax * ax + ay * ay + az * az;
    const double dn = dx * nx + dy * ny + dz * nz;
    const double tx = dx - dn * nx, ty = dy - dn * ny, tz = dz - dn * nz;
    const double length = std::sqrt(squared);
    const double unit = length / std::sqrt(tx * tx + ty * ty + tz * tz);
    const double middle = 0.5 * (s.fp[k] + s.fq[k]);
    // phi x at p, 4 times in the middle and at q, by the parts along r and along the segment
    const double mean = unit * middle;
    const double far = unit * (1.0 / 6.0) * (2.0 * middle + s.fq[k]);
    s.flux_x[k] = mean * rx + far * ax;
    s.flux_y[k] = mean * ry + far * ay;
    s.flux_z[k] = mean * rz + far * az;
    s.weight[k] = mean;
    s.length[k] = length;
    double u = -(rx * ax + ry * ay + rz * az) / squared;
    u = u > 0.0 ? u : 0.0;
    u = u < 1.0 ? u : 1.0;
    const double px = rx + u * ax, py = ry + u * ay, pz = rz + u * az;
    s.path[k] = px * px + py * py + pz * pz;
  }
  for (std::size_t k = 0; k < count; ++k)
    add_boundary(s.i[k], s.j[k], {s.flux_x[k], s.flux_y[k], s.flux_z[k]}, s.weight[k], s.length[k],
                 s.path[k]);
}

/// The part of a pair, found again by a hash table.
BoundaryPart& ChunkCells::boundary(std::int32_t first, std::int32_t second) {
  std::vector<BoundaryPart>& parts = parts_->boundaries;
  if (last_pair_ < parts.size() && parts[last_pair_].first == first &&
      parts[last_pair_].second == second)
    return parts[last_pair_];
  if (2 * parts.size() >= pairs_.size()) make_room_for_boundaries();
  PairSlot& slot = slot_of(first, second);
  if (slot.stamp != stamp_) {
    slot = {stamp_, static_cast<std::uint32_t>(parts.size()), first, second};
    parts.push_back({first, second});
  }
  last_pair_ = slot.place;
  return parts[slot.place];
}

/// The slot of a pair, or the free one for it.
ChunkCells::PairSlot& ChunkCells::slot_of(std::int32_t first, std::int32_t second) {
  for (std::uint64_t k = pair_hash(first, second) >> 32;; ++k) {
    PairSlot& slot = pairs_[k & (pairs_.size() - 1)];
    if (slot.stamp != stamp_ || (slot.first == first && slot.second == second)) return slot;
  }
}

void ChunkCells::make_room_for_boundaries() {
  std::vector<PairSlot> old(4 * pairs_.size());
  old.swap(pairs_);
  for (const PairSlot& slot : old)
    if (slot.stamp == stamp_) slot_of(slot.first, slot.second) = slot;
}

}  // namespace dapple
