// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/class_start.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/morton.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "start/dart_board.hpp"
#include "start/dart_set.hpp"
#include "start/thin_part.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

// Random sequential packing ends at 0.776 of the hexagonal spacing, and the last darts before that
// take very long.
constexpr double kFirstRadius = 0.76;
constexpr double kShrink = 0.96;
constexpr std::size_t kPatience = 4;     // darts per wanted sample at one radius
constexpr double kFillingTime = 4.0;     // the time to fill a share x grows like x to this power
constexpr std::size_t kLeastBatch = 64;  // darts thrown together, at least
constexpr std::size_t kLargestBatch = 8192;  // at most; a batch may take 10 ms
constexpr std::size_t kGrain = 256;          // darts per chunk
constexpr double kUnion = 0.85;      // distance to darts of any class, in spacings of the union
constexpr double kSizesYield = 0.4;  // fraction of the first radius below which discs shrink too

/// Points with the density n phi / capacity have the hexagonal spacing sqrt(2 capacity / (sqrt(3) n
/// phi)); this is its value at phi = 1.
double spacing_at_1(const Surface& surface, std::size_t count) {
  return surface.spacing(count) * std::sqrt(surface.capacity() / surface.area());
}

std::vector<Dart> darts_at(const Surface& surface, const Sites& sites) {
  std::vector<Dart> result;
  for (std::size_t k = 0; k < sites.size(); ++k)
    result.push_back(
        dart_at(surface, surface.ordered().ordered_face(sites.faces[k]), sites.barycentric[k]));
  return result;
}

/// Append the darts of a class: locked ones first, the others in spatial order, so that neighbors
/// are close in memory.
void add(const ClassStart& wanted, std::span<const Dart> darts, Sites& sites) {
  const std::size_t first = wanted.locked.size();
  std::vector<Vec3> thrown;
  for (const Dart& dart : darts.subspan(first)) thrown.push_back(dart.position);
  std::vector<std::int32_t> order(first);
  std::iota(order.begin(), order.end(), 0);
  for (const std::int32_t k : morton_order(thrown))
    order.push_back(static_cast<std::int32_t>(first) + k);
  for (const std::int32_t k : order) {
    const Dart& dart = darts[static_cast<std::size_t>(k)];
    sites.positions.push_back(dart.position);
    sites.faces.push_back(wanted.surface->ordered().original_face(dart.face));
    sites.barycentric.push_back(dart.barycentric);
  }
}

/// The darts of one class.
struct ClassDarts {
  ClassDarts(const ClassStart& wanted, double period)
      : start(&wanted),
        darts(darts_at(*wanted.surface, wanted.locked)),
        board(*wanted.surface, wanted.count, darts),
        near(period),
        discs(std::max(2.0 * wanted.radius, 1e-300), period),
        spacing(spacing_at_1(*wanted.surface, wanted.count)) {}

  [[nodiscard]] bool full() const { return darts.size() >= start->count; }
  [[nodiscard]] double filled() const {
    return static_cast<double>(darts.size()) / static_cast<double>(start->count);
  }

  const ClassStart* start;
  std::vector<Dart> darts;
  DartBoard board;
  DartSet near;    // darts of the same class
  DartGrid discs;  // the darts as discs of the class's radius
  double spacing;
};

class Throwing {
 public:
  Throwing(const ClassStarts& starts, Context* context)
      : starts_(starts),
        context_(context),
        random_(starts.seed),
        fresh_(starts.period),
        any_(starts.period) {
    for (const ClassStart& wanted : starts.classes) {
      classes_.emplace_back(wanted, starts.period);
      count_ += wanted.count;
    }
    spacing_ = spacing_at_1(*starts.all, count_);
    for (ClassDarts& members : classes_)
      for (const Dart& dart : members.darts) note(members, dart, kFirstRadius);
  }

  [[nodiscard]] std::size_t along() const { return along_; }

  Sites run() {
    double done = 0.0;
    for (const std::vector<ClassDarts*>& group : by_size()) {
      const double before = std::exchange(done, done + share_of(group));
      Stretch filling(context_, before, std::min(done, 1.0));
      fill(group, filling.context());
    }
    if (starts_.period == 0.0) lay_along();
    if (context_) context_->advance(1.0);
    Sites sites;
    for (const ClassDarts& members : classes_) add(*members.start, members.darts, sites);
    return sites;
  }

 private:
  struct Drawn {
    Random before{0};  // the random state before this draw
    DartBoard::Draw draw{};
    Dart dart{};
    bool refused = false;
  };

