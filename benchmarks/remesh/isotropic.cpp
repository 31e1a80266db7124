// SPDX-License-Identifier: GPL-3.0-or-later
// Remeshes by CGAL: dapple_isotropic IN.off OUT.off EDGE, where EDGE is the length of the new
// edges. Creases of more than 30 degrees stay.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>

#include <cstdlib>
#include <fstream>
#include <iostream>

namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;

constexpr double kCrease = 30.0;      // degrees
constexpr unsigned kIterations = 10;  // as PyMeshLab's

void remesh(Mesh& mesh, double edge) {
  auto creases = mesh.add_property_map<Mesh::Edge_index, bool>("e:crease", false).first;
  processing::detect_sharp_edges(mesh, kCrease, creases);
  std::vector<Mesh::Edge_index> kept;  // and borders: those have to be short enough
  for (const Mesh::Edge_index e : mesh.edges())
    if (creases[e] || mesh.is_border(e)) kept.push_back(e);
  processing::split_long_edges(kept, edge, mesh,
                               CGAL::parameters::edge_is_constrained_map(creases));
  processing::isotropic_remeshing(mesh.faces(), edge, mesh,
                                  CGAL::parameters::number_of_iterations(kIterations)
                                      .edge_is_constrained_map(creases)
                                      .protect_constraints(false));
}

}  // namespace

int main(int count, char** arguments) {
  Mesh mesh;
  std::ifstream in(count == 4 ? arguments[1] : "");
  if (!(in >> mesh)) {
    std::cerr << "dapple_isotropic IN.off OUT.off EDGE\n";
    return 1;
  }
  remesh(mesh, std::strtod(arguments[3], nullptr));
  mesh.collect_garbage();
  std::ofstream out(arguments[2]);
  out.precision(17);
  out << mesh;
  return out ? 0 : 1;
}
