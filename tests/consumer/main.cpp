// SPDX-License-Identifier: GPL-3.0-or-later
// Uses the installed library through every part that brings a dependency of its own.
#include <dapple/sampler.hpp>
#include <dapple/topology.hpp>
#include <iostream>

int main() {
  const std::vector<dapple::Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<dapple::Face> faces = {{0, 1, 2}, {0, 2, 3}};
  const dapple::Surface surface(vertices, faces);
  const dapple::Samples samples = dapple::sample(surface, 20);
  std::cout << samples.size() << ' ' << dapple::topology(surface).border_edges << '\n';
  return samples.size() == 20 && dapple::topology(surface).border_edges == 4 ? 0 : 1;
}