  /// The classes grouped by radius, the largest first.
  std::vector<std::vector<ClassDarts*>> by_size() {
    std::vector<ClassDarts*> sorted;
    for (ClassDarts& members : classes_)
      if (!members.full()) sorted.push_back(&members);
    std::stable_sort(sorted.begin(), sorted.end(), [](const ClassDarts* a, const ClassDarts* b) {
      return a->start->radius > b->start->radius;
    });
    std::vector<std::vector<ClassDarts*>> groups;
    for (ClassDarts* members : sorted) {
      if (groups.empty() || groups.back()[0]->start->radius != members->start->radius)
        groups.emplace_back();
      groups.back().push_back(members);
    }
    return groups;
  }

  [[nodiscard]] static std::size_t count_of(const std::vector<ClassDarts*>& group) {
    std::size_t count = 0;
    for (const ClassDarts* members : group) count += members->start->count;
    return count;
  }

  [[nodiscard]] double share_of(const std::vector<ClassDarts*>& group) const {
    return static_cast<double>(count_of(group)) / static_cast<double>(count_);
  }

  static void report(const std::vector<ClassDarts*>& group, std::size_t count, Context* context) {
    if (!context) return;
    context->check();
    std::size_t there = 0;
    for (const ClassDarts* members : group) there += members->darts.size();
    context->advance(
        std::pow(static_cast<double>(there) / static_cast<double>(count), kFillingTime));
  }

  void fill(const std::vector<ClassDarts*>& group, Context* context) {
    const std::size_t count = count_of(group);
    for (double fraction = kFirstRadius;; fraction *= kShrink) {
      for (std::size_t thrown = 0; thrown < kPatience * count;) {
        report(group, count, context);
        thrown += throw_some(group, fraction, kPatience * count - thrown);
        if (!least_filled(group)) return;
      }
      for (ClassDarts* members : group) members->near.scale(kShrink);
      if (many()) any_.scale(kShrink);
    }
  }

  /// Place the darts of components that may be thinner than the spacing at equal distances along
  /// them, because their minimum distance is too small to make random darts even there.
  void lay_along() {
    Random random(starts_.seed);
    for (std::size_t c = 0; c < classes_.size(); ++c) {
      ClassDarts& members = classes_[c];
      const double phase = (static_cast<double>(c) + 0.5) / static_cast<double>(classes_.size());
      along_ += lay_along_thin_parts(*members.start->surface, members.spacing,
                                     members.start->locked.size(), phase, random, members.darts,
                                     context_);
    }
  }

  static ClassDarts* least_filled(const std::vector<ClassDarts*>& group) {
    ClassDarts* best = nullptr;
    for (ClassDarts* members : group)
      if (!members->full() && (!best || members->filled() < best->filled())) best = members;
    return best;
  }

  /// Throw at most `most` darts and return their number. If classes take turns, the class of the
  /// next dart depends on whether the last one was kept.
  std::size_t throw_some(const std::vector<ClassDarts*>& group, double fraction, std::size_t most) {
    if (group.size() == 1) return throw_batch(*group[0], fraction, most);
    most = std::min(most, kLeastBatch);
    for (std::size_t thrown = 0; thrown < most; ++thrown) {
      ClassDarts* members = least_filled(group);
      if (!members) return thrown;
      const Dart dart = dart_on(*members, members->board.draw(random_));
      if (is_refused(members->near, *members, dart, fraction)) continue;
      members->board.take(dart);
      keep(*members, dart, fraction);
    }
    return most;
  }

  /// The result is the same as with one dart at a time. Most darts are refused because of earlier
  /// ones; these are found in parallel. The others are then compared with those kept from the
  /// batch.
  std::size_t throw_batch(ClassDarts& members, double fraction, std::size_t most) {
    draw(members, std::min(most, batch_));
    test(members, fraction);
    fresh_.clear();
    for (std::size_t k = 0; k < drawn_.size(); ++k) {
      const Drawn& drawn = drawn_[k];
      if (drawn.refused || is_refused(fresh_, members, drawn.dart, fraction)) continue;
      const bool closed = members.board.take(drawn.dart);
      keep(members, drawn.dart, fraction);
      fresh_.insert(drawn.dart, own_radius(members, drawn.dart, fraction));
      if (!closed && !members.full()) continue;
      // Later draws are invalid because the board has changed.
      if (k + 1 < drawn_.size()) random_ = drawn_[k + 1].before;
      batch_ = std::max(k + 1, kLeastBatch);
      return k + 1;
    }
    batch_ = std::min(2 * batch_, kLargestBatch);
    return drawn_.size();
  }

  void draw(const ClassDarts& members, std::size_t count) {
    drawn_.resize(count);
    if (members.start->surface->uniform() && draw_at_once(members)) return;
    for (Drawn& drawn : drawn_) {
      drawn.before = random_;
      drawn.draw = members.board.draw(random_);
    }
  }

