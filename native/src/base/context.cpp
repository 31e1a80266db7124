// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/context.hpp>
#include <dapple/errors.hpp>

namespace dapple {
namespace {

constexpr std::chrono::milliseconds kPollInterval{20};

thread_local Poll* of_this_thread = nullptr;

void raise(std::atomic<double>& progress, double value) {
  double seen = progress.load();
  while (value > seen && !progress.compare_exchange_weak(seen, value)) {
  }
}

}  // namespace

Poll::Poll(std::function<bool()> go_on)
    : go_on_(std::move(go_on)), next_(Clock::now() + kPollInterval), before_(of_this_thread) {
  of_this_thread = this;
}

Poll::~Poll() { of_this_thread = before_; }

Poll* Poll::current() { return of_this_thread; }

Poll::Share::Share(Poll* poll) : before_(of_this_thread) { of_this_thread = poll; }
Poll::Share::~Share() { of_this_thread = before_; }

void Poll::ask() {
  if (asking_ || Clock::now() < next_) return;
  asking_ = true;
  if (!go_on_()) stop();
  asking_ = false;
  next_ = Clock::now() + kPollInterval;
}

void Poll::check() {
  if (go_on_ && std::this_thread::get_id() == thread_) ask();
  if (stopped_.load()) throw Cancelled();
}

void Context::cancel() {
  Context* top = this;
  while (top->whole_) top = top->whole_;
  top->cancelled_.store(true);
}

bool Context::cancelled() const {
  const Context* top = this;
  while (top->whole_) top = top->whole_;
  return top->cancelled_.load();
}

void Context::advance(double value) {
  if (std::isnan(value)) return;
  double done = std::min(value, 1.0);
  for (Context* part = this; part; part = part->whole_) {
    raise(part->progress_, done);
    done = done < 1.0 ? part->from_ + done * (part->to_ - part->from_) : part->to_;
  }
}

void Context::check() const {
  if (Poll* const poll = Poll::current()) poll->check();
  if (cancelled()) throw Cancelled();
}

}  // namespace dapple
