// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace dapple {

using PlaneKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Vertices have an index, faces a flag whether they are inside.
using ConstrainedTriangulation = CGAL::Constrained_Delaunay_triangulation_2<
    PlaneKernel,
    CGAL::Triangulation_data_structure_2<
        CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, PlaneKernel>,
        CGAL::Constrained_triangulation_face_base_2<
            PlaneKernel,
            CGAL::Triangulation_face_base_with_info_2<std::optional<bool>, PlaneKernel>>>,
    CGAL::No_constraint_intersection_tag>;

/// Mark which faces are inside: those that an odd number of walls separates from infinity.
/// \param is_wall whether the edge opposite to corner k of a face is one
template <typename IsWall>
void mark_inside(ConstrainedTriangulation& mesh, const IsWall& is_wall) {
  mesh.infinite_face()->info() = false;
  std::vector<ConstrainedTriangulation::Face_handle> pending = {mesh.infinite_face()};
  while (!pending.empty()) {
    const auto face = pending.back();
    pending.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto next = face->neighbor(k);
      if (next->info().has_value()) continue;
      next->info() = face->info().value_or(false) != is_wall(face, k);
      pending.push_back(next);
    }
  }
}

}  // namespace dapple
