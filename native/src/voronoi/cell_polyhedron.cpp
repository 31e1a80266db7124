// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/cell_polyhedron.hpp"

#include <algorithm>

namespace dapple {
namespace {

constexpr double kSlack = 1e-12;  // of the box's diagonal: well above rounding, below what counts

}  // namespace

void CellPolyhedron::start(const Eigen::AlignedBox3d& box) {
  vertices_.clear();
  planes_ = 6;
  slack_ = kSlack * (box.diagonal().norm() + box.center().norm());
  const Eigen::AlignedBox3d around(box.min().array() - slack_, box.max().array() + slack_);
  for (std::int32_t k = 0; k < 8; ++k) {
    const std::int32_t x = k & 1, y = k >> 1 & 1, z = k >> 2;
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(k);
    vertices_.push_back({around.corner(corner), {x, 2 + y, 4 + z}, false, 0.0});
  }
}

bool CellPolyhedron::is_cut_by(const Vec3& normal, double offset) const {
  const double limit = offset + 2.0 * slack_ * normal.norm();
  return std::any_of(vertices_.begin(), vertices_.end(),
                     [&](const Vertex& v) { return v.x.dot(normal) > limit; });
}

bool CellPolyhedron::touches(const Vec3& normal, double offset) const {
  const double limit = offset - slack_ * normal.norm();
  return std::any_of(vertices_.begin(), vertices_.end(),
                     [&](const Vertex& v) { return v.x.dot(normal) > limit; });
}

bool CellPolyhedron::cut(const Vec3& normal, double offset) {
  const double limit = offset + slack_ * normal.norm();
  for (Vertex& v : vertices_) v.side = v.x.dot(normal) - limit;
  const auto outside = std::partition(vertices_.begin(), vertices_.end(),
                                      [](const Vertex& v) { return v.side <= 0.0; });
  fresh_.clear();
  for (auto a = outside; a != vertices_.end(); ++a)
    for (auto b = vertices_.begin(); b != outside; ++b) cross(*a, *b);
  ++planes_;
  if (!closes_up()) return false;
  vertices_.erase(outside, vertices_.end());
  vertices_.insert(vertices_.end(), fresh_.begin(), fresh_.end());
  return !vertices_.empty();
}

std::optional<Vec3> CellPolyhedron::next_vertex() {
  for (Vertex& v : vertices_) {
    if (v.given_out) continue;
    v.given_out = true;
    return v.x;
  }
  return std::nullopt;
}

/// Add the vertex where the new plane crosses the edge between two vertices, if there is one.
void CellPolyhedron::cross(const Vertex& outside, const Vertex& inside) {
  std::array<std::int32_t, 3> planes{};
  std::size_t shared = 0;
  for (const std::int32_t plane : outside.planes)
    if (std::find(inside.planes.begin(), inside.planes.end(), plane) != inside.planes.end())
      planes[shared++] = plane;
  if (shared != 2) return;
  planes[2] = planes_;
  const double t = outside.side / (outside.side - inside.side);
  fresh_.push_back({outside.x + t * (inside.x - outside.x), planes, false, 0.0});
}

// The new face is a polygon: each old face that meets it has two of its vertices.
bool CellPolyhedron::closes_up() const {
  for (const Vertex& v : fresh_)
    for (int k = 0; k < 2; ++k) {
      const std::int32_t plane = v.planes[static_cast<std::size_t>(k)];
      const auto on = [plane](const Vertex& other) {
        return other.planes[0] == plane || other.planes[1] == plane;
      };
      if (std::count_if(fresh_.begin(), fresh_.end(), on) != 2) return false;
    }
  return true;
}

}  // namespace dapple
