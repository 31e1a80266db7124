// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "remesh/cell_pieces.hpp"
#include "remesh/violations.hpp"

namespace dapple {

/// A part of a cell's border, along one neighbor or along a line.
struct Side {
  static constexpr std::int32_t kLine = -1;
  static constexpr std::int32_t kUnknown = -2;

  std::int32_t site;
  std::int32_t neighbor;  ///< or kLine, kUnknown
  double length = 0.0;
  std::int32_t longest = -1;             ///< its longest edge, of CellPieces
  std::int32_t nearest = -1;             ///< the one whose middle is nearest to the site
  std::int32_t first = -1, last = -1;    ///< its edges at both ends
  std::int32_t before = -1, after = -1;  ///< sides around the border
  std::int32_t twin = -1;                ///< the neighbor's side at the same place
  bool dropped = false;                  ///< too short to count
};

/// The sides of one cell and how it is no disc.
struct CellSides {
  std::vector<Side> sides;  ///< linked by indices in here
  std::vector<Violation> violations;
};

/// Walks around the sheets of cells; one object per thread.
class CellWalk {
 public:
  /// The arguments must outlive it.
  CellWalk(const Surface& surface, const FeatureLines& lines, const CellPieces& pieces,
           const Sites& sites, std::span<const SiteKind> kinds)
      : surface_(surface), lines_(lines), pieces_(pieces), sites_(sites), kinds_(kinds) {}

  [[nodiscard]] CellSides sides_of(std::size_t site);

 private:
  struct Sheet {
    std::int32_t root = -1;
    std::int32_t euler = 0;
    std::int32_t loops = 0;
    std::int32_t own_lines = 0, neighbors = 0;
    bool foreign = false;
  };

  void pair_edges();
  void count_sheets();
  [[nodiscard]] Sheet& sheet_of(std::int32_t edge);
  [[nodiscard]] std::int32_t next_on_border(std::int32_t edge) const;
  [[nodiscard]] std::int32_t beyond(std::int32_t edge) const;
  void walk(std::int32_t start, CellSides& result);
  void add_sides(std::span<const std::int32_t> loop, CellSides& result);
  void look_at_line(const Side& side, std::span<const std::int32_t> loop, Sheet& sheet,
                    CellSides& result);
  void judge(CellSides& result);
  [[nodiscard]] Place place_on(std::int32_t edge, double share) const;
  [[nodiscard]] bool is_in(std::int32_t edge, const Sheet& sheet) const;
  [[nodiscard]] bool holds_site(const Sheet& sheet) const;
  [[nodiscard]] Place middle(const Sheet& sheet) const;
  [[nodiscard]] Place farthest(const Sheet& sheet) const;
  [[nodiscard]] std::int32_t& mate(std::int32_t edge) { return mates_[local(edge)]; }
  [[nodiscard]] std::int32_t mate(std::int32_t edge) const { return mates_[local(edge)]; }
  [[nodiscard]] std::size_t local(std::int32_t edge) const { return as_index(edge - begin_); }

  const Surface& surface_;
  const FeatureLines& lines_;
  const CellPieces& pieces_;
  const Sites& sites_;
  std::span<const SiteKind> kinds_;

  std::int32_t site_ = 0;
  std::int32_t begin_ = 0, end_ = 0;  // edges of the cell
  std::vector<std::int32_t> mates_;   // per edge: the same edge of the neighboring piece, or -1
  std::vector<std::array<std::int32_t, 2>> on_edges_;  // edge of the mesh, edge
  std::vector<bool> walked_;
  std::vector<Sheet> sheets_;
  std::vector<std::int32_t> sheet_numbers_;  // per edge
};

}  // namespace dapple
