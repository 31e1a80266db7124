// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <vector>

#include "base/random.hpp"
#include "start/dart.hpp"

namespace dapple {

/// Move darts on components that are thinner than their spacing and longer, such as wires, ropes
/// and ribbons, to equal shares of the density along them: there darts are uneven over a length
/// that no few steps make up for. Branches follow one after another.
/// \param spacing of the darts where the density is 1
/// \param locked  how many of the first darts stay; so do others on their components
/// \param phase   where in its share of the length each dart is, in 0..1
/// \return how many darts were moved
/// \throw Cancelled
std::size_t lay_along_thin_parts(const Surface& surface, double spacing, std::size_t locked,
                                 double phase, Random& random, std::vector<Dart>& darts,
                                 const Context* context);

}  // namespace dapple
