// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/neighbors.hpp>
#include <dapple/progressive.hpp>
#include <numeric>
#include <queue>
#include <utility>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/sort_unique.hpp"
#include "base/validate.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 512;
constexpr double kSpaced = 0.15;  // share of the progress when the points' spacings are known
constexpr double kLinked = 0.6;   // share of the progress of a level when its points are linked
constexpr std::size_t kRing = 6;  // neighbors in a hexagonal lattice

using Indices = std::vector<std::int32_t>;

std::size_t at(std::int32_t k) { return static_cast<std::size_t>(k); }

struct Link {
  std::int32_t other;
  double weight;
};

/// Points to be ordered evenly: all points or those of a class.
class Layer {
 public:
  Layer(std::span<const Vec3> all, Indices members, Context* context)
      : all_(all), members_(std::move(members)) {
    const std::vector<Vec3> places = places_of(members_);
    const Neighbors tree(places);
    spacing_.resize(members_.size());
    Tally tally(context, members_.size());
    parallel_chunks(members_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      tally.check();
      std::vector<Neighbor> ring;
      for (std::size_t k = begin; k < end; ++k) {
        tree.nearest(places[k], kRing + 1, ring);  // the first is the point itself
        double sum = 0.0;
        for (const Neighbor& one : ring) sum += std::sqrt(one.squared_distance);
        spacing_[k] = sum / static_cast<double>(std::max<std::size_t>(ring.size(), 2) - 1);
      }
      tally.add(end - begin);
    });
  }

  /// Link each point to the points that are nearer than the spacing of the layer with only the
  /// share `left` of its points. The weight is (1 - distance / spacing)^8, as in weighted sample
  /// elimination, summed for the spacings of both points.
  void link(const std::vector<std::uint8_t>& alive, double left,
            std::vector<std::vector<Link>>& links, Context* context) const {
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (alive[at(members_[k])]) kept.push_back(k);
    Indices who;
    for (const std::size_t k : kept) who.push_back(members_[k]);
    const std::vector<Vec3> places = places_of(who);
    const Neighbors tree(places);
    std::vector<std::vector<Link>> found(kept.size());
    Tally tally(context, kept.size());
    parallel_chunks(kept.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      tally.check();
      std::vector<Neighbor> near;
      for (std::size_t k = begin; k < end; ++k) {
        const double radius = spacing_[kept[k]] / std::sqrt(left);
        tree.within(places[k], radius, near);
        for (const Neighbor& one : near)
          if (at(one.index) != k)
            found[k].push_back(
                {who[at(one.index)], closeness(std::sqrt(one.squared_distance) / radius)});
      }
      tally.add(end - begin);
    });
    for (std::size_t k = 0; k < kept.size(); ++k) {
      check_at(context, k, kGrain);
      for (const Link& one : found[k]) {
        links[at(who[k])].push_back(one);
        links[at(one.other)].push_back({who[k], one.weight});
      }
    }
  }

  [[nodiscard]] std::size_t size() const { return members_.size(); }

 private:
  /// (1 - part)^8
  static double closeness(double part) {
    const double square = (1.0 - part) * (1.0 - part);
    return square * square * (square * square);
  }

  [[nodiscard]] std::vector<Vec3> places_of(const Indices& who) const {
    std::vector<Vec3> places;
    places.reserve(who.size());
    for (const std::int32_t one : who) places.push_back(all_[at(one)]);
    return places;
  }

  std::span<const Vec3> all_;
  Indices members_;
  std::vector<double> spacing_;  // of each member: mean distance to its nearest neighbors
};

/// Chooses the class of the next point so that all classes keep their shares.
class Shares {
 public:
  explicit Shares(const std::vector<Indices>& classes) {
    for (const Indices& one : classes) total_ += one.size();
    for (const Indices& one : classes) size_.push_back(one.size());
    left_ = size_;
    remaining_ = total_;
  }

  /// The class that exceeds its share most when one point fewer remains.
  std::size_t take() {
    --remaining_;
    std::size_t chosen = 0;
    double most = -1e300;
    for (std::size_t c = 0; c < size_.size(); ++c) {
      const double share = static_cast<double>(size_[c]) * static_cast<double>(remaining_) /
                           static_cast<double>(total_);
      const double above = static_cast<double>(left_[c]) - share;
      if (left_[c] == 0 || above <= most) continue;
      most = above;
      chosen = c;
    }
    --left_[chosen];
    return chosen;
  }

 private:
  std::vector<std::size_t> size_, left_;
  std::size_t total_ = 0, remaining_ = 0;
};

/// The remaining points, and the choice of the next one to remove.
class Elimination {
 public:
  Elimination(std::span<const Vec3> points, const std::vector<Indices>& classes,
              const Indices& class_of, Context* context)
      : class_of_(class_of), shares_(classes), alive_(points.size(), 1), ranks_(points.size()) {
    Indices all(points.size());
    std::iota(all.begin(), all.end(), 0);
    const auto sets = static_cast<double>(classes.size() > 1 ? 2 * points.size() : points.size());
    double done = 0.0;
    const auto add = [&](Indices members) {
      const double before =
          std::exchange(done, done + kSpaced * static_cast<double>(members.size()) / sets);
      Stretch step(context, before, done);
      layers_.emplace_back(points, std::move(members), step.context());
    };
    add(std::move(all));
    if (classes.size() > 1)
      for (const Indices& one : classes) add(one);
    left_ = points.size();
  }

