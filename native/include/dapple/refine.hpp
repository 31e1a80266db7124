// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>
#include <functional>

namespace dapple {

/// A piece of a face that may be cut further.
struct Piece {
  std::int32_t parent;              ///< the face of the surface, the caller's index
  std::array<Vec3, 3> barycentric;  ///< of its corners in that face
  std::array<Vec3, 3> corners;      ///< in space
};

/// Which edges of a piece are to be halved; edge k runs from corner k to corner k + 1.
using EdgeMarks = std::array<bool, 3>;
using Criterion = std::function<EdgeMarks(const Piece&)>;

/// A surface cut into smaller faces, and the way back.
struct Refined {
  Surface original;
  Surface surface;  ///< the original's vertices, then those added; the same shape and density
  std::vector<std::int32_t> parents;              ///< per face: the face of the original it is of
  std::vector<std::array<Vec3, 3>> barycentric;   ///< per face: of its corners in its parent
  std::vector<std::array<std::int32_t, 2>> ends;  ///< per added vertex: it halves these two
  bool resolved = true;                           ///< false: the limit of faces was reached first

  /// Where the vertices of `surface` are once those of `original` are at `coarse`.
  /// \throw ArgumentError for another number of vertices
  [[nodiscard]] std::vector<Vec3> vertices(std::span<const Vec3> coarse) const;

  /// Both surfaces over moved vertices of the original.
  /// \throw SurfaceError, ArgumentError
  [[nodiscard]] Refined deformed(std::span<const Vec3> coarse) const;

  /// Two refinements as one: `finer` is of this one's surface.
  /// \throw ArgumentError if it is not
  [[nodiscard]] Refined then(const Refined& finer) const;
};

/// Cut faces until the criterion marks no edge any more, by longest-edge bisection (Rivara 1984):
/// with an edge of a face its longest is halved too, so that no angle becomes smaller than half the
/// smallest of the original face. Neighbors stay conforming at any edge, however many faces meet
/// there: where one side wants it halved, all sides are.
/// \param criterion  asked once for each piece with area, from several threads; must not depend on
///                   the order of the questions
/// \param max_faces  the round that would exceed it is left out, and `resolved` is false
/// \throw ArgumentError unless max_faces is in 1..200000000; Cancelled
[[nodiscard]] Refined refine(const Surface& surface, const Criterion& criterion,
                             std::size_t max_faces, Context* context = nullptr);

/// Cut faces, also those without area, until no edge of a piece is longer than its face allows;
/// neighbors are cut with it.
/// \param longest  > 0, infinite to leave a face as it is: one per face, or one for all
/// \throw ArgumentError naming the first that is not > 0; if the lengths differ; as refine()
[[nodiscard]] Refined refine_edges(const Surface& surface, std::span<const double> longest,
                                   std::size_t max_faces, Context* context = nullptr);

}  // namespace dapple
