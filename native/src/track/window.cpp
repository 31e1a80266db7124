// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>
#include <dapple/window.hpp>
#include <optional>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/outcome.hpp"
#include "sample/timed_call.hpp"
#include "track/frame_solver.hpp"
#include "track/motion.hpp"

namespace dapple {
namespace {

double smoothstep(double t) { return t * t * (3.0 - 2.0 * t); }

bool same_places(const Samples& a, const Samples& b) {
  return a.faces == b.faces && std::memcmp(a.barycentric.data(), b.barycentric.data(),
                                           a.barycentric.size() * sizeof(Vec3)) == 0;
}

bool all_zero(const Vectors& moves) {
  return std::all_of(moves.begin(), moves.end(), [](const Vec3& v) { return v == Vec3::Zero(); });
}

/// The frames of a motion and the samples on them.
class Window {
 public:
  Window(const Surface& surface, std::span<const std::vector<Vec3>> frames, const Samples& samples,
         const WindowOptions& options, Context* context)
      : first_(surface),
        frames_(frames),
        options_(options),
        context_(context),
        solver_(
            surface,
            bind_samples(surface, samples.faces, samples.barycentric, samples.ids, samples.classes),
            options.tracker, {}, Stretch(context, 0.0, 0.0).context()) {}

  std::vector<Samples> solve(const Samples& samples) {
    const int closing = options_.closed ? 2 : 0;  // the pass backwards, and the way over to it
    steps_ = frames_.size() * static_cast<std::size_t>(1 + closing + options_.sweeps);
    samples_ = pass(samples, true);
    if (options_.closed) close(pass(samples, false));
    for (int k = 0; k < options_.sweeps; ++k) sweep(k % 2 == 1);
    for (std::size_t t = 1; t < samples_.size(); ++t) measure(t);
    return std::move(samples_);
  }

 private:
  const Surface& surface(std::size_t t) {
    if (t == 0) return first_;
    if (!has_vertices(last_asked_, frames_[t - 1])) last_asked_ = first_.deformed(frames_[t - 1]);
    return last_asked_;
  }
  [[nodiscard]] std::size_t count() const { return frames_.size() + 1; }

  /// A Tracker's samples on every frame, from the first or, around a loop, backwards from it.
  std::vector<Samples> pass(const Samples& samples, bool forwards) {
    TrackerOptions options = options_.tracker;
    options.optimizer.stickiness = 0.0;
    Stretch beginning(context_, 0.0, 0.0);
    Tracker tracker(first_, samples, options, {}, beginning.context());
    std::vector<Samples> result(count());
    result[0] = tracker.samples();
    for (std::size_t k = 1; k < count(); ++k) {
      const std::size_t t = forwards ? k : count() - k;
      Stretch step = next_step();
      result[t] = tracker.advance(frames_[t - 1], step.context());
    }
    return result;
  }

  // From the pass forwards, which has the first frame's samples at its beginning, over to the one
  // backwards, which has them at its end.
  void close(const std::vector<Samples>& backwards) {
    for (std::size_t t = 1; t < count(); ++t) {
      const double share = smoothstep(static_cast<double>(t) / static_cast<double>(count()));
      Vectors moves = difference(backwards[t].positions, samples_[t].positions);
      for (Vec3& move : moves) move *= share;
      settle(t, surface(t), moves);
    }
  }

  void sweep(bool forwards) {
    const std::size_t last = count() - 1;
    for (std::size_t k = 1; k <= last; ++k) smooth(forwards ? k : last + 1 - k);
  }

  /// To the middle between the frames before and after.
  void smooth(std::size_t t) {
    const Surface& here = surface(t);
    const Sites before = carried(here, sites_of(samples_[t - 1]));
    const bool open_end = t + 1 == count() && !options_.closed;
    const Sites after =
        open_end ? before : carried(here, sites_of(samples_[t + 1 == count() ? 0 : t + 1]));
    Vectors moves(before.size());
    for (std::size_t k = 0; k < moves.size(); ++k)
      moves[k] = 0.5 * (before.positions[k] + after.positions[k]) - samples_[t].positions[k];
    settle(t, here, moves);
  }

  /// A frame whose samples stay where they are if nobody moves them.
  struct Rest {
    Surface surface;
    Samples samples;
  };

  [[nodiscard]] bool is_at(const Rest& rest, std::size_t t) const {
    return has_vertices(rest.surface, frames_[t - 1]) && same_places(samples_[t], rest.samples);
  }

  /// Move the samples of a frame, and restore it as near to that as can be.
  void settle(std::size_t t, const Surface& here, const Vectors& moves) {
    Stretch step = next_step();
    TimedCall call(step.context());
    const Profile before = samples_[t].report.profile;
    const bool moved = !all_zero(moves);
    if (rest_ && !moved && is_at(*rest_, t)) {
      samples_[t] = rest_->samples;
      samples_[t].report.evaluations = 0;
      return call.write(samples_[t].report, before);
    }
    Samples found =
        solver_.restore(here, sites_of(samples_[t]), moves, nullptr, false, call.context()).samples;
    if (!moved && same_places(found, samples_[t])) rest_ = {here, found};
    samples_[t] = std::move(found);
    call.write(samples_[t].report, before);
  }

  void measure(std::size_t t) {
    const Sites from = carried(surface(t), sites_of(samples_[t - 1]));
    measure_slide(samples_[t].report, samples_[t].positions, from.positions);
  }

  /// A frame of one pass has the same share as any other.
  Stretch next_step() {
    if (context_) context_->check();
    return {context_, done_++, steps_};
  }

  const Surface& first_;
  Surface last_asked_ = first_;
  std::span<const std::vector<Vec3>> frames_;
  const WindowOptions& options_;
  Context* context_;
  FrameSolver solver_;
  std::vector<Samples> samples_;
  std::optional<Rest> rest_;
  std::size_t steps_ = 1;
  std::size_t done_ = 0;
};

void check_frames(const Surface& surface, std::span<const std::vector<Vec3>> frames) {
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const std::string name = entry("frames", t);
    if (frames[t].size() != surface.vertex_count())
      throw SurfaceError(name + " has " + std::to_string(frames[t].size()) +
                         " rows; the surface has " + std::to_string(surface.vertex_count()) +
                         " vertices, and a motion keeps their number");
    check_finite<SurfaceError>(name.c_str(), frames[t]);
  }
}

}  // namespace

std::vector<Samples> track_window(const Surface& surface, std::span<const std::vector<Vec3>> frames,
                                  const Samples& samples, const WindowOptions& options,
                                  Context* context) {
  check_options(options);
  check_frames(surface, frames);
  std::vector<Samples> result = with_threads(options.tracker.threads, [&] {
    return Window(surface, frames, samples, options, context).solve(samples);
  });
  if (context) context->advance(1.0);
  return result;
}

}  // namespace dapple
