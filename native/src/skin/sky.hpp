// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>

namespace dapple {

/// Looks from places of a surface for free ways to the outside.
class Sky {
 public:
  /// \throw Cancelled
  explicit Sky(const Surface& surface, const Context* context = nullptr);

  /// The share of free directions, over the side of the place that has more of them.
  [[nodiscard]] double exposure(const Vec3& place, const Vec3& normal) const;

  /// Whether the exposure is at least `least`, and not 0; looks only as long as that is open.
  [[nodiscard]] bool sees(const Vec3& place, const Vec3& normal, double least) const;

  /// Whether the place of a face (the caller's index) lies on a face of a lower index: of faces
  /// that lie on each other only the first is seen. Neighbors that only meet do not count.
  [[nodiscard]] bool is_covered(const Vec3& place, std::int32_t face) const;

 private:
  [[nodiscard]] bool is_free(const Vec3& place, const Vec3& normal, const Vec3& direction) const;
  [[nodiscard]] bool lie_on_each_other(std::int32_t a, std::int32_t b) const;

  Surface surface_;
  Projector projector_;
  std::vector<Vec3> directions_;
};

}  // namespace dapple
