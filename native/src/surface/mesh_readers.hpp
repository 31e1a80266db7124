// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/mesh_file.hpp>
#include <string_view>

#include "surface/mesh_text.hpp"

namespace dapple {

// Each reads arbitrary bytes as one format: numbers and indices are checked before they are used,
// and counts before memory is allocated.
// \throw ReadError

/// OFF in text, also with colors, normals or texture coordinates.
[[nodiscard]] MeshArrays read_off(std::string_view bytes);

/// The v, vt, vn and f lines of OBJ; a color may follow the place of a vertex.
[[nodiscard]] MeshArrays read_obj(std::string_view bytes);

/// PLY (Turk 1994) in text or binary, of polygons or strips of triangles, with any properties
/// besides x, y, z and vertex_indices.
[[nodiscard]] MeshArrays read_ply(std::string_view bytes);

/// All numbers of the vertices of a PLY file by name, which need no faces.
[[nodiscard]] std::vector<MeshAttribute> read_ply_columns(std::string_view bytes);

/// STL in text or binary; corners at the same place become one vertex.
[[nodiscard]] MeshArrays read_stl(std::string_view bytes);

}  // namespace dapple
