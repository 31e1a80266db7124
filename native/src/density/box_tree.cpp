// SPDX-License-Identifier: GPL-3.0-or-later
#include "density/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/progress.hpp"

namespace dapple {

Eigen::AlignedBox3d box_around(std::span<const Vec3> points, double margin) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  box.min().array() -= margin;
  box.max().array() += margin;
  return box;
}

BoxTree::BoxTree(std::span<const Eigen::AlignedBox3d> boxes)
    : boxes_(boxes.begin(), boxes.end()), order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (!boxes_.empty()) build(0, boxes_.size());
}

void BoxTree::build(std::size_t begin, std::size_t end) {
  Eigen::AlignedBox3d whole = boxes_[order_[begin]];
  for (std::size_t k = begin; k < end; ++k) whole.extend(boxes_[order_[k]]);
  const std::size_t own = nodes_.size();
  check_at(own);
  nodes_.push_back({whole, begin, end, 0});
  if (end - begin <= kLeaf) return;
  int axis = 0;
  whole.sizes().maxCoeff(&axis);
  const auto key = [&](std::size_t k) {
    return std::pair(boxes_[k].min()[axis] + boxes_[k].max()[axis], k);
  };
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::size_t one, std::size_t other) { return key(one) < key(other); });
  build(begin, middle);
  nodes_[own].second = nodes_.size();
  build(middle, end);
}

}  // namespace dapple
