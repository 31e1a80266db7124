// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

  /// Whether the other is on the same side of a wall.
  [[nodiscard]] bool faces(const Dart& other) const { return normal.dot(other.normal) > -0.5; }
  /// Whether straight distance stands for distance along the surface: not between components, nor
  /// between the two sides of a wall.
  [[nodiscard]] bool sees(const Dart& other) const {
    return component == other.component && faces(other);
  }
};

/// The dart that would have hit a site of the surface.
[[nodiscard]] Dart dart_at(const Surface& surface, OrderedFace face, const Vec3& weights);

/// Draws points of a surface with its density, while their component has places left.
class DartBoard {
 public:
  /// Each component gets its share of `count` places by mass, by largest remainders.
  /// \param taken darts that are there already, `count` includes them
  DartBoard(const Surface& surface, std::size_t count, const std::vector<Dart>& taken = {});

  /// \pre a place is left
  [[nodiscard]] Dart draw(Random& random) const;
  /// One place of the dart's component is taken.
  void take(const Dart& dart);

 private:
  [[nodiscard]] std::size_t component(OrderedFace face) const;
  void sum_up();
  [[nodiscard]] Dart draw_on(OrderedFace face, Random& random) const;

  const Surface* surface_;
  std::vector<double> masses_;       // per component
  std::vector<std::size_t> places_;  // left per component
  std::vector<double> cumulative_;   // mass of the faces so far, without full components
  double closed_ = 0.0;              // mass of components that have become full since
};

/// Darts in a hashed grid over space, or around the torus [0, period)^2.
class DartGrid {
 public:
  /// \param cell   not smaller than any distance asked for
  /// \param period 0 for space without end
  DartGrid(double cell, double period);

  void insert(const Dart& dart, double radius);

  /// Whether a member lies nearer to the dart than `reach(member, its radius)`.
  template <typename Reach>
  [[nodiscard]] bool refuses(const Dart& dart, const Reach& reach) const {
    const Address center = address(dart.position);
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dz = flat() ? 0 : -1; dz <= (flat() ? 0 : 1); ++dz)
          if (refuses_in(bucket({center[0] + dx, center[1] + dy, center[2] + dz}), dart, reach))
            return true;
    return false;
  }

 private:
  using Address = std::array<std::int64_t, 3>;
  static constexpr std::size_t kNone = ~std::size_t{0};
  struct Member {
    Dart dart;
    double radius;
    std::size_t next;  // in the same bucket
  };

  // Cells may share a bucket: that costs distance tests, never an answer.
  template <typename Reach>
  bool refuses_in(std::size_t bucket, const Dart& dart, const Reach& reach) const {
    for (std::size_t m = heads_[bucket]; m != kNone; m = members_[m].next) {
      const double distance = reach(members_[m].dart, members_[m].radius);
      if (offset(members_[m].dart.position, dart.position).squaredNorm() < distance * distance)
        return true;
    }
    return false;
  }

  [[nodiscard]] bool flat() const { return period_ > 0.0; }
  [[nodiscard]] Vec3 offset(const Vec3& from, const Vec3& to) const;
  [[nodiscard]] Address address(const Vec3& p) const;
  [[nodiscard]] std::size_t bucket(Address a) const;
  void link(std::size_t member);
  void grow();

  double cell_;
  double period_;
  std::int64_t side_;               // cells around the torus
  std::vector<std::size_t> heads_;  // per bucket; a power of two
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
