// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <dapple/context.hpp>
#include <dapple/errors.hpp>
#include <memory>

namespace dapple::python {

namespace py = pybind11;

/// Releases the GIL during its lifetime. If the interpreter has ended in the meantime, a daemon
/// thread waits for the end of the process, because it can no longer run Python.
class WithoutGil {
 public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* state_;
};

/// A call of the library that may take long. It is created with the GIL held; Ctrl-C and the end of
/// the interpreter stop it.
class Call {
 public:
  /// \param watched the caller's Context, or null; its cancel() also stops work that does not
  /// receive it
  explicit Call(const std::shared_ptr<Context>& watched);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// Calls `work()` with the GIL released and returns its result.
  /// \throw py::error_already_set for an exception raised by a signal handler, such as
  /// KeyboardInterrupt
  template <typename Work>
  auto run(const Work& work) {
    try {
      const WithoutGil released;
      return work();
    } catch (const Cancelled&) {
      raise_interrupt();
      throw;
    }
  }

 private:
  bool go_on();
  bool serve_signals();
  void raise_interrupt();

  std::shared_ptr<Context> watched_;
  bool in_main_thread_;                                // Python handles signals only there
  py::object error_type_, error_value_, error_trace_;  // raised by a signal handler
  Poll poll_;
};

/// The result of `work(context)`, see Call. The context is never null.
/// \param watched the caller's Context, or null
template <typename Work>
auto run(const std::shared_ptr<Context>& watched, const Work& work) {
  Context own;
  return Call(watched).run([&] { return work(watched ? watched.get() : &own); });
}

template <typename Work>
auto run(const Work& work) {
  return Call(nullptr).run(work);
}

/// At the end of the interpreter, stop the calls of daemon threads and wait for them.
void stop_calls_at_exit();

}  // namespace dapple::python
