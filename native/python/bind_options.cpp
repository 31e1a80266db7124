// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl.h>

#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple::python {

inline auto members(Row& r) {
  return std::tie(r.name, r.type, r.standard, r.min, r.max, r.bounded, r.open, r.choices, r.unit,
                  r.documentation, r.changes_solution, r.level);
}

namespace {

constexpr std::size_t kColumns = 120;  // longest line of documentation
constexpr char kNoBreak = '\1';        // stands for a space without a line break

std::string text_of(const Value& value) { return py::repr(py::cast(value)).cast<std::string>(); }

/// Words wrapped into lines; all but the first are indented by eight.
std::string wrapped(const std::string& text) {
  std::string result, line = "    ";
  std::size_t from = 0;
  while (from < text.size()) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    if (line.size() + to - from > kColumns) {
      result += line.substr(0, line.size() - 1) + "\n";
      line = "        ";
    }
    line += text.substr(from, to - from) + " ";
    from = to + 1;
  }
  return result + line.substr(0, line.size() - 1);
}

/// "name: The sentence (range; in unit)."
std::string line_of(const Row& row) {
  std::string more = range_of(row);
  if (!row.unit.empty()) more += std::string(more.empty() ? "" : "; ") + "in " + row.unit;
  std::replace(more.begin(), more.end(), ' ', kNoBreak);
  const std::string& text = row.documentation;
  const std::string sentence =
      more.empty() ? text : text.substr(0, text.size() - 1) + " (" + more + ").";
  std::string line = wrapped(row.name + ": " + sentence);
  std::replace(line.begin(), line.end(), kNoBreak, ' ');
  return line;
}

template <class Part>
std::string joined(const std::vector<Row>& rows, const char* between, const Part& part) {
  std::string result;
  for (const Row& row : rows) {
    if (!result.empty()) result += between;
    result += part(row);
  }
  return result;
}

void put(std::string& text, const std::string& place, const std::string& content) {
  const std::size_t at = text.find(place);
  if (at != std::string::npos) text.replace(at, place.size(), content);
}

std::vector<Row> table_of(const std::string& name) {
  std::vector<Row> rows;
  bool found = false;
  const auto look = [&](const auto& verb) {
    if (name != verb.name) return;
    found = true;
    rows = rows_of(verb);
  };
  std::apply([&](const auto&... verb) { (look(verb), ...); }, kVerbs);
  if (!found) throw ArgumentError("verb is '" + name + "': it has no table of options");
  return rows;
}

/// The settings of paper_options(), by name.
py::dict paper_settings() {
  py::dict result;
  const auto plain = values_of(SampleOptions()), paper = values_of(paper_options());
  for (std::size_t k = 0; k < paper.size(); ++k)
    if (paper[k] != plain[k]) result[paper[k].first.c_str()] = paper[k].second;
  return result;
}

}  // namespace

void refuse_type(const std::string& name, const py::handle& value, const std::string& needed) {
  throw py::type_error(name + " is " + py::repr(value).cast<std::string>() + ": " + needed +
                       " is needed");
}

void read(const char* name, const Range& range, const py::handle& value, double& number) {
  number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred()) {
    const bool too_large = PyErr_ExceptionMatches(PyExc_OverflowError) != 0;
    PyErr_Clear();
    if (!too_large) refuse_type(name, value, "a number");
    throw ArgumentError(std::string(name) + " is " +
                        digits_of(py::reinterpret_borrow<py::object>(value)) +
                        ": it does not fit into 64 bits");
  }
  check_range(name, number, range);
}

void read(const char* name, const Range&, const py::handle& value, bool& flag) {
  py::detail::make_caster<bool> caster;
  if (value.is_none() || !caster.load(value, true)) refuse_type(name, value, "True or False");
  flag = py::detail::cast_op<bool>(caster);
}

std::string documented(const std::vector<Row>& rows, std::string text) {
  put(text, "{signature}", joined(rows, ", ", [](const Row& row) {
        return row.name + ": " + row.type + " = " + text_of(row.standard);
      }));
  put(text, "    {options}", joined(rows, "\n", line_of));
  return text;
}

void bind_options(py::module_& m) {
  py::class_<Row> type(m, "Option", "What is known of an option of a verb; see option_table().");
  def_pickle<Row>(type, "Option");
  type.def_readonly("name", &Row::name, "As the argument is called.")
      .def_readonly("type", &Row::type, "'float', 'int', 'bool' or 'str'.")
      .def_readonly("default", &Row::standard, "What the verb takes where nothing is given.")
      .def_readonly("min", &Row::min, "The least number, or None.")
      .def_readonly("max", &Row::max, "The largest number; None: any that is finite.")
      .def_readonly("open", &Row::open, "Whether min itself is too small.")
      .def_readonly("choices", &Row::choices, "The words that it may be, if it is a str.")
      .def_property_readonly("range", &range_of, "The numbers or words that it may be, as text.")
      .def_readonly("unit", &Row::unit, "Of the number; '' for none.")
      .def_readonly("documentation", &Row::documentation, "One sentence.")
      .def_readonly("changes_solution", &Row::changes_solution, "Whether the result depends on it.")
      .def_readonly("level", &Row::level,
                    "'basic': also in the Blender add-on's panel; 'expert': for programs and the "
                    "command line.");
  m.def("option_table", &table_of, py::arg("verb"),
        R"(The options that a verb takes, in order: what help, forms and checks are made of.

Args:
    verb: its name, as 'sample' or 'Tracker'.

Returns:
    list of Option.

Raises:
    ValueError: there is no such verb, or it has no options of a struct.)");
  py::list names;
  std::apply([&](const auto&... verb) { (names.append(verb.name), ...); }, kVerbs);
  m.attr("_verbs") = py::tuple(names);
  m.def("_paper_options", &paper_settings);
}

}  // namespace dapple::python
