// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace dapple::fuzz {

/// What a fuzzer has found, taken apart from its beginning. After the end all bytes are 0, which
/// stands for what is plain: a shorter input asks for less.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : left_(bytes) {}

  [[nodiscard]] bool empty() const { return left_.empty(); }
  /// Whether wild() was asked, or somebody has said so: what comes of it may well be refused.
  [[nodiscard]] bool was_wild() const { return wild_; }
  void set_wild() { wild_ = true; }

  std::uint8_t byte();
  std::uint64_t whole();           // of eight bytes
  int below(int end);              // 0 .. end - 1
  int between(int low, int high);  // both ends included
  bool one_in(int chances);        // not at the end of the input
  double share();                  // [0, 1], of two bytes
  double between(double low, double high);
  double power(int low, int high);  // of ten
  double wild();                    // any number: what is no number, bounds, all bits

  /// All that is left.
  [[nodiscard]] std::string_view rest() const {
    return {reinterpret_cast<const char*>(left_.data()), left_.size()};
  }

 private:
  std::span<const std::uint8_t> left_;
  bool wild_ = false;
};

}  // namespace dapple::fuzz
