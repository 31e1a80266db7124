// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the tables of options as JSON, without the library and without Python: see
// test_one_definition.py.
#include <iomanip>
#include <iostream>

#include "option_rows.hpp"

namespace {

using dapple::python::Row;

struct Print {
  void operator()(bool value) const { std::cout << (value ? "true" : "false"); }
  void operator()(double value) const { std::cout << std::showpoint << value << std::noshowpoint; }
  void operator()(const std::string& text) const { std::cout << std::quoted(text); }
  template <class Whole>
  void operator()(Whole value) const {
    std::cout << value;
  }
};

void print(const char* name, const std::optional<dapple::python::Value>& value) {
  std::cout << ", \"" << name << "\": ";
  if (value)
    std::visit(Print(), *value);
  else
    std::cout << "null";
}

void print(const Row& row) {
  std::cout << "{\"name\": " << std::quoted(row.name);
  print("type", row.type);
  print("default", row.standard);
  print("min", row.min);
  print("max", row.max);
  print("open", row.open);
  print("range", range_of(row));
  print("unit", row.unit);
  print("documentation", row.documentation);
  print("changes_solution", row.changes_solution);
  print("level", row.level);
  std::cout << ", \"choices\": [";
  for (std::size_t k = 0; k < row.choices.size(); ++k)
    std::cout << (k ? ", " : "") << std::quoted(row.choices[k]);
  std::cout << "]}";
}

}  // namespace

int main() {
  std::cout << std::setprecision(12) << '{';
  const char* before = "\n";
  const auto print_verb = [&](const auto& verb) {
    std::cout << before << std::quoted(verb.name) << ": [";
    before = ",\n";
    const std::vector<Row> rows = rows_of(verb);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (k) std::cout << ",\n";
      print(rows[k]);
    }
    std::cout << ']';
  };
  std::apply([&](const auto&... verb) { (print_verb(verb), ...); }, dapple::python::kVerbs);
  std::cout << "}\n";
}
