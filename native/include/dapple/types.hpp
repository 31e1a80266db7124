// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace dapple {

inline constexpr double kFinite = std::numeric_limits<double>::max();
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A point or vector in space, in the units of the mesh.
using Vec3 = Eigen::Vector3d;

/// A point or vector in the plane.
using Vec2 = Eigen::Vector2d;

/// Three vertex indices of a triangle.
using Face = std::array<std::int32_t, 3>;

/// Points on a surface: positions and the faces that contain them.
struct Sites {
  std::vector<Vec3> positions = {};
  std::vector<std::int32_t> faces = {};  ///< indices into the caller's faces
  std::vector<Vec3> barycentric =
      {};  ///< of the positions in their faces; may be empty where they are not needed

  [[nodiscard]] std::size_t size() const { return positions.size(); }
};

// The largest numbers accepted; larger ones are rejected before memory is allocated.

/// Samples: a torus has nine images of each, whose indices must fit into 32 bits.
inline constexpr std::size_t kMostSamples = 100'000'000;

/// Faces of a surface: each has three half-edges, with 32-bit indices.
inline constexpr std::size_t kMostSurfaceFaces = 715'827'882;

/// Faces after a refinement: indices of their corners and edges must fit into 32 bits.
inline constexpr std::size_t kMostRefinedFaces = 200'000'000;

/// Vertices of a surface and pixels of a picture, which have 32-bit indices.
inline constexpr std::size_t kMostVertices = 2'147'483'647;
inline constexpr std::size_t kMostPixels = 2'147'483'647;

/// Threads: more than any machine has.
inline constexpr int kMostThreads = 4096;

/// Values in rows and columns, row 0 at the bottom (y = 0); `values[row * columns + column]`.
struct Image {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
};

/// Texture coordinates (u, v) of the corners 0, 1, 2 of a face: (0, 0) is the outer corner of an
/// image's first pixel, (1, 1) that of its last.
using FaceUv = std::array<Vec2, 3>;

}  // namespace dapple
