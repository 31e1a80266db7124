// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <dapple/surface.hpp>

namespace dapple {

/// One class of sites to place.
struct ClassStart {
  const Surface* surface;  ///< with the density of the class
  std::size_t count;       ///< locked sites included
  double radius = 0.0;     ///< of its discs; sites of two classes keep apart by the sum
  Sites locked = {};       ///< existing sites
};

/// All classes to place, on surfaces of the same faces.
struct ClassStarts {
  std::vector<ClassStart> classes;
  const Surface* all;   ///< with the density of the union
  double period = 0.0;  ///< of the torus; 0 elsewhere
  std::uint64_t seed = 0;
};

/// Exactly the counts, class by class, locked sites first: white noise.
[[nodiscard]] Sites random_start(const ClassStarts& starts);

/// The same by dart throwing. A dart is refused within r of one of its class and within 0.85 r' of
/// any, r and r' following the densities of the class and of all as phi^(-1/2); within the sum of
/// their radii from another disc. Larger discs go first; of equal ones the dart is for the class
/// that is least filled. r and r' shrink each time that too many darts are refused, in the end the
/// discs' radii too, until all fit. Parts that are thinner than the spacing are then filled evenly
/// along their length.
/// \param along becomes the number of sites on such parts
/// \throw Cancelled
[[nodiscard]] Sites poisson_start(const ClassStarts& starts, Context* context,
                                  std::size_t* along = nullptr);

}  // namespace dapple
