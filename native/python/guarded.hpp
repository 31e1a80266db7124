// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace dapple::python {

namespace py = pybind11;

/// An object that its calls change while other Python threads run. One call at a time uses it, and
/// another one is refused; waiting would never end if a signal handler made the other call. The GIL
/// is held meanwhile, so a flag suffices.
template <class Object>
class Guarded {
 public:
  template <class... Arguments>
  explicit Guarded(Arguments&&... arguments) : object_(std::forward<Arguments>(arguments)...) {}

  /// For readers that keep the GIL.
  /// \throw std::runtime_error if a call is changing it
  [[nodiscard]] const Object& read() const {
    if (user_) refuse();
    return object_;
  }

  /// Exclusive use of the object during its lifetime.
  class Change {
   public:
    /// \throw std::runtime_error if a call is changing it
    explicit Change(Guarded& guarded) : guarded_(guarded) {
      if (guarded_.user_) guarded_.refuse();
      guarded_.user_ = PyThread_get_thread_ident();
    }
    ~Change() { guarded_.user_.reset(); }
    Change(const Change&) = delete;
    Change& operator=(const Change&) = delete;

    Object& operator*() const { return guarded_.object_; }
    Object* operator->() const { return &guarded_.object_; }

   private:
    Guarded& guarded_;
  };

 private:
  [[noreturn]] void refuse() const {
    const auto name = py::type::of<Guarded>().attr("__name__").template cast<std::string>();
    throw std::runtime_error("the " + name + " is in use by " +
                             (user_ == PyThread_get_thread_ident()
                                  ? "a call of this thread that has not ended"
                                  : "another thread, whose call has not ended"));
  }

  Object object_;
  std::optional<unsigned long> user_;  // the thread whose call is changing it
};

}  // namespace dapple::python
