// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <span>
#include <vector>

namespace dapple {

/// The density of a surface times a factor that grows where meshes are far from the surface, so
/// that the next mesh of as many vertices is nearer to it.
class AdaptedDensity {
 public:
  /// The surface must outlive it. \param count vertices of the meshes
  AdaptedDensity(const Surface& surface, std::size_t count);

  /// Raise the factor where the distance is large beside the mean.
  /// \param distances per vertex, how far the mesh around it and the surface are apart
  void learn(std::span<const Vec3> vertices, std::span<const double> distances);

  /// The density of the surface times the factor: three values per face, of its corners.
  [[nodiscard]] std::vector<double> values() const;

 private:
  [[nodiscard]] double spacing() const;
  void limit_growth();

  const Surface& surface_;
  double count_;
  std::vector<double> factors_;  // per vertex; that of a welded group is at its lowest
};

}  // namespace dapple
