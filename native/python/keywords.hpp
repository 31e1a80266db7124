// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/errors.hpp>
#include <initializer_list>
#include <string>

#include "bindings.hpp"
#include "option_rows.hpp"

namespace dapple::python {

/// \throw TypeError, ArgumentError naming the argument, if its value is not allowed
void read(const char* name, const Range& range, const py::handle& value, double& number);
void read(const char* name, const Range& range, const py::handle& value, bool& flag);

/// \throw TypeError naming an argument of the wrong type
[[noreturn]] void refuse_type(const std::string& name, const py::handle& value,
                              const std::string& needed);

template <WholeNumber Number>
void read(const char* name, const Range& range, const py::handle& value, Number& result) {
  const py::object number = whole_number(value);
  if (!number) refuse_type(name, value, "a whole number");
  result = static_cast<Number>(bounded(name, number, static_cast<std::int64_t>(range.min),
                                       static_cast<std::uint64_t>(largest<Number>(range))));
}

template <class Enum>
  requires std::is_enum_v<Enum>
void read(const char* name, const Range&, const py::handle& value, Enum& result) {
  if (!py::isinstance<py::str>(value)) refuse_type(name, value, "text");
  const auto text = value.cast<std::string>();
  std::string known;
  for (const Choice<Enum>& choice : choices_of(result)) {
    if (choice.name == text) {
      result = choice.value;
      return;
    }
    known += (known.empty() ? "'" : " or '") + std::string(choice.name) + "'";
  }
  throw ArgumentError(std::string(name) + " is '" + text + "': it must be " + known);
}

/// The keyword arguments of a verb.
template <class Struct>
class Keywords {
 public:
  /// \param others names of arguments that are not options
  /// \throw TypeError for an unknown name
  Keywords(const Verb<Struct>& verb, const py::kwargs& given,
           std::initializer_list<const char*> others = {"context"})
      : verb_(verb), given_(given) {
    for (const auto& [key, value] : given) {
      const auto name = key.template cast<std::string>();
      if (is_option(name)) continue;
      if (std::none_of(others.begin(), others.end(), [&](const char* o) { return name == o; }))
        throw py::type_error(std::string(verb.name) + "() got an unexpected keyword argument '" +
                             name + "'");
    }
  }

  /// The options: the defaults with the given values.
  /// \throw TypeError, ArgumentError naming the argument
  [[nodiscard]] Struct options() const {
    Struct result;
    for_each_option(result, [&](const auto& option, auto& value) {
      if (verb_.takes(option.name, option.level) && given_.contains(option.name))
        set(option, value);
    });
    return result;
  }

  /// An argument that is not an option; None if it is not given.
  [[nodiscard]] py::object other(const char* name) const {
    return given_.contains(name) ? py::object(given_[name]) : py::none();
  }

  /// An argument that is not an option, as an object of a bound class; null if it is None or not
  /// given.
  /// \throw TypeError naming the argument
  template <class Class>
  [[nodiscard]] std::shared_ptr<Class> object(const char* name) const {
    const py::object value = other(name);
    if (value.is_none()) return nullptr;
    if (!py::isinstance<Class>(value))
      refuse_type(
          name, value,
          "a " + py::type::of<Class>().attr("__name__").template cast<std::string>() + " or None");
    return value.cast<std::shared_ptr<Class>>();
  }

  [[nodiscard]] ContextPtr context() const { return object<SharedContext>("context"); }

 private:
  template <class Owner, class Member>
  void set(const Option<Owner, Member>& option, Member& value) const {
    read(option.name, option.range, given_[option.name], value);
  }

  [[nodiscard]] bool is_option(const std::string& name) const {
    bool found = false;
    const Struct defaults;
    for_each_option(defaults, [&](const auto& option, const auto&) {
      found = found || (name == option.name && verb_.takes(option.name, option.level));
    });
    return found;
  }

  const Verb<Struct>& verb_;
  const py::kwargs& given_;
};

/// A docstring with {signature} and {options} replaced: the options as in a signature, and as a
/// list for "Args:".
[[nodiscard]] std::string documented(const std::vector<Row>& rows, std::string text);

template <class Struct>
[[nodiscard]] std::string documented(const Verb<Struct>& verb, const char* text) {
  return documented(rows_of(verb), text);
}

/// Bind a function whose last argument is py::kwargs. Its docstring begins with its signature,
/// because Python cannot derive it.
template <class Struct, class Function, class... Arguments>
void def_verb(py::module_& m, const Verb<Struct>& verb, const Function& function, const char* text,
              const Arguments&... arguments) {
  py::options plain;
  plain.disable_function_signatures();
  m.def(verb.name, function, arguments..., documented(verb, text).c_str());
}

/// The same for the constructor of a class.
template <class Struct, class Class, class Function, class... Arguments>
void def_init(Class& type, const Verb<Struct>& verb, const Function& function,
              const char* signature, const Arguments&... arguments) {
  py::options plain;
  plain.disable_function_signatures();
  type.def(py::init(function), arguments..., documented(verb, signature).c_str());
}

}  // namespace dapple::python
