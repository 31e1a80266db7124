// SPDX-License-Identifier: GPL-3.0-or-later
#include "bytes.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace dapple::fuzz {
namespace {

using Limits = std::numeric_limits<double>;

constexpr std::array<double, 16> kEdges = {0.0,
                                           -0.0,
                                           1.0,
                                           -1.0,
                                           1e-12,
                                           1e12,
                                           1e155,
                                           -1e155,
                                           1e-155,
                                           Limits::max(),
                                           Limits::min(),
                                           Limits::denorm_min(),
                                           Limits::epsilon(),
                                           Limits::infinity(),
                                           -Limits::infinity(),
                                           Limits::quiet_NaN()};

}  // namespace

std::uint8_t Bytes::byte() {
  if (left_.empty()) return 0;
  const std::uint8_t first = left_.front();
  left_ = left_.subspan(1);
  return first;
}

std::uint64_t Bytes::whole() {
  std::uint64_t bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<std::uint64_t>(byte()) << (8 * k);
  return bits;
}

int Bytes::below(int end) { return byte() % end; }

int Bytes::between(int low, int high) { return low + below(high - low + 1); }

bool Bytes::one_in(int chances) { return byte() % chances == chances - 1; }

double Bytes::share() {
  const int low = byte();
  return (256 * byte() + low) / 65535.0;
}

double Bytes::between(double low, double high) { return low + (high - low) * share(); }

double Bytes::power(int low, int high) { return std::pow(10.0, between(low, high)); }

double Bytes::wild() {
  wild_ = true;
  const int kind = below(static_cast<int>(kEdges.size()) + 2);
  if (kind < static_cast<int>(kEdges.size())) return kEdges[static_cast<std::size_t>(kind)];
  return std::bit_cast<double>(whole());
}

}  // namespace dapple::fuzz
