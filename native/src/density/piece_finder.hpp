// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/refine.hpp>

namespace dapple {

/// Finds the piece of a face that contains a given point: each subdivided face has a grid over its
/// barycentric coordinates, whose cells list the pieces that overlap them.
class PieceFinder {
 public:
  /// \param refined must outlive the finder
  explicit PieceFinder(const Refined& refined);

  /// A face of `refined.surface`, and the point's weights in it.
  struct Found {
    std::int32_t face;
    Vec3 weights;
  };
  /// \param parent the face of `refined.original`.
  /// \param weights the point's in it
  [[nodiscard]] Found find(std::int32_t parent, const Vec3& weights) const;

 private:
  struct Grid {
    std::size_t first = 0;  // its cells' place among all
    std::int32_t side = 1;  // cells along each of the coordinates 1 and 2
  };
  [[nodiscard]] std::vector<Grid> grids() const;
  [[nodiscard]] Found find_below(std::int32_t parent, const Vec3& weights) const;
  [[nodiscard]] static std::int32_t along(const Grid& grid, double weight);
  template <typename Visit>
  void for_each_cell(std::size_t piece, const Visit& visit) const;

  const Refined& refined_;
  std::vector<Grid> grids_;           // per face of the original
  std::vector<std::size_t> starts_;   // per cell, one more: where its pieces begin
  std::vector<std::int32_t> pieces_;  // ascending in each cell
};

}  // namespace dapple
