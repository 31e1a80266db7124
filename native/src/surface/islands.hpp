// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/surface.hpp>
#include <memory>
#include <vector>

#include "surface/ordered_surface.hpp"

namespace dapple {

/// The parts of a surface that are connected over edges with density. Sites do not move from one
/// part to another, so each needs its own number of them. If the density is positive everywhere,
/// the parts are the components.
class Islands {
 public:
  explicit Islands(const Surface& surface);

  /// Whether there are faces without density.
  [[nodiscard]] bool has_gaps() const { return !labels_.empty(); }
  [[nodiscard]] std::size_t count() const { return capacities_.size(); }
  /// Of a face, in 0..count() - 1; faces without density have one too, of capacity 0.
  [[nodiscard]] std::size_t at(OrderedFace face) const {
    return static_cast<std::size_t>(labels_.empty() ? connectivity_->component[as_index(face)]
                                                    : labels_[as_index(face)]);
  }
  /// Integrals of the density, as those of faces.
  [[nodiscard]] const std::vector<double>& capacities() const { return capacities_; }

 private:
  std::shared_ptr<const Connectivity> connectivity_;
  std::vector<std::int32_t> labels_;  // per ordered face; empty: its component
  std::vector<double> capacities_;
};

/// Those of a surface, which are found once: all who ask share them.
[[nodiscard]] std::shared_ptr<const Islands> islands_of(const Surface& surface);

}  // namespace dapple
