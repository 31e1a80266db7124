// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <dapple/samples.hpp>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

namespace dapple::test {

/// A 64-bit FNV-1a hash of integers and of the bits of other numbers, starting with the lowest
/// byte. Adding does not allocate memory.
class Hash {
 public:
  void add(std::uint64_t bits) {
    for (int byte = 0; byte < 8; ++byte) {
      state_ ^= bits >> (8 * byte) & 0xff;
      state_ *= 0x100000001b3u;
    }
  }
  void add(std::int32_t value) {
    add(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <int Size>
  void add(const Eigen::Matrix<double, Size, 1>& point) {
    for (const double value : point) add(value);
  }
  template <typename Value, std::size_t Size>
  void add(const std::array<Value, Size>& values) {
    for (const Value& value : values) add(value);
  }
  template <typename Value>
  void add(const std::vector<Value>& values) {
    add(static_cast<std::uint64_t>(values.size()));
    for (const Value& value : values) add(value);
  }
  void add(const Samples& samples) {
    add(samples.positions);
    add(samples.normals);
    add(samples.faces);
    add(samples.barycentric);
    add(samples.ids);
    add(samples.classes);
    add(samples.report.energy);
    add(samples.report.slide_max);
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }
  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << state_;
    return out.str();
  }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace dapple::test
