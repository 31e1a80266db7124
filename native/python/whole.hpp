// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <cstdint>
#include <dapple/errors.hpp>
#include <dapple/types.hpp>
#include <limits>
#include <string>

namespace dapple::python {

namespace py = pybind11;

/// Any integer of Python or numpy; null if the object is not one.
inline py::object whole_number(py::handle value) {
  if (!PyIndex_Check(value.ptr())) return {};
  auto number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!number) PyErr_Clear();
  return number;
}

/// An integer as text. Python refuses to convert thousands of digits, and a hundred digits are not
/// useful.
inline std::string digits_of(const py::object& number) {
  constexpr std::size_t kMost = 40;
  const py::object text = py::reinterpret_steal<py::object>(PyObject_Str(number.ptr()));
  if (!text) {
    PyErr_Clear();
    return "a number of thousands of digits";
  }
  const auto all = text.cast<std::string>();
  return all.size() <= kMost ? all : all.substr(0, kMost) + "...";
}

/// \throw ArgumentError naming the argument and its range, if the number is out of it
inline std::uint64_t bounded(const std::string& name, const py::object& number, std::int64_t low,
                             std::uint64_t high) {
  if (number < py::int_(low) || number > py::int_(high))
    throw ArgumentError(name + " is " + digits_of(number) + ": it must be in " +
                        std::to_string(low) + ".." + std::to_string(high));
  return static_cast<std::uint64_t>(low < 0 ? PyLong_AsLongLong(number.ptr())
                                            : PyLong_AsUnsignedLongLong(number.ptr()));
}

/// The name of an argument, as a template parameter.
template <std::size_t Size>
struct Name {
  constexpr Name(const char (&name)[Size]) { std::copy_n(name, Size, text); }  // NOLINT
  char text[Size] = {};
};

/// An integer that Python passes for the argument of that name. For a value out of range, pybind11
/// would print the list of its signatures; this type reports the name and the range.
template <typename T, Name Argument, std::int64_t Low, std::uint64_t High>
struct Whole {
  T value = T();
  operator T() const { return value; }  // NOLINT(google-explicit-constructor): it is one
};

constexpr std::uint64_t kMostInt = std::numeric_limits<int>::max();

using Count = Whole<std::size_t, "count", 0, kMostSamples>;
using Threads = Whole<int, "threads", 0, kMostThreads>;
using MaxFaces = Whole<std::size_t, "max_faces", 1, kMostRefinedFaces>;
using Done = Whole<std::size_t, "done", 0, kMostSamples>;
using Smoothing = Whole<int, "smoothing", 0, 100>;

}  // namespace dapple::python

namespace pybind11::detail {

template <typename T, dapple::python::Name Argument, std::int64_t Low, std::uint64_t High>
struct type_caster<dapple::python::Whole<T, Argument, Low, High>> {
  using Type = dapple::python::Whole<T, Argument, Low, High>;
  PYBIND11_TYPE_CASTER(Type, const_name("int"));

  bool load(handle source, bool) {
    const object number = dapple::python::whole_number(source);
    if (!number) return false;
    value.value = static_cast<T>(dapple::python::bounded(Argument.text, number, Low, High));
    return true;
  }

  static handle cast(const Type& whole, return_value_policy, handle) {
    return int_(whole.value).release();
  }
};

}  // namespace pybind11::detail
