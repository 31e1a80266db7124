// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/stl.h>

#include <cstring>
#include <dapple/samples.hpp>
#include <tuple>

#include "bindings.hpp"

// Conversion of objects to plain values for pickle and copy, and back. A struct lists its members
// in an overload of members() and checks its invariants in one of check_members().

namespace dapple {

inline auto members(Evenness& e) {
  return std::tie(e.alpha_min, e.alpha_mean, e.capacity_variation, e.thin_share);
}
inline auto members(Quality& q) {
  return std::tie(q.count, q.spacing, q.evenness, q.bond_order, q.energy, q.whole_count_variation);
}
inline auto members(Profile& p) { return std::tie(p.seconds); }
inline auto members(Report& r) {
  return std::tuple_cat(members(static_cast<Quality&>(r)),
                        std::tie(r.classes, r.worst_overlap, r.overlapping, r.evaluations, r.parts,
                                 r.iterations, r.converged, r.seconds, r.profile, r.energies,
                                 r.slide_mean, r.slide_median, r.slide_max, r.births, r.deaths));
}

}  // namespace dapple

namespace dapple::python {

/// The number type of an array of such elements, and how many numbers an element has.
template <typename T>
struct Flat {
  using Number = T;
  static constexpr std::size_t kWidth = 1;
};
template <>
struct Flat<Vec2> {
  using Number = double;
  static constexpr std::size_t kWidth = 2;
};
template <>
struct Flat<Vec3> {
  using Number = double;
  static constexpr std::size_t kWidth = 3;
};
template <typename T, std::size_t N>
struct Flat<std::array<T, N>> {
  using Number = typename Flat<T>::Number;
  static constexpr std::size_t kWidth = N * Flat<T>::kWidth;
};
template <typename T>
  requires std::is_enum_v<T>
struct Flat<T> {
  using Number = std::underlying_type_t<T>;
  static constexpr std::size_t kWidth = 1;
};

template <typename T>
concept IsFlat = std::is_arithmetic_v<typename Flat<T>::Number> && !std::is_same_v<T, bool>;
template <typename T>
concept HasMembers = requires(T& value) { members(value); };

template <typename T>
inline constexpr bool kIsVector = false;
template <typename T>
inline constexpr bool kIsVector<std::vector<T>> = true;

template <typename T>
py::object packed_rows(const std::vector<T>& rows) {
  using Number = typename Flat<T>::Number;
  static_assert(sizeof(T) == Flat<T>::kWidth * sizeof(Number));
  py::array_t<Number> array(
      {static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(Flat<T>::kWidth)});
  if (!rows.empty())
    std::memcpy(array.mutable_data(), static_cast<const void*>(rows.data()),
                rows.size() * sizeof(T));
  return array;
}

template <typename T>
void unpack_rows(const py::object& value, std::vector<T>& rows) {
  using Number = typename Flat<T>::Number;
  const auto array = py::array_t<Number, py::array::c_style>::ensure(value);
  if (!array || array.ndim() != 2 || array.shape(1) != static_cast<py::ssize_t>(Flat<T>::kWidth))
    throw ArgumentError("an array in it has the wrong shape or dtype");
  rows.resize(static_cast<std::size_t>(array.shape(0)));
  if (!rows.empty())
    std::memcpy(static_cast<void*>(rows.data()), array.data(), rows.size() * sizeof(T));
}

template <typename T>
py::object packed(const T& value) {
  if constexpr (HasMembers<T>) {
    return std::apply([](const auto&... member) { return py::make_tuple(packed(member)...); },
                      members(const_cast<T&>(value)));
  } else if constexpr (kIsVector<T>) {
    if constexpr (IsFlat<typename T::value_type>) {
      return packed_rows(value);
    } else {
      py::list items;
      for (const auto& item : value) items.append(packed(item));
      return items;
    }
  } else if constexpr (std::is_enum_v<T>) {
    return py::int_(static_cast<std::int64_t>(value));
  } else if constexpr (std::is_base_of_v<py::object, T>) {
    return value;
  } else {
    return py::cast(value);
  }
}

template <typename T>
void unpack(const py::object& value, T& result) {
  if constexpr (HasMembers<T>) {
    const auto items = value.cast<py::tuple>();
    const auto all = members(result);
    if (items.size() != std::tuple_size_v<std::remove_cvref_t<decltype(all)>>)
      throw ArgumentError("it has the wrong number of members");
    std::size_t k = 0;
    std::apply([&](auto&... member) { (unpack(py::object(items[k++]), member), ...); }, all);
  } else if constexpr (kIsVector<T>) {
    if constexpr (IsFlat<typename T::value_type>) {
      unpack_rows(value, result);
    } else {
      result.clear();
      for (const py::object& item : items_of(value)) unpack(item, result.emplace_back());
    }
  } else if constexpr (std::is_enum_v<T>) {
    result = static_cast<T>(value.cast<std::int64_t>());
  } else {
    result = value.cast<T>();
  }
}

template <typename T>
void check_members(const T&) {}

/// \throw ArgumentError if the two differ
inline void check_equal(std::size_t a, std::size_t b) {
  if (a != b) throw ArgumentError("its arrays have different lengths");
}

/// The result of `restore(state)`.
/// \throw ArgumentError naming the class
template <typename Restore>
auto restored_from(const py::object& state, const char* name, const Restore& restore) {
  const std::string start = std::string("the state does not belong to a ") + name + ": ";
  try {
    return restore(state);
  } catch (const ArgumentError& error) {
    throw ArgumentError(start + error.what());
  } catch (const py::cast_error&) {
    throw ArgumentError(start + "it has contents of the wrong type");
  }
}

/// Make objects picklable, in every protocol, and copyable. Objects of a Python subclass keep their
/// additional attributes.
/// \param pack    a tuple of plain values for a const T&
/// \param restore a T from such a tuple
template <typename T, typename Class, typename Pack, typename Restore>
void def_pickle(Class& type, const char* name, const Pack& pack, const Restore& restore) {
  const auto get = [pack](const py::object& self) {
    const py::object more = py::getattr(self, "__dict__", py::dict());
    return py::make_tuple(pack(self.cast<const T&>()), more);
  };
  const auto set = [restore, name](const py::tuple& state) {
    if (state.size() != 2 || !py::isinstance<py::dict>(state[1]))
      throw ArgumentError(std::string("the state does not belong to a ") + name);
    return std::pair<T, py::dict>(restored_from(state[0], name, restore), state[1]);
  };
  type.def(py::pickle(get, set));
  type.def("__reduce_ex__", [](const py::object& self, const py::object&) {
    const py::object make = py::module_::import("copyreg").attr("__newobj__");
    return py::make_tuple(make, py::make_tuple(py::type::of(self)), self.attr("__getstate__")());
  });
}

/// The same for a struct of members.
template <typename T, typename Class>
void def_pickle(Class& type, const char* name) {
  def_pickle<T>(
      type, name, [](const T& value) { return packed(value); },
      [](const py::object& state) {
        T value;
        unpack(state, value);
        check_members(value);
        return value;
      });
}

/// A __reduce_ex__ for objects that can be neither pickled nor copied.
/// \param why and what to do instead
inline auto refusal(const char* why) {
  return [why](const py::object& self, const py::object&) -> py::object {
    throw py::type_error("cannot pickle or copy a " +
                         py::type::of(self).attr("__name__").cast<std::string>() + ": " + why);
  };
}

}  // namespace dapple::python

namespace dapple {

inline auto members(Samples& s) {
  return std::tie(s.positions, s.normals, s.faces, s.barycentric, s.ids, s.classes, s.fade,
                  s.report);
}
inline void check_members(const Samples& s) {
  for (const std::size_t length :
       {s.normals.size(), s.faces.size(), s.barycentric.size(), s.ids.size(), s.classes.size(),
        s.fade.empty() ? s.size() : s.fade.size()})
    python::check_equal(length, s.size());
}

}  // namespace dapple
