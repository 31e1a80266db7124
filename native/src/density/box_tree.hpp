// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <dapple/types.hpp>
#include <span>
#include <vector>

namespace dapple {

/// The box around points, not empty.
[[nodiscard]] Eigen::AlignedBox3d box_around(std::span<const Vec3> points, double margin = 0.0);

/// Finds the boxes that meet a box: a binary tree of boxes, halved at their medians.
class BoxTree {
 public:
  explicit BoxTree(std::span<const Eigen::AlignedBox3d> boxes);

  /// Call visit(index) for all boxes that meet a box.
  template <typename Visit>
  void meeting(const Eigen::AlignedBox3d& box, const Visit& visit) const {
    if (!nodes_.empty()) descend(0, box, visit);
  }

 private:
  static constexpr std::size_t kLeaf = 4;  // most boxes of a node without children

  struct Node {
    Eigen::AlignedBox3d box;
    std::size_t begin, end;  // in order_
    std::size_t second;      // child; the first one follows its parent; 0: none
  };

  template <typename Visit>
  void descend(std::size_t at, const Eigen::AlignedBox3d& box, const Visit& visit) const {
    const Node& node = nodes_[at];
    if (!node.box.intersects(box)) return;
    if (node.second) {
      descend(at + 1, box, visit);
      return descend(node.second, box, visit);
    }
    for (std::size_t k = node.begin; k < node.end; ++k)
      if (boxes_[order_[k]].intersects(box)) visit(order_[k]);
  }

  void build(std::size_t begin, std::size_t end);

  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace dapple
