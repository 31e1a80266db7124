// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/remesh.hpp>
#include <span>
#include <vector>

#include "remesh/dual.hpp"
#include "remesh/site_editor.hpp"

namespace dapple {

/// The triangles of the mesh before, which stay where its vertices do. They were made wider after
/// they were the dual of the cells, so that the cells of the same vertices have another dual.
class KeptTriangles {
 public:
  KeptTriangles() = default;
  /// \param mesh of the surface before
  explicit KeptTriangles(const RemeshResult& mesh);

  /// Put them into the dual of sites, wherever all vertices around stay and both meshes fit
  /// together, and drop the violations there if the mesh before had none.
  void put_into(const RemeshSites& sites, Dual& dual) const;

 private:
  std::vector<Face> triangles_;
  std::vector<std::array<std::int32_t, 2>> lines_;
  bool flawless_ = true;
};

}  // namespace dapple