  /// Draw in parallel. The random state of each draw is known unless a draw is rejected. Returns
  /// false if one was rejected.
  bool draw_at_once(const ClassDarts& members) {
    constexpr std::uint64_t kNumbers = DartBoard::kNumbers;
    std::atomic<bool> rejected = false;
    parallel_chunks(drawn_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Random random = drawn_[k].before = random_.after(kNumbers * k);
        drawn_[k].draw = members.board.draw(random);
        if (random != drawn_[k].before.after(kNumbers)) rejected = true;
      }
    });
    if (!rejected) random_ = random_.after(kNumbers * drawn_.size());
    return !rejected;
  }

  void test(const ClassDarts& members, double fraction) {
    parallel_chunks(drawn_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<DartGrid::Asked> asked;
      for (std::size_t k = begin; k < end; ++k) {
        drawn_[k].dart = dart_on(members, drawn_[k].draw);
        asked.push_back({&drawn_[k].dart, own_radius(members, drawn_[k].dart, fraction)});
      }
      members.near.refuse(asked);
      for (std::size_t k = begin; k < end; ++k)
        drawn_[k].refused =
            asked[k - begin].refused || is_refused_by_others(members, drawn_[k].dart, fraction);
    });
  }

  static Dart dart_on(const ClassDarts& members, const DartBoard::Draw& draw) {
    return dart_at(*members.start->surface, draw.face, draw.weights);
  }

  /// Whether a dart is too close to other darts. `own` holds the darts of its class, all of them or
  /// those kept from the batch.
  [[nodiscard]] bool is_refused(const DartSet& own, const ClassDarts& members, const Dart& dart,
                                double fraction) const {
    return own.refuses(dart, own_radius(members, dart, fraction)) ||
           is_refused_by_others(members, dart, fraction);
  }

  /// Whether a dart is too close to darts of other classes or of the union.
  [[nodiscard]] bool is_refused_by_others(const ClassDarts& members, const Dart& dart,
                                          double fraction) const {
    if (many() && any_.refuses(dart, union_radius(dart, fraction))) return true;
    return overlaps(members, dart, std::min(1.0, fraction / kSizesYield));
  }

  void keep(ClassDarts& members, const Dart& dart, double fraction) {
    members.darts.push_back(dart);
    note(members, dart, fraction);
  }

  void note(ClassDarts& members, const Dart& dart, double fraction) {
    if (!(dart.density > 0.0)) return;  // a locked site where there is no density
    members.near.insert(dart, own_radius(members, dart, fraction));
    if (many()) any_.insert(dart, union_radius(dart, fraction));
    if (members.start->radius > 0.0) members.discs.insert(dart, members.start->radius);
  }

  // All discs in the grid are at least as large, so cells of twice their radius are wide enough.
  [[nodiscard]] bool overlaps(const ClassDarts& members, const Dart& dart, double yield) const {
    const double own = members.start->radius;
    const auto reach = [&](const DartGrid::Member& other) {
      return on_one_side(dart, other) ? yield * (other.radius + own) : 0.0;
    };
    return std::any_of(classes_.begin(), classes_.end(), [&](const ClassDarts& others) {
      const double radius = others.start->radius;
      return radius > 0.0 && radius >= own &&
             others.discs.refuses(dart, yield * (radius + own), reach);
    });
  }

  static double own_radius(const ClassDarts& members, const Dart& dart, double fraction) {
    return fraction * members.spacing / std::sqrt(dart.density);
  }

  [[nodiscard]] double union_radius(const Dart& dart, double fraction) const {
    const double density = dart.barycentric.dot(starts_.all->ordered().densities(dart.face));
    return kUnion * fraction * spacing_ / std::sqrt(density);
  }

  [[nodiscard]] bool many() const { return classes_.size() > 1; }

  const ClassStarts& starts_;
  Context* context_;
  Random random_;
  std::vector<Drawn> drawn_;  // draws of the current batch
  std::size_t batch_ = kLeastBatch;
  std::vector<ClassDarts> classes_;
  DartSet fresh_;  // darts that the batch has kept so far
  DartSet any_;    // darts of all classes
  double spacing_;
  std::size_t count_ = 0;
  std::size_t along_ = 0;  // darts on thin parts
};

}  // namespace

Sites random_start(const ClassStarts& starts) {
  Random random(starts.seed);
  Sites sites;
  for (const ClassStart& wanted : starts.classes) {
    std::vector<Dart> darts = darts_at(*wanted.surface, wanted.locked);
    DartBoard board(*wanted.surface, wanted.count, darts);
    while (darts.size() < wanted.count) {
      const DartBoard::Draw draw = board.draw(random);
      darts.push_back(dart_at(*wanted.surface, draw.face, draw.weights));
      board.take(darts.back());
    }
    add(wanted, darts, sites);
  }
  return sites;
}

Sites poisson_start(const ClassStarts& starts, Context* context, std::size_t* along) {
  Throwing throwing(starts, context);
  Sites sites = throwing.run();
  if (along) *along = throwing.along();
  return sites;
}

}  // namespace dapple
