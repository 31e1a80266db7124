// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <utility>

namespace dapple {

/// What is made on first use, and shared by all who ask.
template <typename T>
class Lazy {
 public:
  /// \param make returns a shared_ptr; called without the lock, because a Poll may ask too. If
  ///             several are made, the first is kept.
  template <typename Make>
  [[nodiscard]] std::shared_ptr<const T> get(const Make& make) {
    {
      const std::scoped_lock lock(mutex_);
      if (value_) return value_;
    }
    std::shared_ptr<const T> made = make();
    const std::scoped_lock lock(mutex_);
    if (!value_) value_ = std::move(made);
    return value_;
  }

 private:
  std::mutex mutex_;
  std::shared_ptr<const T> value_;
};

}  // namespace dapple
