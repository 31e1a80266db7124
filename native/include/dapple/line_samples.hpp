// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <dapple/context.hpp>
#include <dapple/samples.hpp>
#include <dapple/surface.hpp>
#include <vector>

namespace dapple {

/// How samples follow each other along a line.
enum class LineSpacing {
  kEven,     ///< at equal distances
  kNatural,  ///< at distances from a half to one and a half of that
};

struct LineOptions {
  /// Random seed. Quality does not depend on it.
  std::uint64_t seed = 0;  // basic, >= 0
  /// Edges whose faces' normals differ by more than this are creases, which stay, and so do their
  /// corners; 180 keeps none.
  double feature_angle = 30.0;  // basic, 0..180, degrees
  /// Samples follow each other at equal distances, or at distances from a half to one and a half of
  /// that.
  LineSpacing line_spacing = LineSpacing::kEven;  // expert
  /// Whether borders are lines, and edges with three or more faces.
  bool borders = true;  // expert
  /// Whether there is a sample at each corner: where lines end, meet or turn by more than 45
  /// degrees. Otherwise lines begin and end with half a distance.
  bool corners = false;  // expert
  /// Edges that are lines besides creases and borders, each by the indices of its two vertices: a
  /// polyline is its edges.
  std::vector<std::array<std::int32_t, 2>> edges = {};
};

/// \throw ArgumentError naming the first option out of its range
void check_options(const LineOptions& options);

/// Samples along the lines of a surface.
struct LineSamples {
  /// Corners first, then line after line, along each. Normals are the mean of the faces' there; the
  /// report has the number, the mean distance along lines and the times.
  Samples samples;
  std::vector<Vec3> tangents;       ///< per sample: unit, along its line
  std::vector<std::int32_t> lines;  ///< per sample: the index of its line; -1 at corners
  std::vector<double> lengths;      ///< per line, without density
};

/// Put exactly `count` samples on creases, borders and marked edges, with a number for each length
/// in proportion to the surface's density.
///
/// Lines go from corner to corner. Each gets samples in proportion to the integral of the density
/// along it (method of Sainte-Lague), and has them at equal shares of that integral. Creases that
/// are noise of a scan are left out as by remesh(); on meshes of fewer than 200 faces all count.
/// \throw ArgumentError for options out of range, a count of 0 or fewer than the corners that are
///        asked for, a surface without lines, a density of 0 along all of them, or naming the first
///        of `edges` that is no edge; Cancelled
[[nodiscard]] LineSamples sample_lines(const Surface& surface, std::size_t count,
                                       const LineOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
