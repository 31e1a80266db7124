// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/context.hpp>
#include <optional>

namespace dapple {

/// A stretch of the progress of a piece of work, for a part of it that counts from 0 to 1 by
/// itself; nothing if nobody watches.
class Stretch {
 public:
  Stretch(Context* whole, double from, double to) {
    if (whole) part_.emplace(*whole, from, to);
  }

  /// Step `k` of `count` equal ones of a stretch.
  Stretch(Context* whole, std::size_t k, std::size_t count)
      : Stretch(whole, static_cast<double>(k) / static_cast<double>(count),
                static_cast<double>(k + 1) / static_cast<double>(count)) {}

  [[nodiscard]] Context* context() { return part_ ? &*part_ : nullptr; }

 private:
  std::optional<Context> part_;
};

}  // namespace dapple
