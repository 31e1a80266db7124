// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>

#include "skin/outer_sides.hpp"

namespace dapple {

/// Looks from places of a surface for free ways to the outside.
class Sky {
 public:
  /// \throw Cancelled
  explicit Sky(const Surface& surface, const Context* context = nullptr);

  /// The share of free directions over the place of a face (the caller's index); of two outer
  /// sides, over the one that has more of them.
  [[nodiscard]] double exposure(const Vec3& place, const Vec3& normal, std::int32_t face) const;

  /// Whether the exposure is at least `least`, and not 0; looks only as long as that is open. The
  /// more of what is around is the inside of hollow parts, the more it must be, see OutsideOptions.
  [[nodiscard]] bool sees(const Vec3& place, const Vec3& normal, std::int32_t face,
                          double least) const;

  /// Whether the place of a face (the caller's index) lies on a face of a lower index: of faces
  /// that lie on each other only the first is seen. Neighbors that only meet do not count.
  [[nodiscard]] bool is_covered(const Vec3& place, std::int32_t face) const;

 private:
  /// The shares of free directions over the front and the back.
  [[nodiscard]] std::array<double, 2> free_on_sides(const Vec3& place, const Vec3& normal) const;
  /// Whether a side of a face is outside: 0 the front, 1 the back.
  [[nodiscard]] bool is_outside(std::int32_t face, std::size_t side) const;
  [[nodiscard]] bool sees_over(const Vec3& place, const Vec3& normal, double least) const;
  /// The share of these rays that end on the inside of a part, estimated from the first few.
  [[nodiscard]] double inner_share(std::span<const Ray> rays) const;
  [[nodiscard]] Ray ray_from(const Vec3& place, const Vec3& normal, const Vec3& direction) const;
  [[nodiscard]] bool is_free(const Vec3& place, const Vec3& normal, const Vec3& direction) const;
  [[nodiscard]] bool lie_on_each_other(std::int32_t a, std::int32_t b) const;

  Surface surface_;
  Projector projector_;
  std::vector<Vec3> directions_;
  std::vector<Sides> sides_;  // per face, the caller's order
};

}  // namespace dapple
