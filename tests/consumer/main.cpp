// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <dapple/mesh_file.hpp>
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>
#include <dapple/tracker.hpp>
#include <fstream>
#include <iostream>

/// Puts 500 points on a mesh and keeps them even while it bends: MESH POINTS.obj
int main(int count, char** arguments) try {
  if (count != 3) return std::cerr << "usage: consumer MESH POINTS.obj\n", 2;
  const dapple::MeshArrays mesh = dapple::read_mesh(arguments[1]);
  const dapple::Surface surface(mesh.vertices, mesh.faces);

  const dapple::Samples samples = dapple::sample(surface, 500, {.seed = 7});
  std::cout << dapple::topology(surface).border_edges << " border edges, nearest pair at "
            << samples.report.evenness.alpha_min << " spacings\n";

  dapple::Tracker tracker(surface, samples);  // sample k stays sample k
  for (int frame = 1; frame <= 5; ++frame) {
    std::vector<dapple::Vec3> vertices = mesh.vertices;
    for (dapple::Vec3& x : vertices) x.z() += 0.05 * frame * std::sin(2.0 * x.x());
    const dapple::Samples& now = tracker.advance(vertices);
    std::cout << "frame " << frame << ": slid " << now.report.slide_max << " spacings at most\n";
  }
  std::ofstream points(arguments[2]);
  for (const dapple::Vec3& x : tracker.samples().positions) points << "v " << x.transpose() << '\n';
} catch (const std::exception& error) {  // names the input, the rule and the first offender
  return std::cerr << error.what() << '\n', 1;
}
