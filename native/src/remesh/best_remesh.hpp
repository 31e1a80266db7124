// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "remesh/remesher.hpp"

namespace dapple {

/// The mesh of a surface with the fewest flaws: by cells in space, or where that does not suffice
/// by cells along the surface.
/// \param lines of the surface, with any density
/// \throw Cancelled
[[nodiscard]] TracedMesh best_remesh(const Surface& surface, std::size_t count,
                                     const RemeshOptions& options, const FeatureLines& lines,
                                     const Beginning& beginning, Context* context);

}  // namespace dapple
