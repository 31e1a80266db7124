// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/optimizer.hpp>
#include <dapple/samples.hpp>

#include "optimize/minimizer.hpp"

namespace dapple {

/// Samples this little above another normalized energy are as even to the eye. (From a Poisson-disk
/// start to convergence it falls by about 0.03.)
inline constexpr double kAsEven = 5e-4;

/// The least capacity variation of as many samples as each island of the density has: within one
/// they share its capacity at best. 0 where there is one island.
[[nodiscard]] double whole_count_variation(const Domain& domain, const Sites& sites);

/// The evenness of sites by the energy over their cells.
/// \param normals of the surface, per site
[[nodiscard]] Quality measure(const Domain& domain, const Energy& energy, const Sites& sites,
                              std::span<const Vec3> normals);

/// The result of the minimizer, for the union and class by class.
/// \param class_count number of classes, empty ones too
/// \param normals     of the surface, per site
[[nodiscard]] Report to_report(const Objective& objective, const Minimum& found,
                               std::size_t class_count, std::span<const Vec3> normals);

/// The same as samples of a surface.
[[nodiscard]] Samples to_samples(const Surface& surface, const Objective& objective,
                                 const Minimum& found, std::size_t class_count,
                                 std::span<const std::int32_t> ids = {});

/// One class, found by optimize().
[[nodiscard]] Samples to_samples(const Surface& surface, const Domain& domain,
                                 OptimizerResult&& found, std::span<const std::int32_t> ids);

/// The distances of samples from their previous positions, in spacings; `before` may be fewer.
void measure_slide(Report& report, std::span<const Vec3> now, std::span<const Vec3> before);

}  // namespace dapple
