// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/class_options.hpp>
#include <dapple/context.hpp>
#include <dapple/samples.hpp>

namespace dapple {

/// Several classes at once, each of exactly its count, even by itself and all together: minimizes
/// mu N E*(union) + sum over the classes of E*(class), where E* = n E / |S|_phi^2 of each set's own
/// number and density, N is the number of classes that are not empty, and the density of the union
/// is sum_c n_c phi_c / |S|_phi_c (paper, section 4.3, made fit for classes of different
/// densities).
///
/// Samples come class by class, `classes` holds the class of each. Where classes have radii, the
/// report names the pair that still overlaps most.
/// \throw ArgumentError naming an option or radius out of range, a surface that is not of the same
///        faces, or radii for which the area cannot suffice; Cancelled
[[nodiscard]] Samples sample_classes(const Surface& surface, std::span<const SampleClass> classes,
                                     const ClassOptions& options = {}, Context* context = nullptr);

}  // namespace dapple
