// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstdint>
#include <dapple/types.hpp>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>

// What is known of an option stands once, in a tuple beside the struct that it is a member of:
// name, range, unit, sentence. The default is that of a default-constructed struct. Range checks,
// bindings, stubs, the command line, the add-on's properties and the pages are made of it.

namespace dapple {

/// Who sets an option.
enum class Level {
  kBasic,     ///< everybody: it is in all interfaces, also in the panel of the Blender add-on
  kExpert,    ///< programs and the command line
  kInternal,  ///< C++ alone
};

/// Of a number, with both ends. Of whole numbers kFinite is the largest that their type has.
struct Range {
  double min = 0.0;
  double max = kFinite;
  bool open = false;  ///< min itself is outside
};

template <class Struct, class Value>
struct Option {
  const char* name;  ///< the member's, in every interface
  Value Struct::*member;
  Range range;       ///< {} for what is no number
  const char* unit;  ///< "": none
  Level level;
  const char* documentation;  ///< one sentence
  bool changes_solution = true;
};

template <class Struct, class Value>
Option(const char*, Value Struct::*, Range, const char*, Level, const char*,
       bool = true) -> Option<Struct, Value>;

/// Options of a struct that is a member of another.
template <class Struct, class Nested>
struct Group {
  Nested Struct::*member;
};

template <class Struct, class Nested>
Group(Nested Struct::*) -> Group<Struct, Nested>;

/// A value of an enumeration, by the name that interfaces have for it. `choices_of(Enum)` beside
/// the enumeration returns all of them as an array.
template <class Enum>
struct Choice {
  const char* name;
  Enum value;
};

/// `visit(option, value)` for each option of a struct and of those within it, in the order of the
/// tuple that `options_of(struct)` returns.
template <class Struct, class Visit>
constexpr void for_each_option(Struct& options, const Visit& visit);

template <class Struct, class Owner, class Value, class Visit>
constexpr void visit_row(Struct& options, const Option<Owner, Value>& option, const Visit& visit) {
  visit(option, options.*option.member);
}

template <class Struct, class Owner, class Nested, class Visit>
constexpr void visit_row(Struct& options, const Group<Owner, Nested>& group, const Visit& visit) {
  for_each_option(options.*group.member, visit);
}

template <class Struct, class Visit>
constexpr void for_each_option(Struct& options, const Visit& visit) {
  std::apply([&](const auto&... row) { (visit_row(options, row, visit), ...); },
             options_of(options));
}

template <class Value>
concept WholeNumber = std::integral<Value> && !std::same_as<Value, bool>;

/// The largest that an option may be.
template <WholeNumber Value>
constexpr Value largest(const Range& range) {
  return range.max == kFinite ? std::numeric_limits<Value>::max() : static_cast<Value>(range.max);
}

/// \throw ArgumentError naming the option and its range, unless the value is in it
void check_range(const char* name, double value, const Range& range);

/// The same for a whole number; both numbers as text.
[[noreturn]] void refuse_whole(const char* name, const std::string& value, const Range& range,
                               const std::string& largest);

template <WholeNumber Value>
void check_range(const char* name, Value value, const Range& range) {
  if (static_cast<double>(value) < range.min || static_cast<double>(value) > range.max)
    refuse_whole(name, std::to_string(value), range, std::to_string(largest<Value>(range)));
}

/// \throw ArgumentError naming the first option that is out of its range
template <class Struct>
void check_ranges(const Struct& options) {
  for_each_option(options, []<class Owner, class Value>(const Option<Owner, Value>& option,
                                                        const Value& value) {
    if constexpr (WholeNumber<Value> || std::floating_point<Value>)
      check_range(option.name, value, option.range);
  });
}

}  // namespace dapple
