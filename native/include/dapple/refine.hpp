// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <functional>

namespace dapple {

/// A part of a face that may be subdivided further.
struct Piece {
  std::int32_t parent;              ///< the face of the surface, the caller's index
  std::array<Vec3, 3> barycentric;  ///< of its corners in that face
  std::array<Vec3, 3> corners;      ///< in space
};

/// Which edges of a piece to halve; edge k runs from corner k to corner k + 1.
using EdgeMarks = std::array<bool, 3>;
using Criterion = std::function<EdgeMarks(const Piece&)>;

/// A surface subdivided into smaller faces, and the map back to the original.
struct Refined {
  Surface original;
  Surface surface;  ///< the original's vertices, then the added ones; the same shape and density
  std::vector<std::int32_t> parents;             ///< per face: its face of the original
  std::vector<std::array<Vec3, 3>> barycentric;  ///< per face: of its corners in its parent
  std::vector<std::array<std::int32_t, 2>>
      ends;                    ///< per added vertex: the two vertices before it that it is between
  std::vector<double> shares;  ///< per added vertex: how far from the first to the second, 0..1
  bool resolved = true;        ///< false if the limit of faces was reached first
  /// Distance by which to_original() moves samples inward that lie at the border of the density, in
  /// the surface's unit.
  double inset = 0.0;

  /// The vertices of `surface` when those of `original` are at `coarse`.
  /// \throw ArgumentError for a different number of vertices
  [[nodiscard]] std::vector<Vec3> vertices(std::span<const Vec3> coarse) const;

  /// Both surfaces over moved vertices of the original.
  /// \throw SurfaceError, ArgumentError
  [[nodiscard]] Refined deformed(std::span<const Vec3> coarse) const;

  /// Two refinements as one: `finer` is of this one's surface.
  /// \throw ArgumentError if it is not
  [[nodiscard]] Refined then(const Refined& finer) const;
};

/// Subdivide faces until the criterion marks no edge, by longest-edge bisection (Rivara 1984):
/// whenever an edge of a face is halved, its longest edge is halved too, so that no angle becomes
/// smaller than half the smallest of the original face. The mesh stays conforming at every edge,
/// however many faces meet there.
/// \param criterion  called once for each piece with area, from several threads; must not depend on
///                   the order of the calls
/// \param max_faces  the round that would exceed it is skipped, and `resolved` is false
/// \throw ArgumentError unless max_faces is in 1..200000000; Cancelled
[[nodiscard]] Refined refine(const Surface& surface, const Criterion& criterion,
                             std::size_t max_faces, Context* context = nullptr);

/// Subdivide faces, also those without area, until no edge of a piece is longer than its face
/// allows; the mesh stays conforming.
/// \param longest  > 0, or infinite to leave a face as it is: one per face, or one for all
/// \throw ArgumentError naming the first that is not > 0; if the lengths differ; as refine()
[[nodiscard]] Refined refine_edges(const Surface& surface, std::span<const double> longest,
                                   std::size_t max_faces, Context* context = nullptr);

}  // namespace dapple
