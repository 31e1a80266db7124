// SPDX-License-Identifier: GPL-3.0-or-later
#include "shared_data.hpp"

#include <cstdlib>

namespace dapple::test {

std::filesystem::path shared_data() {
  const char* given = std::getenv("DAPPLE_DATA");
  if (given != nullptr && *given != '\0') return given;
  return std::filesystem::path(DAPPLE_SOURCE_DIR).parent_path() / "shared" / "data";
}

Shape shared_mesh(const std::string& name) {
  MeshArrays mesh = read_mesh(shared_data() / "meshes" / (name + ".ply"));
  return {name, std::move(mesh.vertices), std::move(mesh.faces)};
}

bool has_shared_mesh(const std::string& name) {
  return std::filesystem::exists(shared_data() / "meshes" / (name + ".ply"));
}

const std::vector<std::string>& shared_mesh_names() {
  static const std::vector<std::string> names = {"bunny",     "fandisk", "crank", "face",
                                                 "camelhead", "lilium",  "truck"};
  return names;
}

}  // namespace dapple::test
