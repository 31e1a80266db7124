// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/solve_window.hpp"

#include <algorithm>
#include <cstring>
#include <optional>

#include "base/progress.hpp"
#include "base/validate.hpp"
#include "sample/outcome.hpp"
#include "sample/timed_call.hpp"
#include "surface/ordered_surface.hpp"
#include "track/motion.hpp"

namespace dapple {
namespace {

double smoothstep(double t) { return t * t * (3.0 - 2.0 * t); }

bool same_places(const Samples& a, const Samples& b) {
  return a.faces == b.faces &&
         (a.faces.empty() || std::memcmp(a.barycentric.data(), b.barycentric.data(),
                                         a.barycentric.size() * sizeof(Vec3)) == 0);
}

bool all_zero(const Vectors& moves) {
  return std::all_of(moves.begin(), moves.end(), [](const Vec3& v) { return v == Vec3::Zero(); });
}

/// The frames of a motion and the samples on them.
class Window {
 public:
  Window(const MotionStart& start, const Tracker& begin, std::span<const std::vector<Vec3>> frames,
         bool closing, Context* context)
      : start_(start), begin_(begin), frames_(frames), closing_(closing), context_(context) {}

  std::vector<Samples> solve(std::span<const Samples> known) {
    const std::size_t closing = closing_ ? 2 : 0;  // the backward pass and the blend into it
    const auto sweeps = static_cast<std::size_t>(start_.options.sweeps);
    steps_ = frames_.size() * (1 + closing + sweeps);  // a known frame is copied, not tracked
    samples_ = onward(known);
    const auto ahead = static_cast<std::ptrdiff_t>(known.size()) + 1;
    const std::vector<Samples> before(samples_.begin(), samples_.begin() + ahead);
    if (closing_) close(pass(start_.tracker, false));
    for (std::size_t k = 0; k < sweeps; ++k) sweep(k % 2 == 1);
    take_over(before);
    for (std::size_t t = 1; t < samples_.size(); ++t) measure(t);
    return std::move(samples_);
  }

 private:
  const Surface& surface(std::size_t t) {
    if (t == 0) return begin_.surface();
    if (!last_asked_.ordered().has_vertices(frames_[t - 1]))
      last_asked_ = begin_.surface().deformed(frames_[t - 1]);
    return last_asked_;
  }
  [[nodiscard]] std::size_t count() const { return frames_.size() + 1; }

  /// The samples of a tracker that advances from frame to frame; known frames are kept.
  std::vector<Samples> onward(std::span<const Samples> known) {
    Tracker tracker = begin_;
    if (!known.empty()) tracker.resume(frames_[known.size() - 1], known.back(), false);
    std::vector<Samples> result = pass(std::move(tracker), true, known.size());
    result[0] = begin_.samples();
    for (std::size_t t = 1; t <= known.size(); ++t) {
      const Samples& one = known[t - 1];
      result[t] =
          bind_samples(surface(t), one.faces, one.barycentric, result[0].ids, result[0].classes);
      result[t].report = one.report;
    }
    return result;
  }

  /// The samples of a tracker on all frames after the first `without` ones, or backward around a
  /// loop.
  std::vector<Samples> pass(Tracker tracker, bool forward, std::size_t without = 0) {
    std::vector<Samples> result(count());
    result[0] = tracker.samples();
    for (std::size_t k = without + 1; k < count(); ++k) {
      const std::size_t t = forward ? k : count() - k;
      Stretch step = next_step();
      result[t] = tracker.advance(frames_[t - 1], step.context());
    }
    return result;
  }

  // Blends from the forward pass, which begins with the first frame's samples, into the backward
  // pass, which ends with them.
  void close(const std::vector<Samples>& backward) {
    for (std::size_t t = 1; t < count(); ++t)
      draw(t, backward[t].positions,
           smoothstep(static_cast<double>(t) / static_cast<double>(count())));
  }

  // Blends from the known frames into the new ones.
  void take_over(std::span<const Samples> known) {
    const auto length = static_cast<double>(known.size());
    for (std::size_t t = 1; t < known.size(); ++t)
      draw(t, known[t].positions, 1.0 - smoothstep(static_cast<double>(t) / length));
  }

  /// Move a frame's samples by a share toward alternative positions.
  void draw(std::size_t t, const Vectors& to, double share) {
    Vectors moves = difference(to, samples_[t].positions);
    for (Vec3& move : moves) move *= share;
    settle(t, surface(t), moves);
  }

  void sweep(bool forward) {
    const std::size_t last = count() - 1;
    for (std::size_t k = 1; k <= last; ++k) smooth(forward ? k : last + 1 - k);
  }

  /// Move to the middle between the previous and the next frame.
  void smooth(std::size_t t) {
    const Surface& here = surface(t);
    const Sites before = carried(here, sites_of(samples_[t - 1]));
    const bool last = t + 1 == count();
    const Samples& next = last ? start_.tracker.samples() : samples_[t + 1];
    const Sites after = last && !closing_ ? before : carried(here, sites_of(next));
    Vectors moves(before.size());
    for (std::size_t k = 0; k < moves.size(); ++k)
      moves[k] = 0.5 * (before.positions[k] + after.positions[k]) - samples_[t].positions[k];
    settle(t, here, moves);
  }

  /// A frame whose samples are not moved by its surface.
  struct Rest {
    Surface surface;
    Samples samples;
  };

  [[nodiscard]] bool is_at(const Rest& rest, std::size_t t) const {
    return rest.surface.ordered().has_vertices(frames_[t - 1]) &&
           same_places(samples_[t], rest.samples);
  }

  /// Move the samples of a frame and restore its evenness close to these positions.
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
        start_.solver.restore(here, sites_of(samples_[t]), moves, nullptr, false, call.context())
            .samples;
    if (!moved && same_places(found, samples_[t])) rest_ = {here, found};
    samples_[t] = std::move(found);
    call.write(samples_[t].report, before);
  }

  void measure(std::size_t t) {
    const Sites from = carried(surface(t), sites_of(samples_[t - 1]));
    measure_slide(samples_[t].report, samples_[t].positions, from.positions);
  }

  /// The share of the progress of the next frame; each frame of each pass has the same share.
  Stretch next_step() {
    if (context_) context_->check();
    return {context_, done_++, steps_};
  }

  const MotionStart& start_;
  const Tracker& begin_;
  Surface last_asked_ = begin_.surface();
  std::span<const std::vector<Vec3>> frames_;
  bool closing_;
  Context* context_;
  std::vector<Samples> samples_;
  std::optional<Rest> rest_;
  std::size_t steps_ = 1;
  std::size_t done_ = 0;
};

TrackerOptions without_stickiness(TrackerOptions options) {
  options.optimizer.stickiness = 0.0;
  return options;
}

}  // namespace

MotionStart::MotionStart(const Surface& surface, const Samples& samples, const WindowOptions& given,
                         Context* context)
    : options(given),
      tracker(surface, samples, without_stickiness(given.tracker),
              Stretch(context, 0.0, 0.0).context()),
      solver(surface, tracker.samples(), given.tracker, Stretch(context, 0.0, 0.0).context()) {}

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

std::vector<Samples> solve_window(const MotionStart& start, const Tracker& begin,
                                  std::span<const std::vector<Vec3>> frames,
                                  std::span<const Samples> known, bool closing, Context* context) {
  return Window(start, begin, frames, closing, context).solve(known);
}

}  // namespace dapple
