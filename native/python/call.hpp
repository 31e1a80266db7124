// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <dapple/context.hpp>
#include <dapple/errors.hpp>
#include <memory>

namespace dapple::python {

namespace py = pybind11;

/// While it lives, other Python threads run. Where the interpreter has ended meanwhile, the thread
/// of a daemon waits for the end of the process: it could not run Python any more.
class WithoutGil {
 public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* state_;
};

/// One call of the library that may take long, made with the GIL held. Ctrl-C and the end of the
/// interpreter stop it.
class Call {
 public:
  /// \param watched the caller's Context, or null; its cancel() stops what is not given it too
  explicit Call(const std::shared_ptr<Context>& watched);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// What `work()` returns, done while other Python threads run.
  /// \throw py::error_already_set for what a signal's handler raised, as KeyboardInterrupt
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
  bool in_main_thread_;                                // only there Python serves signals
  py::object error_type_, error_value_, error_trace_;  // of a signal's handler
  Poll poll_;
};

/// What `work(context)` returns, see Call; it gets a Context in any case.
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
