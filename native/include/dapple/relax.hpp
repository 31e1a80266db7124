// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/relax_options.hpp>
#include <dapple/samples.hpp>

namespace dapple {

/// Make samples even again where something has changed: the density, some vertices, what is
/// blocked. Only the samples whose cells have a part of the changed faces and two rings of
/// neighbors around them may move, go or get others beside them; all others keep every byte. Where
/// samples at the border of that region are left with too much or too little, it grows and they are
/// made even too. Cells are computed of the region and two rings around it alone.
///
/// Samples where the density is 0 are moved or replaced as if something had changed there. With a
/// count the region grows until its samples need not come nearer to each other, or farther apart,
/// by more than 1 % of their number: to all samples, if so many come or go.
///
/// Several classes are relaxed one after another, rare ones first: each even by itself and with
/// those that are as rare or rarer, its discs apart from theirs. More common ones then make room
/// where these have moved. A class that is within 10 % of what it is to be stays as it is.
///
/// Those that stay come first, in their order and with their ids; new ids follow the largest. The
/// report measures the samples that were free to move and those beside them, of each class if there
/// are several; its count and spacing are of all, its slides of those that were free and stay.
/// \param samples of one class or of those in the options, on a surface of the same faces; they are
///                carried by their faces where vertices have moved
/// \param changed the caller's indices of the faces where something has changed, see
///                changed_faces(); none: nothing moves unless the count is another, and then
///                samples may come and go everywhere
/// \throw ArgumentError if the samples are not of the surface, or of a class that is not in the
///        options; naming the first face or locked index out of range; for options out of range, a
///        count below the number of locked samples, or a surface that has grown so much that it
///        asks for more samples than there can be; Cancelled
[[nodiscard]] Samples relax(const Surface& surface, const Samples& samples,
                            std::span<const std::int32_t> changed, const RelaxOptions& options = {},
                            Context* context = nullptr);

/// The faces whose corners or densities differ between two surfaces of the same faces, in
/// increasing order.
/// \throw ArgumentError unless one was made from the other by deformed() or with_density()
[[nodiscard]] std::vector<std::int32_t> changed_faces(const Surface& before, const Surface& after);

}  // namespace dapple
