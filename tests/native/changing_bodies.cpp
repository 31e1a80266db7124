// SPDX-License-Identifier: GPL-3.0-or-later
#include "changing_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace dapple::test {
namespace {

/// Appends the triangles of one tetrahedron after another to a shape.
class Marching {
 public:
  Marching(const std::function<double(const Vec3&)>& field, int cells)
      : cells_(cells), shape_{"Isosurface", {}, {}} {
    for (int k = 0; k < (cells + 1) * (cells + 1) * (cells + 1); ++k)
      values_.push_back(field(place(k)));
  }

  Shape run() {
    for (int z = 0; z < cells_; ++z)
      for (int y = 0; y < cells_; ++y)
        for (int x = 0; x < cells_; ++x) march_cube(corner(x, y, z));
    return std::move(shape_);
  }

 private:
  using Four = std::array<int, 4>;

  [[nodiscard]] int corner(int x, int y, int z) const {
    return (z * (cells_ + 1) + y) * (cells_ + 1) + x;
  }

  [[nodiscard]] Vec3 place(int k) const {
    const int x = k % (cells_ + 1), y = k / (cells_ + 1) % (cells_ + 1);
    const int z = k / (cells_ + 1) / (cells_ + 1);
    return Vec3(x, y, z) * (2.0 / cells_) - Vec3::Ones();
  }

  /// Six tetrahedra around a diagonal (Kuhn's division).
  void march_cube(int first) {
    std::array<int, 3> ways = {corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1)};
    std::sort(ways.begin(), ways.end());
    do
      march(
          {first, first + ways[0], first + ways[0] + ways[1], first + ways[0] + ways[1] + ways[2]});
    while (std::next_permutation(ways.begin(), ways.end()));
  }

  void march(const Four& corners) {
    std::vector<int> in, out;
    for (const int k : corners)
      (values_[static_cast<std::size_t>(k)] < 0.0 ? in : out).push_back(k);
    if (in.empty() || out.empty()) return;
    const Vec3 outward = mean(out) - mean(in);
    if (in.size() == 2) {
      add(cut(in[0], out[0]), cut(in[0], out[1]), cut(in[1], out[1]), outward);
      add(cut(in[0], out[0]), cut(in[1], out[1]), cut(in[1], out[0]), outward);
      return;
    }
    const bool one_in = in.size() == 1;
    const int alone = one_in ? in[0] : out[0];
    const std::vector<int>& others = one_in ? out : in;
    add(cut(alone, others[0]), cut(alone, others[1]), cut(alone, others[2]), outward);
  }

  [[nodiscard]] Vec3 mean(const std::vector<int>& corners) const {
    Vec3 sum = Vec3::Zero();
    for (const int k : corners) sum += place(k);
    return sum / static_cast<double>(corners.size());
  }

  std::int32_t cut(int a, int b) {
    if (a > b) std::swap(a, b);
    const auto [found, fresh] =
        cuts_.emplace(std::pair(a, b), static_cast<std::int32_t>(shape_.vertices.size()));
    if (fresh) {
      const double from = values_[static_cast<std::size_t>(a)];
      const double share = from / (from - values_[static_cast<std::size_t>(b)]);
      shape_.vertices.emplace_back((1.0 - share) * place(a) + share * place(b));
    }
    return found->second;
  }

  void add(std::int32_t a, std::int32_t b, std::int32_t c, const Vec3& outward) {
    const auto at = [this](std::int32_t v) { return shape_.vertices[static_cast<std::size_t>(v)]; };
    if ((at(b) - at(a)).cross(at(c) - at(a)).dot(outward) < 0.0) std::swap(b, c);
    shape_.faces.push_back({a, b, c});
  }

  int cells_;
  std::vector<double> values_;
  std::map<std::pair<int, int>, std::int32_t> cuts_;
  Shape shape_;
};

/// The same shape with its faces in another order.
Shape reordered(Shape shape, std::ptrdiff_t by) {
  std::rotate(shape.faces.begin(), shape.faces.begin() + by, shape.faces.end());
  return shape;
}

}  // namespace

Shape isosurface(const std::function<double(const Vec3&)>& field, int cells) {
  return Marching(field, cells).run();
}

Shape metaballs(int frame, int cells) {
  const double apart = 0.38 + 0.14 * std::cos(2.0 * std::numbers::pi * frame / 24);
  const auto field = [apart](const Vec3& p) {
    const double left = (p - Vec3(-apart, 0.01, 0.02)).norm() - 0.4;
    const double right = (p - Vec3(apart, -0.02, 0.01)).norm() - 0.4;
    return -0.04 * std::log(std::exp(-left / 0.04) + std::exp(-right / 0.04));
  };
  return isosurface(field, cells);
}

Shape remeshed(int frame) {
  const auto bumpy = [frame](const Vec3& p) {
    const Vec3 q = rotated(p, 0.7 * frame);
    const double bump = 1.0 + 0.1 * std::sin(4.0 * q.x()) * std::cos(3.0 * q.y());
    return Vec3(bump * q.cwiseProduct(Vec3(1.0, 0.7, 1.3)));
  };
  return mapped(reordered(icosphere(frame % 2 == 0 ? 4 : 5), frame), bumpy);
}

Shape torn_cloth(int frame, int cells) {
  Shape shape = grid(cells);
  const double tip = 1.0 - static_cast<double>(std::max(0, frame - 3)) / cells;
  const std::size_t untorn = shape.vertices.size();
  // vertices of the tear, and their copies on its right side
  std::map<std::int32_t, std::int32_t> split;
  for (std::size_t v = 0; v < untorn; ++v)
    if (shape.vertices[v].x() == 0.5 && shape.vertices[v].y() > tip + 1e-9) {
      split[static_cast<std::int32_t>(v)] = static_cast<std::int32_t>(shape.vertices.size());
      shape.vertices.push_back(shape.vertices[v]);
    }
  std::vector<bool> is_right(shape.vertices.size(), false);
  for (std::size_t v = 0; v < is_right.size(); ++v)
    is_right[v] = v >= untorn || shape.vertices[v].x() > 0.5;
  for (Face& face : shape.faces) {
    const bool right = std::any_of(face.begin(), face.end(), [&](std::int32_t v) {
      return is_right[static_cast<std::size_t>(v)];
    });
    for (std::int32_t& v : face)
      if (right && split.contains(v)) v = split[v];
  }
  for (std::size_t v = 0; v < shape.vertices.size(); ++v) {
    Vec3& p = shape.vertices[v];
    const double open = 0.3 * std::max(0.0, p.y() - tip) * (is_right[v] ? 1.0 : -1.0);
    const double wave = 0.05 * std::sin(6.0 * p.x() + 0.3 * frame) * p.y();
    p += Vec3(p.x() == 0.5 && p.y() <= tip + 1e-9 ? 0.0 : 0.5 * open, 0.0, wave);
  }
  return shape;
}

}  // namespace dapple::test
