// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/ordered_surface.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>

#include "base/density_unit.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/reorder.hpp"
#include "surface/integrate.hpp"

namespace dapple {
namespace {

// A face thinner than this, relative to its longest edge, has no usable normal; its area counts as
// 0.
constexpr double kDegenerate = 1e-14;
// Shares of the progress.
constexpr double kPlaced = 0.1, kMeasured = 0.95;

/// Geometry of the triangle x with the density f at its corners.
FaceGeometry measure_face(const std::array<Vec3, 3>& x, const Vec3& f, bool uniform) {
  FaceGeometry face;
  face.centroid = (x[0] + x[1] + x[2]) / 3.0;
  const Vec3 cross = (x[1] - x[0]).cross(x[2] - x[0]);
  const double longest = std::max(
      {(x[1] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm(), (x[0] - x[2]).squaredNorm()});
  const double twice_area = cross.norm();
  if (twice_area == 0.0 || (std::isfinite(longest) && !(twice_area > kDegenerate * longest)))
    return face;
  face.normal = cross / twice_area;
  const Triple a(x[0] - face.centroid), b(x[1] - face.centroid), c(x[2] - face.centroid);
  Integrals sum;
  if (uniform) {
    add_uniform_triangle(sum, 0.5 * twice_area, a, b, c);
    finish_uniform(sum);
  } else {
    add_linear_triangle(sum, 0.5 * twice_area, a, b, c, f[0], f[1], f[2]);
  }
  add_integrals(face.moments, sum);
  if (uniform) return face;
  for (std::size_t k = 0; k < 3;
       ++k)  // the gradient of a hat function is normal x opposite edge / (2 area)
    face.density_gradient += f[static_cast<Eigen::Index>(k)] / twice_area *
                             face.normal.cross(x[(k + 2) % 3] - x[(k + 1) % 3]);
  return face;
}

bool same_bytes(const Vec3& a, const Vec3& b) {
  return std::ranges::equal(std::as_bytes(std::span(a.data(), 3)),
                            std::as_bytes(std::span(b.data(), 3)));
}

}  // namespace

DensityLayout density_layout(const Connectivity& mesh, DensityAt at) {
  return {at == DensityAt::kVertices ? mesh.original_vertex : mesh.original_face,
          at == DensityAt::kCorners ? std::size_t{3} : std::size_t{1}};
}

OrderedSurface::OrderedSurface(std::span<const Vec3> vertices,
                               std::shared_ptr<const Connectivity> connectivity,
                               const Density& density, Context* context)
    : connectivity_(std::move(connectivity)) {
  vertices_ =
      std::make_shared<const std::vector<Vec3>>(gather(vertices, connectivity_->original_vertex));
  place_density(density);
  Stretch measuring(context, kPlaced, kMeasured);
  measure(nullptr, measuring.context());
}

OrderedSurface OrderedSurface::deformed(std::span<const Vec3> vertices, Context* context) const {
  OrderedSurface result = *this;
  result.vertices_ =
      std::make_shared<const std::vector<Vec3>>(gather(vertices, connectivity_->original_vertex));
  Stretch measuring(context, kPlaced, kMeasured);
  result.measure(this, measuring.context());
  if (!shading_->given.empty())
    result.shading_ =
        std::make_shared<const Shading>(Shading{shading_->sharp_angle, shading_->hard, {}});
  return result;
}

bool OrderedSurface::has_vertices(std::span<const Vec3> vertices) const {
  if (vertices.size() != vertex_count()) return false;
  const std::vector<std::int32_t>& original = connectivity_->original_vertex;
  for (std::size_t v = 0; v < original.size(); ++v)
    if (!same_bytes((*vertices_)[v], vertices[static_cast<std::size_t>(original[v])])) return false;
  return true;
}

OrderedSurface OrderedSurface::shaded(std::shared_ptr<const Shading> shading) const {
  OrderedSurface result = *this;
  result.shading_ = std::move(shading);
  return result;
}

OrderedSurface OrderedSurface::with_density(const Density& density, Context* context) const {
  OrderedSurface result = *this;
  result.place_density(density);
  Stretch measuring(context, kPlaced, kMeasured);
  result.measure(this, measuring.context());
  return result;
}

const DoubledFace* OrderedSurface::doubled_face(OrderedFace face) const {
  const std::vector<DoubledFace>& doubled = connectivity_->doubled;
  if (doubled.empty()) return nullptr;
  const auto found =
      std::lower_bound(doubled.begin(), doubled.end(), face,
                       [](const DoubledFace& one, OrderedFace f) { return one.face < f; });
  return found != doubled.end() && found->face == face ? &*found : nullptr;
}

void OrderedSurface::place_density(const Density& density) {
  const auto [order, width] = density_layout(*connectivity_, density.at);
  density_ =
      std::make_shared<const Values>(Values{density.at, gather(density.values, order, width)});
}

void OrderedSurface::measure(const OrderedSurface* before, Context* context) {
  auto result = std::make_shared<Geometry>();
  const double unit = result->density_unit = find_density_unit();
  if (before &&
      (before->geometry_->density_unit != unit || before->density().empty() != density().empty()))
    before = nullptr;
  const std::size_t count = (face_count() + kBlock - 1) / kBlock;
  result->blocks.resize(count);
  Tally tally(context, count);
  parallel_chunks(count, 1, [&](std::size_t block, std::size_t) {
    tally.check();
    result->blocks[block] = before && !block_differs(block, *before)
                                ? before->geometry_->blocks[block]
                                : measure_block(block, unit);
    tally.add(1);
  });
  for (const auto& block : result->blocks) {
    result->first.push_back(block->faces.data());
    for (const double area : block->areas) result->area += area;
    for (const double capacity : block->capacities) result->unit_capacity += capacity;
  }
  check(*result);
  first_geometry_ = result->first.data();
  geometry_ = std::move(result);
}

std::shared_ptr<const OrderedSurface::Block> OrderedSurface::measure_block(std::size_t block,
                                                                           double unit) const {
  auto result = std::make_shared<Block>();
  const std::size_t end = std::min(face_count(), (block + 1) * kBlock);
  result->faces.reserve(kBlock);
  for (std::size_t f = block * kBlock; f < end; ++f) {
    const auto [a, b, c] = corners(nth_face(f));
    FaceGeometry& face = result->faces.emplace_back();
    if (counts(nth_face(f)))
      face = measure_face({vertex(a), vertex(b), vertex(c)}, unit * densities(nth_face(f)),
                          density_->values.empty());
    else
      face.centroid = (vertex(a) + vertex(b) + vertex(c)) / 3.0;
    result->areas.push_back(face.moments.area);
    result->capacities.push_back(face.moments.capacity);
  }
  return result;
}

bool OrderedSurface::differs(OrderedFace face, const OrderedSurface& before) const {
  const Face& v = corners(face);
  return (vertices_ != before.vertices_ &&
          std::any_of(v.begin(), v.end(),
                      [&](std::int32_t k) { return vertex(k) != before.vertex(k); })) ||
         (density_ != before.density_ && densities(face) != before.densities(face));
}

bool OrderedSurface::block_differs(std::size_t block, const OrderedSurface& before) const {
  const std::size_t end = std::min(face_count(), (block + 1) * kBlock);
  for (std::size_t f = block * kBlock; f < end; ++f)
    if (differs(nth_face(f), before)) return true;
  return false;
}

std::vector<OrderedFace> OrderedSurface::changed_faces(const OrderedSurface& before) const {
  std::vector<std::vector<OrderedFace>> found(geometry_->blocks.size());
  parallel_chunks(found.size(), 1, [&](std::size_t block, std::size_t) {
    if (geometry_->blocks[block] == before.geometry_->blocks[block]) return;
    const std::size_t end = std::min(face_count(), (block + 1) * kBlock);
    for (std::size_t f = block * kBlock; f < end; ++f)
      if (differs(nth_face(f), before)) found[block].push_back(nth_face(f));
  });
  std::vector<OrderedFace> result;
  for (const auto& faces : found) result.insert(result.end(), faces.begin(), faces.end());
  return result;
}

double OrderedSurface::find_density_unit() const {
  if (density_->values.empty()) return 1.0;
  const double most = *std::max_element(density_->values.begin(), density_->values.end());
  if (dapple::density_unit(most, 1.0) == 1.0) return 1.0;
  double area = 0.0, sum = 0.0;  // the largest value may be on a face without area
  for (std::size_t f = 0; f < face_count(); ++f) {
    if (!counts(nth_face(f))) continue;
    const auto [a, b, c] = corners(nth_face(f));
    const double twice = (vertex(b) - vertex(a)).cross(vertex(c) - vertex(a)).norm();
    area += twice;
    sum += twice * (densities(nth_face(f)) / most).mean();
  }
  return dapple::density_unit(most, sum / area);
}

void OrderedSurface::check(const Geometry& geometry) {
  if (!std::isfinite(geometry.area)) throw SurfaceError("vertices span an area that is not finite");
  if (!(geometry.area > 0.0))
    throw SurfaceError("faces have no area: all triangles are degenerate");
  if (!(geometry.unit_capacity > 0.0))
    throw SurfaceError("density is 0 wherever the faces have area: nothing can be placed");
  if (!std::isfinite(geometry.unit_capacity / geometry.density_unit))
    throw SurfaceError("density has an integral that is not finite: scale its values down");
}

Vec3 OrderedSurface::densities(OrderedFace face) const {
  const std::vector<double>& values = density_->values;
  if (values.empty()) return Vec3::Ones();
  const auto f = static_cast<std::size_t>(face);
  if (density_->at == DensityAt::kFaces) return Vec3::Constant(values[f]);
  if (density_->at == DensityAt::kCorners)
    return {values[3 * f], values[3 * f + 1], values[3 * f + 2]};
  const auto value = [&](std::int32_t v) { return values[static_cast<std::size_t>(v)]; };
  const auto [a, b, c] = corners(face);
  return {value(a), value(b), value(c)};
}

}  // namespace dapple
