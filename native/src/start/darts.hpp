// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <dapple/surface.hpp>
#include <map>

#include "base/random.hpp"
#include "surface/ordered_face.hpp"

namespace dapple {

/// A point thrown at a surface.
struct Dart {
  Vec3 position;
  Vec3 barycentric;
  Vec3 normal;
  OrderedFace face;
  std::int32_t component;
  double density;  ///< there
};

/// Whether two darts are not on the two sides of a wall.
template <typename A, typename B>
[[nodiscard]] bool on_one_side(const A& a, const B& b) {
  return a.normal.dot(b.normal) > -0.5;
}

/// Whether straight distance stands for distance along the surface: not between components, nor
/// between the two sides of a wall.
template <typename A, typename B>
[[nodiscard]] bool see_each_other(const A& a, const B& b) {
  return a.component == b.component && on_one_side(a, b);
}

/// The dart that would have hit a site of the surface.
[[nodiscard]] Dart dart_at(const Surface& surface, OrderedFace face, const Vec3& weights);

/// Draws points of a surface with its density, while their component has places left.
class DartBoard {
 public:
  /// Each component gets its share of `count` places by mass, by largest remainders.
  /// \param taken darts that are there already, `count` includes them
  DartBoard(const Surface& surface, std::size_t count, const std::vector<Dart>& taken = {});

  /// A point of the surface, before it is looked up.
  struct Draw {
    OrderedFace face;
    Vec3 weights;
  };
  /// \pre a place is left
  [[nodiscard]] Draw draw(Random& random) const;
  /// One place of the dart's component is taken. True if it was the last one: what was drawn
  /// meanwhile counts no more.
  bool take(const Dart& dart);

 private:
  [[nodiscard]] std::size_t component(OrderedFace face) const;
  void sum_up();
  [[nodiscard]] std::size_t face_at(double mass) const;
  [[nodiscard]] Draw draw_on(OrderedFace face, Random& random) const;

  const Surface* surface_;
  std::vector<double> masses_;        // per component
  std::vector<std::size_t> places_;   // left per component
  std::vector<double> cumulative_;    // mass of the faces so far, without full components
  double closed_ = 0.0;               // mass of components that have become full since
  std::vector<std::uint32_t> guide_;  // per equal part of the mass: the face it begins in
};

/// Darts in a hashed grid over space, or around the torus [0, period)^2.
class DartGrid {
 public:
  /// What others keep away from: a line of memory.
  struct Member {
    Vec3 position;
    Vec3 normal;
    double radius;
    std::int32_t component;
    std::uint32_t next;  // in the same bucket
  };

  /// \param cell   not smaller than any distance asked for
  /// \param period 0 for space without end
  DartGrid(double cell, double period);

  void insert(const Dart& dart, double radius);

  /// Whether a member lies nearer to the dart than `reach(member)`, which is at most `most`.
  template <typename Reach>
  [[nodiscard]] bool refuses(const Dart& dart, double most, const Reach& reach) const {
    const Block block = around(dart.position, most);
    // Its own cell is the one that most likely refuses it.
    if (refuses_in(bucket(block.center), dart, reach)) return true;
    for (std::int64_t x = block.low[0]; x <= block.high[0]; ++x)
      for (std::int64_t y = block.low[1]; y <= block.high[1]; ++y)
        for (std::int64_t z = block.low[2]; z <= block.high[2]; ++z)
          if (Address{x, y, z} != block.center && refuses_in(bucket({x, y, z}), dart, reach))
            return true;
    return false;
  }

 private:
  using Address = std::array<std::int64_t, 3>;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  /// The cells that a ball touches: one or two along each axis, three where rounding may hide it.
  struct Block {
    Address center, low, high;
  };

  // Cells may share a bucket: that costs distance tests, never an answer.
  template <typename Reach>
  bool refuses_in(std::size_t bucket, const Dart& dart, const Reach& reach) const {
    for (std::uint32_t m = heads_[bucket]; m != kNone; m = members_[m].next) {
      const double distance = reach(members_[m]);
      if (offset(members_[m].position, dart.position).squaredNorm() < distance * distance)
        return true;
    }
    return false;
  }

  [[nodiscard]] bool flat() const { return period_ > 0.0; }
  [[nodiscard]] Vec3 offset(const Vec3& from, const Vec3& to) const {
    Vec3 d = to - from;
    if (flat())
      for (Eigen::Index k = 0; k < 2; ++k) d[k] -= period_ * std::round(d[k] / period_);
    return d;
  }
  [[nodiscard]] Block around(const Vec3& p, double most) const;
  [[nodiscard]] Address address(const Vec3& p) const;
  [[nodiscard]] std::size_t bucket(Address a) const;
  void link(std::uint32_t member);
  void grow();

  double cell_;
  double period_;
  std::int64_t side_;                 // cells around the torus
  std::vector<std::uint32_t> heads_;  // per bucket; a power of two
  std::vector<Member> members_;
};

/// Darts that keep apart from each other: two of radius r and s by min(r, s). They are kept by
/// octaves of their radius, so that a steep density stays quick.
class DartSet {
 public:
  /// \param period as for DartGrid
  explicit DartSet(double period) : period_(period) {}

  /// Whether another that it sees lies too near.
  [[nodiscard]] bool refuses(const Dart& dart, double radius) const;
  void insert(const Dart& dart, double radius);
  /// Scale all radii.
  void scale(double factor);

 private:
  struct Entry {
    Dart dart;
    double radius;
  };
  void place(const Entry& entry);

  double period_;
  std::vector<Entry> entries_;
  std::map<int, DartGrid> grids_;
};

}  // namespace dapple
