// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>

namespace dapple::python {

/// A path as an argument. The caster of pybind11 takes any error for a wrong argument, also a
/// Ctrl-C that comes while Python reads the path; this one raises what Python raises.
struct FilePath {
  std::filesystem::path path;
};

}  // namespace dapple::python

namespace pybind11::detail {

template <>
struct type_caster<dapple::python::FilePath> {
  PYBIND11_TYPE_CASTER(dapple::python::FilePath, const_name("os.PathLike"));

  /// \throw error_already_set what __fspath__ raises; TypeError for what is no path; ValueError for
  /// one that contains a null character
  bool load(handle source, bool /*convert*/) {
    const auto text = checked(PyOS_FSPath(source.ptr()));
    PyObject* native = nullptr;
#ifdef _WIN32
    if (!PyUnicode_FSDecoder(text.ptr(), reinterpret_cast<void*>(&native)))
      throw error_already_set();
    const auto owner = reinterpret_steal<object>(native);
    wchar_t* const wide = PyUnicode_AsWideCharString(native, nullptr);
    if (!wide) throw error_already_set();
    value.path = wide;
    PyMem_Free(wide);
#else
    if (!PyUnicode_FSConverter(text.ptr(), reinterpret_cast<void*>(&native)))
      throw error_already_set();
    value.path = checked(native).cast<bytes>().operator std::string();
#endif
    return true;
  }

 private:
  static object checked(PyObject* created) {
    if (!created) throw error_already_set();
    return reinterpret_steal<object>(created);
  }
};

}  // namespace pybind11::detail
