// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/context.hpp>
#include <dapple/errors.hpp>

namespace dapple {

void Context::advance(double value) {
  double seen = progress_.load();
  while (value > seen && !progress_.compare_exchange_weak(seen, value)) {
  }
  if (whole_) whole_->advance(value < 1.0 ? from_ + value * (to_ - from_) : to_);
}

void Context::check() const {
  if (cancelled()) throw Cancelled();
}

}  // namespace dapple
