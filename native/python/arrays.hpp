// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>

#include <dapple/errors.hpp>
#include <dapple/types.hpp>
#include <limits>
#include <span>
#include <string>

namespace dapple::python {

namespace py = pybind11;

using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;
using IntArray = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

inline std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < array.ndim(); ++k)
    text += (k ? ", " : "") + std::to_string(array.shape(k));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

/// The items of a sequence with references to them, because another thread may empty it, or it may
/// create them on the fly.
inline std::vector<py::object> items_of(const py::object& sequence) {
  std::vector<py::object> items;
  for (const py::handle item : sequence) items.push_back(py::reinterpret_borrow<py::object>(item));
  return items;
}

/// The argument as a contiguous numpy array in memory that no other thread can write to. Only this
/// copy is checked and used.
/// \throw ArgumentError naming the argument
inline py::array copied(const char* name, const py::object& value) {
  using Api = py::detail::npy_api;
  constexpr int kEnsureCopy = 0x20;  // NPY_ARRAY_ENSURECOPY, which pybind11 does not name
  auto array = py::reinterpret_steal<py::array>(Api::get().PyArray_FromAny_(
      value.ptr(), nullptr, 0, 0,
      Api::NPY_ARRAY_ENSUREARRAY_ | Api::NPY_ARRAY_C_CONTIGUOUS_ | kEnsureCopy, nullptr));
  if (array) return array;
  if (PyErr_ExceptionMatches(PyExc_MemoryError) || !PyErr_ExceptionMatches(PyExc_Exception))
    throw py::error_already_set();
  PyErr_Clear();
  throw ArgumentError(std::string(name) + " is not an array: numpy cannot convert it");
}

/// \throw ArgumentError unless the array is of one of the dtype kinds
inline void check_kind(const char* name, const py::array& array, const std::string& kinds) {
  if (array.size() > 0 && kinds.find(array.dtype().kind()) == std::string::npos)
    throw ArgumentError(std::string(name) + " has the dtype " +
                        py::str(array.dtype()).cast<std::string>() +
                        (kinds == "iu" ? ": integers are needed" : ": numbers are needed"));
}

/// A copy of the argument, of one of the dtype kinds, with the shape (rows) or (rows, columns).
inline py::array checked_array(const char* name, const py::object& value, const std::string& kinds,
                               py::ssize_t columns) {
  const py::array array = copied(name, value);
  check_kind(name, array, kinds);
  const bool fits =
      columns == 0 ? array.ndim() == 1 : array.ndim() == 2 && array.shape(1) == columns;
  if (!fits)
    throw ArgumentError(std::string(name) + " has the shape " + shape_text(array) + ": (n" +
                        (columns == 0 ? ",)" : ", " + std::to_string(columns) + ")") +
                        " is needed");
  return array;
}

/// Floating-point rows, copied.
inline DoubleArray doubles(const char* name, const py::object& value, py::ssize_t columns) {
  return DoubleArray(checked_array(name, value, "fiu", columns));
}

/// Numbers with the given number of axes, copied.
/// \param needed the shape, for the message
inline DoubleArray doubles_of_shape(const char* name, const py::object& value, py::ssize_t axes,
                                    const std::string& needed) {
  const py::array array = copied(name, value);
  if (array.ndim() != axes)
    throw ArgumentError(std::string(name) + " has the shape " + shape_text(array) + ": " + needed +
                        " is needed");
  check_kind(name, array, "fiu");
  return DoubleArray(array);
}

/// Rows and columns of numbers, copied.
inline Image image_of(const char* name, const py::object& value) {
  const DoubleArray values = doubles_of_shape(name, value, 2, "(rows, columns)");
  return {static_cast<std::size_t>(values.shape(0)),
          static_cast<std::size_t>(values.shape(1)),
          {values.data(), values.data() + values.size()}};
}

/// Integer rows as int32, copied. pybind11 before 2.12 misreads the item size of numpy 2, so the
/// types are compared.
inline IntArray integers(const char* name, const py::object& value, py::ssize_t columns) {
  const py::array array = checked_array(name, value, "iu", columns);
  if (array.size() > 0 && !py::isinstance<py::array_t<std::int32_t>>(array)) {
    const auto low = py::float_(array.attr("min")()).cast<double>();
    const auto high = py::float_(array.attr("max")()).cast<double>();
    if (low < std::numeric_limits<std::int32_t>::min() ||
        high > std::numeric_limits<std::int32_t>::max())
      throw ArgumentError(std::string(name) + " holds values in " + std::to_string(low) + ".." +
                          std::to_string(high) + ", which do not fit into 32 bits");
  }
  return IntArray(array);
}

/// Vectors at the corners of faces (m, 3, columns) as rows, three rows per face; copied.
inline DoubleArray corner_rows(const char* name, const py::object& value, py::ssize_t columns) {
  const std::string needed = "(m, 3, " + std::to_string(columns) + ")";
  const DoubleArray array = doubles_of_shape(name, value, 3, needed);
  if (array.shape(1) != 3 || array.shape(2) != columns)
    throw ArgumentError(std::string(name) + " has the shape " + shape_text(array) + ": " + needed +
                        " is needed");
  return DoubleArray(array.attr("reshape")(-1, columns));
}

inline std::span<const FaceUv> as_face_uv(const DoubleArray& rows) {
  static_assert(sizeof(FaceUv) == 6 * sizeof(double));
  return {reinterpret_cast<const FaceUv*>(rows.data()),
          static_cast<std::size_t>(rows.shape(0)) / 3};
}

inline std::span<const Vec3> as_points(const DoubleArray& array) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {reinterpret_cast<const Vec3*>(array.data()), static_cast<std::size_t>(array.shape(0))};
}

inline std::span<const Face> as_faces(const IntArray& array) {
  static_assert(sizeof(Face) == 3 * sizeof(std::int32_t));
  return {reinterpret_cast<const Face*>(array.data()), static_cast<std::size_t>(array.shape(0))};
}

template <typename T, int Flags>
std::span<const T> as_span(const py::array_t<T, Flags>& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// A read-only numpy view of memory that `owner` keeps alive.
template <typename T>
py::array view(const py::object& owner, const T* data, std::vector<py::ssize_t> shape) {
  py::array_t<T> array(std::move(shape), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

inline py::array view(const py::object& owner, const std::vector<Vec3>& points) {
  return view(owner, points.empty() ? nullptr : points[0].data(),
              {static_cast<py::ssize_t>(points.size()), 3});
}

template <typename T>
py::array view(const py::object& owner, const std::vector<T>& values) {
  return view(owner, values.data(), {static_cast<py::ssize_t>(values.size())});
}

/// Give a vector to numpy without copying it.
template <typename T>
py::array give(std::vector<T>&& values) {
  auto* kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return view(owner, *kept);
}

inline py::array give(std::vector<Face>&& faces) {
  auto* kept = new std::vector<Face>(std::move(faces));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Face>*>(p); });
  return view(owner, kept->empty() ? nullptr : kept->front().data(),
              {static_cast<py::ssize_t>(kept->size()), 3});
}

}  // namespace dapple::python
