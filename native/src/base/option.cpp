// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/option.hpp>

#include "base/validate.hpp"

namespace dapple {
namespace {

bool contains(const Range& range, double value) {
  return (range.open ? value > range.min : value >= range.min) && value <= range.max;
}

std::string text_of(const Range& range) {
  if (range.max < kFinite) return "in " + number(range.min) + ".." + number(range.max);
  return std::string(range.max == kFinite ? "finite and " : "") + (range.open ? "> " : ">= ") +
         number(range.min);
}

}  // namespace

void check_range(const char* name, double value, const Range& range) {
  if (!contains(range, value))
    throw ArgumentError(std::string(name) + " is " + number(value) + ": it must be " +
                        text_of(range));
}

void refuse_whole(const char* name, const std::string& value, const Range& range,
                  const std::string& largest) {
  throw ArgumentError(std::string(name) + " is " + value + ": it must be in " + number(range.min) +
                      ".." + largest);
}

}  // namespace dapple
