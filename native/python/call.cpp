// SPDX-License-Identifier: GPL-3.0-or-later
#include "call.hpp"

#ifdef __GLIBCXX__
#include <cxxabi.h>
#endif

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>
#include <vector>

namespace dapple::python {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestWait = 5s;  // at exit, for calls that were stopped

// The running calls, and whether new ones are refused. Both change only while the GIL is held.
std::vector<Poll*> running;
bool closing = false;

[[noreturn]] void wait_for_the_end() {
  for (;;) std::this_thread::sleep_for(1h);
}

/// Python before 3.14 ends a thread that returns after the interpreter has ended, without running
/// our destructors; such a thread waits instead.
void take_gil(PyThreadState* state) {
#ifdef __GLIBCXX__
  try {
    PyEval_RestoreThread(state);
  } catch (abi::__forced_unwind&) {
    wait_for_the_end();
  }
#else
  PyEval_RestoreThread(state);
#endif
}

bool in_main_thread() {
  static const py::handle kMainThread =
      py::object(py::module_::import("threading").attr("main_thread")).release();
  return kMainThread().attr("ident").cast<unsigned long>() == PyThread_get_thread_ident();
}

void stop_calls() {
  closing = true;
  const auto last = std::chrono::steady_clock::now() + kLongestWait;
  while (!running.empty() && std::chrono::steady_clock::now() < last) {
    for (Poll* poll : running) poll->stop();
    const WithoutGil released;
    std::this_thread::sleep_for(1ms);
  }
}

}  // namespace

WithoutGil::~WithoutGil() { take_gil(state_); }

Call::Call(const std::shared_ptr<Context>& watched)
    : watched_(watched), in_main_thread_(in_main_thread()), poll_([this] { return go_on(); }) {
  if (closing) poll_.stop();
  running.push_back(&poll_);
}

Call::~Call() { std::erase(running, &poll_); }

bool Call::go_on() {
  if (watched_ && watched_->cancelled()) return false;
  return !in_main_thread_ || serve_signals();
}

bool Call::serve_signals() {
  const py::gil_scoped_acquire held;
  if (PyErr_CheckSignals() == 0) return true;
  PyErr_Fetch(&error_type_.ptr(), &error_value_.ptr(), &error_trace_.ptr());
  return false;
}

void Call::raise_interrupt() {
  if (!error_type_) return;
  PyErr_Restore(error_type_.release().ptr(), error_value_.release().ptr(),
                error_trace_.release().ptr());
  throw py::error_already_set();
}

void stop_calls_at_exit() {
  py::module_::import("atexit").attr("register")(py::cpp_function(stop_calls));
  const py::module_ os = py::module_::import("os");
  if (!py::hasattr(os, "register_at_fork")) return;
  const py::cpp_function forget([] { running.clear(); });  // the child process has no other threads
  os.attr("register_at_fork")(py::arg("after_in_child") = forget);
}

}  // namespace dapple::python
