// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/surface_classes.hpp"

#include "base/validate.hpp"
#include "surface/ordered_surface.hpp"
#include "surface/validate_surface.hpp"
#include "voronoi/cell_surface.hpp"

namespace dapple {
namespace {

const Surface& surface_of(const Surface& all, const SampleClass& member) {
  return member.surface ? *member.surface : all;
}

/// The sum of the classes' densities, each scaled to its count, at the corners of the faces.
Surface union_surface(const Surface& surface, std::span<const SampleClass> classes) {
  std::vector<double> values(3 * surface.face_count(), 0.0);
  for (const SampleClass& member : classes) {
    const Surface& own = surface_of(surface, member);
    const double weight = static_cast<double>(member.count) / own.capacity();
    for (std::size_t f = 0; f < surface.face_count(); ++f) {
      const Vec3 densities =
          own.ordered().densities(own.ordered().ordered_face(static_cast<std::int32_t>(f)));
      for (std::size_t k = 0; k < 3; ++k)
        values[3 * f + k] += weight * densities[static_cast<Eigen::Index>(k)];
    }
  }
  return surface.with_density({DensityAt::kCorners, values});
}

std::size_t total(std::span<const SampleClass> classes) {
  std::size_t count = 0;
  for (const SampleClass& member : classes) count += member.count;
  return count;
}

void check_faces(const Surface& surface, std::span<const SampleClass> classes) {
  if (classes.empty()) throw ArgumentError("classes is empty: at least one is needed");
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (classes[c].image)
      throw ArgumentError(entry("classes", c) +
                          ".image is given: on a surface a class has its density as a surface");
    if (!surface_of(surface, classes[c]).same_faces(surface))
      throw ArgumentError(entry("classes", c) +
                          " has a surface of other faces: make it by with_density()");
  }
}

void check_locked(const Surface& surface, std::span<const SampleClass> classes) {
  for (std::size_t c = 0; c < classes.size(); ++c)
    check_bound_sites(classes.size() == 1 ? "locked" : entry("classes", c) + ".locked", surface,
                      classes[c].locked);
}

}  // namespace

ClassProblem surface_classes(const Surface& surface, std::span<const SampleClass> classes,
                             Cells cells, KnownSides sides) {
  check_faces(surface, classes);
  check_locked(surface, classes);
  if (!sides) sides = sides_for(surface, total(classes), cells);
  const auto own_domain =
      std::make_shared<const SurfaceDomain>(surface, cells, sides, EmptyFaces::kLeft);
  ClassProblem problem;
  const SampleClass* only = nullptr;  // the class that is not empty, if there is just one
  std::size_t filled = 0;
  bool alike = true;  // whether all classes have the surface's own density
  for (const SampleClass& member : classes) {
    problem.classes.push_back({member.surface
                                   ? std::make_shared<const SurfaceDomain>(*member.surface, cells,
                                                                           sides, EmptyFaces::kLeft)
                                   : own_domain,
                               member.count, member.radius, member.locked});
    alike = alike && !member.surface;
    if (member.count == 0) continue;
    only = &member;
    ++filled;
  }
  if (filled == 0 || alike)
    problem.all = own_domain;
  else if (filled == 1)
    problem.all = problem.classes[static_cast<std::size_t>(only - classes.data())].domain;
  else
    problem.all = std::make_shared<const SurfaceDomain>(union_surface(surface, classes), cells,
                                                        sides, EmptyFaces::kLeft);
  return problem;
}

}  // namespace dapple
