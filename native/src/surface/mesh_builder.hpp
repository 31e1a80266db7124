// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <dapple/mesh_file.hpp>
#include <span>

namespace dapple {

/// The elements of a mesh that values of a file belong to.
enum class Owner { kNothing, kVertices, kCorners, kPolygons };

/// Values of one kind, and the indices by which polygon corners refer to them.
template <typename T>
struct Rows {
  Owner owner = Owner::kNothing;
  std::vector<T> values = {};
  std::vector<std::int64_t> at_corners = {};  ///< of kCorners: a value of each, or -1

  /// The value of a corner; none where the file has none.
  [[nodiscard]] const T* of(std::int64_t vertex, std::size_t corner, std::size_t polygon) const {
    std::int64_t row = -1;
    if (owner == Owner::kVertices) row = vertex;
    if (owner == Owner::kCorners && corner < at_corners.size()) row = at_corners[corner];
    if (owner == Owner::kPolygons) row = static_cast<std::int64_t>(polygon);
    const bool there = row >= 0 && static_cast<std::size_t>(row) < values.size();
    return there ? &values[static_cast<std::size_t>(row)] : nullptr;
  }
};

/// Of a color of three numbers: no opacity was given.
inline constexpr float kNoOpacity = -1.0f;

/// A component of a stored color; NaN and negative values become 0.
[[nodiscard]] inline float channel(double value) {
  return value > 0.0 ? static_cast<float>(std::min(value, 1e9)) : 0.0f;
}

/// Collects vertices and polygons as a file has them, and cuts the polygons into triangles.
class MeshBuilder {
 public:
  std::vector<Vec3> vertices = {};
  Rows<Vec2> uv = {};
  Rows<Vec3> normals = {};
  Rows<Color> colors = {};                     ///< up to 1, or up to 255 if one is larger
  std::vector<MeshAttribute> attributes = {};  ///< those of faces with a value for each polygon

  /// \param corners vertex indices from 0; checked by build()
  void add_polygon(std::span<const std::int64_t> corners);

  /// \throw ReadError naming the first polygon with a missing vertex
  [[nodiscard]] MeshArrays build();

 private:
  void check() const;
  void scale_colors();
  [[nodiscard]] std::size_t first_corner(std::size_t polygon) const {
    return polygon == 0 ? 0 : ends_[polygon - 1];
  }
  [[nodiscard]] std::vector<Vec3> places_of(std::size_t polygon) const;
  [[nodiscard]] std::vector<std::size_t> cut_like() const;
  void cut(std::size_t polygon, std::size_t like, MeshArrays& mesh) const;
  void add_triangle(std::size_t polygon, const std::array<std::size_t, 3>& corners,
                    MeshArrays& mesh) const;

  std::vector<std::int64_t> corners_;
  std::vector<std::size_t> ends_;
};

}  // namespace dapple
