// SPDX-License-Identifier: GPL-3.0-or-later
#include "periodic_start.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/poisson_start.hpp>
#include <map>

#include "random.hpp"

namespace dapple {
namespace {

// As in the start on surfaces: a random packing jams at 0.776 of the hexagonal spacing.
constexpr double kFirstRadius = 0.76;
constexpr double kShrink = 0.96;
constexpr std::size_t kPatience = 4;  // darts per wanted sample at one radius
constexpr std::size_t kBatch = 1024;

struct Dart {
  Vec3 position;
  double radius;
};

double around(double difference) { return difference - std::round(difference); }

/// Darts of similar radius on a grid around the torus, whose cells are not smaller than it.
class PeriodicGrid {
 public:
  /// \param most cells along a side
  PeriodicGrid(double cell, std::int64_t most)
      : side_(static_cast<std::int64_t>(std::clamp(1.0 / cell, 1.0, static_cast<double>(most)))),
        cells_(static_cast<std::size_t>(side_ * side_)) {}

  void insert(const Dart& dart) {
    cells_[index(address(dart.position.x()), address(dart.position.y()))].push_back(dart);
  }

  [[nodiscard]] bool refuses(const Dart& dart) const {
    const std::int64_t x = address(dart.position.x()), y = address(dart.position.y());
    const std::int64_t reach = side_ < 3 ? side_ - 1 : 1;  // each cell once
    for (std::int64_t dx = side_ < 3 ? 0 : -1; dx <= reach; ++dx)
      for (std::int64_t dy = side_ < 3 ? 0 : -1; dy <= reach; ++dy)
        for (const Dart& other : cells_[index(x + dx, y + dy)])
          if (near(dart, other)) return true;
    return false;
  }

 private:
  static bool near(const Dart& a, const Dart& b) {
    const double radius = std::min(a.radius, b.radius);
    const double dx = around(a.position.x() - b.position.x());
    const double dy = around(a.position.y() - b.position.y());
    return dx * dx + dy * dy < radius * radius;
  }

  [[nodiscard]] std::int64_t address(double x) const {
    return static_cast<std::int64_t>(std::floor((x - std::floor(x)) * static_cast<double>(side_)));
  }
  [[nodiscard]] std::size_t index(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>((x + side_) % side_ * side_ + (y + side_) % side_);
  }

  std::int64_t side_;
  std::vector<std::vector<Dart>> cells_;
};

/// Accepted darts by octaves of their radius.
class PeriodicDarts {
 public:
  explicit PeriodicDarts(std::size_t count)
      : most_(static_cast<std::int64_t>(std::sqrt(static_cast<double>(count))) + 1) {}

  bool accept(const Dart& dart) {
    for (const auto& [octave, grid] : grids_)
      if (grid.refuses(dart)) return false;
    insert(dart);
    return true;
  }

  void insert(const Dart& dart) {
    const int octave = std::ilogb(dart.radius) + 1;
    grids_.try_emplace(octave, std::ldexp(1.0, octave), most_).first->second.insert(dart);
  }

 private:
  std::int64_t most_;  // cells along a side: not more of them than darts
  std::map<int, PeriodicGrid> grids_;
};

/// Points drawn with the density, in batches.
class Throws {
 public:
  Throws(const Surface& period, std::uint64_t seed) : period_(&period), seeds_(seed) {}

  Dart next() {
    if (used_ == batch_.size()) {
      batch_ = random_start(*period_, kBatch, seeds_.bits());
      used_ = 0;
    }
    const std::size_t k = used_++;
    const Vec3 values = period_->densities(period_->ordered_face(batch_.faces[k]));
    return {batch_.positions[k], 1.0 / std::sqrt(batch_.barycentric[k].dot(values))};
  }

 private:
  const Surface* period_;
  Random seeds_;
  Sites batch_;
  std::size_t used_ = 0;
};

}  // namespace

std::vector<Vec3> periodic_poisson_start(const Surface& period, std::size_t count,
                                         std::uint64_t seed, const Context* context) {
  Throws throws(period, seed);
  std::vector<Dart> darts;
  const double spacing_at_1 = period.spacing(count) * std::sqrt(period.mass() / period.area());
  for (double fraction = kFirstRadius; darts.size() < count; fraction *= kShrink) {
    PeriodicDarts accepted(count);
    for (Dart& dart : darts) {
      dart.radius *= kShrink;
      accepted.insert(dart);
    }
    for (std::size_t thrown = 0; thrown < kPatience * count && darts.size() < count; ++thrown) {
      if (context && thrown % kBatch == 0) context->check();
      Dart dart = throws.next();
      dart.radius *= fraction * spacing_at_1;
      if (accepted.accept(dart)) darts.push_back(dart);
    }
  }
  std::vector<Vec3> positions;
  positions.reserve(darts.size());
  for (const Dart& dart : darts) positions.push_back(dart.position);
  return positions;
}

}  // namespace dapple