  Indices run(Context* context) && {
    // Radii grow with the gaps, so neighbors are searched again whenever half of the points are
    // removed.
    while (left_ > 0) {
      const std::size_t first = left_, target = left_ / 2;
      Stretch level(context, progress_at(first), progress_at(target));
      Stretch linking(level.context(), 0.0, kLinked), removing(level.context(), kLinked, 1.0);
      begin_level(target, linking.context());
      for (; left_ > target; remove(next()))
        report_at(removing.context(), first - left_, first - target, kGrain);
    }
    return std::move(ranks_);
  }

 private:
  struct Entry {
    double weight;
    std::int32_t point;
    bool operator<(const Entry& other) const {
      return weight != other.weight ? weight < other.weight : point > other.point;
    }
  };

  /// Removing half of the points takes half as long as removing the half before.
  [[nodiscard]] double progress_at(std::size_t left) const {
    return 1.0 - (1.0 - kSpaced) * static_cast<double>(left) / static_cast<double>(alive_.size());
  }

  void begin_level(std::size_t target, Context* context) {
    const double share =
        static_cast<double>(std::max<std::size_t>(target, 1)) / static_cast<double>(alive_.size());
    links_.assign(alive_.size(), {});
    std::size_t sets = 0, done = 0;
    for (const Layer& layer : layers_) sets += layer.size();
    for (const Layer& layer : layers_) {
      const std::size_t before = std::exchange(done, done + layer.size());
      Stretch step(context, static_cast<double>(before) / static_cast<double>(sets),
                   static_cast<double>(done) / static_cast<double>(sets));
      layer.link(alive_, share, links_, step.context());
    }
    weights_.assign(alive_.size(), 0.0);
    queues_.assign(layers_.size() > 1 ? layers_.size() - 1 : 1, {});
    for (std::size_t k = 0; k < alive_.size(); ++k) {
      check_at(context, k);
      if (!alive_[k]) continue;
      for (const Link& one : links_[k]) weights_[k] += one.weight;
      enter(static_cast<std::int32_t>(k));
    }
  }

  void enter(std::int32_t point) {
    queues_[at(class_of_[at(point)])].push({weights_[at(point)], point});
  }

  std::int32_t next() {
    std::priority_queue<Entry>& queue = queues_[shares_.take()];
    while (true) {
      const Entry top = queue.top();
      queue.pop();
      if (alive_[at(top.point)] && weights_[at(top.point)] == top.weight) return top.point;
    }
  }

  void remove(std::int32_t point) {
    alive_[at(point)] = 0;
    ranks_[at(point)] = static_cast<std::int32_t>(--left_);
    for (const Link& one : links_[at(point)]) {
      if (!alive_[at(one.other)]) continue;
      weights_[at(one.other)] -= one.weight;
      enter(one.other);
    }
  }

  const Indices& class_of_;
  Shares shares_;
  std::vector<Layer> layers_;  // one of all points, then one per class if there are several
  std::vector<std::uint8_t> alive_;
  std::size_t left_ = 0;
  Indices ranks_;
  std::vector<std::vector<Link>> links_;
  std::vector<double> weights_;
  std::vector<std::priority_queue<Entry>> queues_;  // per class
};

/// The members of each nonempty class, and per point the index of its list.
std::pair<std::vector<Indices>, Indices> grouped(std::size_t count,
                                                 std::span<const std::int32_t> classes) {
  Indices names(classes.begin(), classes.end());
  sort_unique(names);
  std::vector<Indices> members(std::max<std::size_t>(names.size(), 1));
  Indices group(count, 0);
  for (std::size_t k = 0; k < count; ++k) {
    if (!classes.empty())
      group[k] = static_cast<std::int32_t>(
          std::lower_bound(names.begin(), names.end(), classes[k]) - names.begin());
    members[at(group[k])].push_back(static_cast<std::int32_t>(k));
  }
  return {members, group};
}

}  // namespace

std::vector<std::int32_t> progressive_ranks(std::span<const Vec3> points,
                                            std::span<const std::int32_t> classes,
                                            Context* context) {
  if (context) context->check();
  check_finite("points", points);
  if (!classes.empty()) check_same_length("classes", classes.size(), "points", points.size());
  for (std::size_t k = 0; k < classes.size(); ++k)
    if (classes[k] < 0)
      throw ArgumentError(entry("classes", k) + " is " + std::to_string(classes[k]) +
                          ": it must be >= 0");
  const auto [members, group] = grouped(points.size(), classes);
  Indices ranks = Elimination(points, members, group, context).run(context);
  if (context) context->advance(1.0);
  return ranks;
}

}  // namespace dapple
