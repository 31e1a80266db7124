// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <dapple/mesh_file.hpp>
#include <filesystem>

#include "shapes.hpp"

namespace dapple::test {

/// The folder of real meshes: DAPPLE_DATA in the environment, or shared/data beside the source
/// tree.
[[nodiscard]] std::filesystem::path shared_data();

/// A real mesh; call DAPPLE_NEEDS_MESH first.
[[nodiscard]] Shape shared_mesh(const std::string& name);

[[nodiscard]] bool has_shared_mesh(const std::string& name);

/// The names of the real meshes, whether they exist or not.
[[nodiscard]] const std::vector<std::string>& shared_mesh_names();

}  // namespace dapple::test

#define DAPPLE_NEEDS_MESH(name)                               \
  if (!dapple::test::has_shared_mesh(name))                   \
  GTEST_SKIP() << "The real mesh " << (name) << " is not in " \
               << dapple::test::shared_data() / "meshes"      \
               << "; set DAPPLE_DATA to the folder that holds meshes/."
