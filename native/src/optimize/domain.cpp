// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/task_arena.h>

#include <algorithm>
#include <dapple/analysis.hpp>
#include <dapple/domain.hpp>

#include "base/hexagonal.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "surface/on_density.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"
#include "surface/walk.hpp"
#include "voronoi/cell_builders.hpp"
#include "voronoi/cell_surface.hpp"
#include "voronoi/unit_voronoi.hpp"

namespace dapple {
namespace {

constexpr double kCut = 0.3;  // share of the progress of an evaluation when large faces are cut

}  // namespace

double Domain::spacing(std::size_t count) const {
  return hexagonal_spacing(area() / static_cast<double>(std::max<std::size_t>(count, 1)));
}

RestrictedVoronoi Domain::cells(const Sites& sites, Context* context) const {
  RestrictedVoronoi diagram;
  update_cells(diagram, sites, 0, context);
  return diagram;
}

SurfaceDomain::SurfaceDomain(const Surface& surface, Cells cells, KnownSides sides,
                             EmptyFaces empty)
    : surface_(surface),
      cells_(cells),
      empty_(empty),
      cell_surfaces_(std::make_shared<CellSurfaces>(cells, std::move(sides))),
      builders_(std::make_shared<CellBuilders>()) {}

void SurfaceDomain::update_cells(RestrictedVoronoi& diagram, const Sites& sites, std::size_t set,
                                 Context* context) const {
  check_sites(surface_, sites);
  Stretch cutting(context, 0.0, kCut), dividing(context, kCut, 1.0);
  const CellSurface on = cell_surfaces_->at(surface_, sites.size(), cutting.context());
  if (!on.cut)
    return builders_->build(on.uncut(surface_), set, sites, cells_, empty_ == EmptyFaces::kLeft,
                            context, diagram);
  builders_->build(on.cut->surface(), set, on.cut->on_pieces(sites), cells_,
                   empty_ == EmptyFaces::kLeft, dividing.context(), diagram);
  remove_unit(diagram, on.cut->surface().ordered().density_unit() / density_unit());
}

Sites SurfaceDomain::project(std::span<const Vec3> points, std::span<const std::int32_t> hints,
                             const Context* context) const {
  if (points.empty()) return {};  // avoids creating a projector
  const Surface ground = stepping_surface();
  Projection found;
  if (hints.empty()) {
    found = projector(context).project(points, {}, context);
  } else {
    check_hints(surface_, points, hints);
    found = walk_to_nearest(ground, points, hints, context);
    lead_from_empty_faces(ground, points, found, context);
  }
  move_off_zeros(ground, found.faces, found.barycentric, found.positions);
  return {std::move(found.positions), std::move(found.faces), std::move(found.barycentric)};
}

/// If a walk from a face without density meets no face with density, the point moves to the nearest
/// face with density on the whole surface.
void SurfaceDomain::lead_from_empty_faces(const Surface& ground, std::span<const Vec3> points,
                                          Projection& found, const Context* context) const {
  if (ground.uniform()) return;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (has_density(ground, ground.ordered().ordered_face(found.faces[k]))) continue;
    const Projection nearest = projector(context).project(points.subspan(k, 1), {}, context);
    found.positions[k] = nearest.positions[0];
    found.faces[k] = nearest.faces[0];
    found.barycentric[k] = nearest.barycentric[0];
    found.distances[k] = nearest.distances[0];
  }
}

/// The surface on which steps start. It has no rims, because no step would move a site off a rim.
Surface SurfaceDomain::stepping_surface() const {
  const std::shared_ptr<const SidedSurface> sided = cell_surfaces_->known(surface_);
  return sided ? sided->without_rims : surface_;
}

const Projector& SurfaceDomain::projector(const Context* context) const {
  {
    const std::scoped_lock lock(making_);
    if (projector_) return *projector_;
  }
  // The projector is created without the lock, because a Poll may call this function again, and in
  // isolation, so that this thread starts none of our other tasks while Embree waits for its own
  // tasks.
  auto made = tbb::this_task_arena::isolate([&] {
    return std::make_unique<const Projector>(stepping_surface(), /*support_only=*/true, context);
  });
  const std::scoped_lock lock(making_);
  if (!projector_) projector_ = std::move(made);
  return *projector_;
}

double SurfaceDomain::capacity() const { return surface_.ordered().unit_capacity(); }

double SurfaceDomain::density_unit() const { return surface_.ordered().density_unit(); }

Vec3 SurfaceDomain::normal(std::int32_t face) const {
  return surface_.ordered().geometry(surface_.ordered().counted_face(face)).normal;
}

bool SurfaceDomain::has_bodies() const { return !surface_.ordered().connectivity().body.empty(); }

std::int32_t SurfaceDomain::body(std::int32_t face) const {
  const OrderedSurface& mesh = surface_.ordered();
  return mesh.body(mesh.counted_face(face));
}

std::vector<bool> SurfaceDomain::on_border(const Sites& sites,
                                           const RestrictedVoronoi& diagram) const {
  return cells_on_border(sampling_surface(sites.size()), sites, diagram);
}

Surface SurfaceDomain::sampling_surface(std::size_t count) const {
  return cell_surfaces_->at(surface_, count).uncut(surface_);
}

Surface SurfaceDomain::start_surface(std::size_t count) const {
  return cell_surfaces_->at(surface_, count).start(surface_);
}

void SurfaceDomain::check(const Sites& sites) const { check_sites(surface_, sites); }

}  // namespace dapple
