// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/random.hpp"
#include "start/dart.hpp"
#include "surface/islands.hpp"

namespace dapple {

/// Draws points of a surface with its density, while their island has places left.
class DartBoard {
 public:
  /// Each island gets its share of `count` places by capacity, by largest remainders.
  /// \param taken existing darts, included in `count`
  DartBoard(const Surface& surface, std::size_t count, const std::vector<Dart>& taken = {});

  /// A random point of the surface, before its face is found.
  struct Draw {
    OrderedFace face;
    Vec3 weights;
  };
  static constexpr std::uint64_t kNumbers = 4;  ///< random numbers of a draw without rejection
  /// \pre a place is left
  [[nodiscard]] Draw draw(Random& random) const;
  /// One place of the dart's island is taken. True if it was the last one: what was drawn
  /// meanwhile counts no more.
  bool take(const Dart& dart);

 private:
  void sum_up();
  [[nodiscard]] std::size_t face_at(double capacity) const;
  [[nodiscard]] Draw draw_on(OrderedFace face, Random& random) const;

  const Surface* surface_;
  std::shared_ptr<const Islands> islands_;
  std::vector<std::size_t> places_;   // left per island
  std::vector<double> cumulative_;    // capacity of the faces so far, without full islands
  double closed_ = 0.0;               // capacity of islands that have become full since
  std::vector<std::uint32_t> guide_;  // per equal part of the capacity: the face it begins in
};

}  // namespace dapple
