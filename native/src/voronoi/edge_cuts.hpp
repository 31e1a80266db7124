// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <limits>

#include "surface/face_edges.hpp"
#include "voronoi/near_lists.hpp"

namespace dapple {

/// The site nearest to a vertex. Of a vertex without any site to compete for it: -1.
struct VertexLabel {
  std::int32_t site = -1;
  float squared_distance = 0.0F;
};

/// The points where the edges of a chunk of faces pass from one cell to the next. Cells are convex
/// in space: an edge whose ends have one label lies in one cell.
class EdgeCuts {
 public:
  /// A point between two cells, on the way from an edge's lower vertex to the other one.
  struct Link {
    Triple x;
    std::int32_t beyond;  ///< the site of the cell behind it
  };

  /// The cuts of an edge in order; none if its ends have one label.
  [[nodiscard]] std::span<const Link> of(std::size_t edge) const {
    const std::uint16_t number = numbers_[edge];
    if (number == kNone) return {};
    const Cut& cut = cuts_[number];
    return {cut.more == 0 ? &cut.first : more_.data() + cut.at, 1 + std::size_t{cut.more}};
  }
  /// The only cut of an edge; null if there is none, or more than one.
  [[nodiscard]] const Link* single(std::size_t edge) const {
    const std::uint16_t number = numbers_[edge];
    return number != kNone && cuts_[number].more == 0 ? &cuts_[number].first : nullptr;
  }

 private:
  friend class EdgeCutter;
  static constexpr std::uint16_t kNone = std::numeric_limits<std::uint16_t>::max();
  struct Cut {
    Link first;
    std::uint32_t at, more;
  };

  std::vector<std::uint16_t> numbers_;  // per edge, of its cut
  std::vector<Cut> cuts_;
  std::vector<Link> more_;  // of edges with several cuts, all of them
};

/// Finds cuts; one object per thread.
class EdgeCutter {
 public:
  /// The arguments must outlive this.
  /// \param vertices where the vertices are
  EdgeCutter(std::span<const Vec3> vertices, const NearLists& lists)
      : vertices_(vertices), lists_(&lists) {}

  /// Find the cuts of a chunk of edges.
  /// \param counts  per edge whether it counts; the others have no cut. Empty: all count
  /// \param descends receives 1 per vertex that is the farther end from the site of both ends of an
  ///                 edge; other threads may write to it too. Its last entry belongs to no vertex.
  void find(std::span<const FaceEdges::Ends> edges, std::span<const char> counts,
            std::span<const VertexLabel> labels, double squared_spacing,
            std::span<std::atomic<char>> descends, EdgeCuts& result);

 private:
  static constexpr std::size_t kStaged = 64;
  using Numbers = std::array<double, kStaged>;
  /// Edges side by side, so that several are computed at once.
  struct alignas(64) Staged {
    Numbers ax, ay, az, rx, ry, rz, lx, ly, lz, dx, dy, dz, squared, px, py, pz;
    std::array<std::int32_t, kStaged> i, j;
  };

  void stage(std::span<const std::uint16_t> cut, std::span<const FaceEdges::Ends> edges,
             std::span<const VertexLabel> labels);
  void cut_staged(std::size_t count);
  void store(std::size_t k, const FaceEdges::Ends& ends, double squared_spacing, EdgeCuts& result);
  [[nodiscard]] bool is_single(std::size_t k, double squared_spacing) const;
  void follow(const Triple& a, const Triple& b, std::int32_t i, std::int32_t j);

  std::span<const Vec3> vertices_;
  const NearLists* lists_;
  Staged staged_;
  std::vector<std::uint16_t> cut_;     // edges whose ends have two labels
  std::vector<EdgeCuts::Link> links_;  // of one edge
};

}  // namespace dapple
