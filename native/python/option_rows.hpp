// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/option_tables.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "verbs.hpp"

// The description of options for Python. It does not depend on Python, so that a small program can
// print it.

namespace dapple::python {

using Value = std::variant<bool, std::int64_t, std::uint64_t, double, std::string>;

/// An option of a verb; see the members of dapple::Option.
struct Row {
  std::string name;
  std::string type;  ///< the type in Python
  Value standard;    ///< the default
  std::optional<Value> min = {};
  std::optional<Value> max = {};  ///< none: any finite value
  bool bounded = false;           ///< max is less than the largest value of its type
  bool open = false;
  std::vector<std::string> choices = {};
  std::string unit = {};
  std::string documentation = {};
  bool changes_solution = true;
  std::string level = {};
};

inline const char* name_of(Level level) {
  return level == Level::kBasic ? "basic" : level == Level::kExpert ? "expert" : "internal";
}

inline void describe(Row& row, const Range&, bool value) {
  row.type = "bool";
  row.standard = value;
}

inline void describe(Row& row, const Range& range, double value) {
  row.type = "float";
  row.standard = value;
  row.open = range.open;
  row.min = range.min;
  if (range.max < kFinite) row.max = range.max;
}

template <WholeNumber Number>
void describe(Row& row, const Range& range, Number value) {
  using Wide = std::conditional_t<std::is_signed_v<Number>, std::int64_t, std::uint64_t>;
  row.type = "int";
  row.standard = static_cast<Wide>(value);
  row.min = static_cast<Wide>(range.min);
  row.max = static_cast<Wide>(largest<Number>(range));
}

template <class Enum>
  requires std::is_enum_v<Enum>
void describe(Row& row, const Range&, Enum value) {
  row.type = "str";
  for (const Choice<Enum>& choice : choices_of(value)) {
    row.choices.emplace_back(choice.name);
    if (choice.value == value) row.standard = choice.name;
  }
}

/// A number in few digits.
inline std::string short_text(const Value& value) {
  std::ostringstream text;
  std::visit([&](const auto& number) { text << number; }, value);
  return text.str();
}

/// The allowed values of an option as text; empty for a bool.
inline std::string range_of(const Row& row) {
  std::string words;
  for (const std::string& choice : row.choices)
    words += (words.empty() ? "'" : " or '") + choice + "'";
  if (!row.min) return words;
  if (!row.bounded || !row.max) return (row.open ? "> " : ">= ") + short_text(*row.min);
  return short_text(*row.min) + ".." + short_text(*row.max);
}

/// Name and value of each option, nested ones too.
template <class Struct>
std::vector<std::pair<std::string, Value>> values_of(const Struct& options) {
  std::vector<std::pair<std::string, Value>> values;
  for_each_option(options, [&](const auto& option, const auto& value) {
    Row row;
    describe(row, option.range, value);
    values.emplace_back(option.name, row.standard);
  });
  return values;
}

/// The options that a verb takes, in order.
template <class Struct>
std::vector<Row> rows_of(const Verb<Struct>& verb) {
  std::vector<Row> rows;
  const Struct defaults;
  for_each_option(defaults, [&](const auto& option, const auto& value) {
    if (!verb.takes(option.name, option.level)) return;
    rows.push_back({.name = option.name,
                    .type = {},
                    .standard = {},
                    .bounded = option.range.max < kFinite,
                    .unit = option.unit,
                    .documentation = option.documentation,
                    .changes_solution = option.changes_solution,
                    .level = name_of(option.level)});
    describe(rows.back(), option.range, value);
  });
  return rows;
}

}  // namespace dapple::python
