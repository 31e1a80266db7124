// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <dapple/poisson_start.hpp>
#include <map>
#include <numeric>
#include <utility>

#include "random.hpp"

namespace dapple {
namespace {

struct Dart {
  Vec3 position;
  Vec3 barycentric;
  Vec3 normal;
  std::int32_t face;  // ordered
  std::int32_t component;
  double density;
  double radius = 0.0;

  /// Whether straight distance stands for distance along the surface: not between components, nor
  /// between the two sides of a wall.
  [[nodiscard]] bool sees(const Dart& other) const {
    return component == other.component && normal.dot(other.normal) > -0.5;
  }
};

/// How many of `count` points each component gets: its share of the mass, by largest remainders.
/// Once cells follow the surface, components exchange no sites.
std::vector<std::size_t> allot(const std::vector<double>& masses, std::size_t count) {
  const double total = std::accumulate(masses.begin(), masses.end(), 0.0);
  std::vector<std::size_t> quotas(masses.size());
  std::vector<std::pair<double, std::size_t>> remainders;
  std::size_t given = 0;
  for (std::size_t k = 0; k < masses.size(); ++k) {
    const double share = static_cast<double>(count) * masses[k] / total;
    given += quotas[k] = static_cast<std::size_t>(share);
    remainders.emplace_back(static_cast<double>(quotas[k]) - share, k);
  }
  std::sort(remainders.begin(), remainders.end());
  for (std::size_t k = 0; given < count; ++given, ++k) ++quotas[remainders[k].second];
  return quotas;
}

/// Draws points of the surface with its density, while their component has places left.
class DartBoard {
 public:
  DartBoard(const Surface& surface, std::size_t count)
      : surface_(&surface), masses_(static_cast<std::size_t>(surface.components()), 0.0) {
    for (std::size_t f = 0; f < surface.face_count(); ++f)
      masses_[component(f)] += surface.geometry(static_cast<std::int32_t>(f)).moments.capacity;
    places_ = allot(masses_, count);
    sum_up();
  }

  Dart draw(Random& random) const {
    while (true) {
      const double target = random.uniform() * cumulative_.back();
      const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), target);
      const auto face =
          static_cast<std::size_t>(std::min(found, cumulative_.end() - 1) - cumulative_.begin());
      if (places_[component(face)] > 0) return draw_on(static_cast<std::int32_t>(face), random);
    }
  }

  /// One place of the dart's component is taken.
  void take(const Dart& dart) {
    const std::size_t c = component(static_cast<std::size_t>(dart.face));
    if (--places_[c] > 0) return;
    closed_ += masses_[c];
    if (closed_ > 0.5 * cumulative_.back()) sum_up();
  }

 private:
  [[nodiscard]] std::size_t component(std::size_t face) const {
    return static_cast<std::size_t>(surface_->component(static_cast<std::int32_t>(face)));
  }

  void sum_up() {
    double sum = 0.0;
    closed_ = 0.0;
    cumulative_.resize(surface_->face_count());
    for (std::size_t f = 0; f < cumulative_.size(); ++f) {
      if (places_[component(f)] > 0)
        sum += surface_->geometry(static_cast<std::int32_t>(f)).moments.capacity;
      cumulative_[f] = sum;
    }
  }

  // Uniform on the face, then accepted in proportion to the density: at least a third is, since it
  // is linear.
  Dart draw_on(std::int32_t face, Random& random) const {
    const Vec3 values = surface_->densities(face);
    while (true) {
      const double root = std::sqrt(random.uniform());
      const double along = random.uniform();
      const Vec3 weights(1.0 - root, root * (1.0 - along), root * along);
      const double density = weights.dot(values);
      if (random.uniform() * values.maxCoeff() >= density) continue;
      return {surface_->point(surface_->original_face(face), weights),
              weights,
              surface_->geometry(face).normal,
              face,
              surface_->component(face),
              density,
              0.0};
    }
  }

  const Surface* surface_;
  std::vector<double> masses_;       // per component
  std::vector<std::size_t> places_;  // left per component
  std::vector<double> cumulative_;   // mass of the faces so far, without full components
  double closed_ = 0.0;              // mass of components that have become full since
};

/// Accepted darts of similar radius in a hashed grid, whose cell is not smaller than their radius.
class DartGrid {
 public:
  DartGrid(const std::vector<Dart>& darts, double cell)
      : darts_(&darts), cell_(cell), heads_(16, kNone) {}

  void insert(std::size_t dart) {
    members_.push_back({dart, kNone});
    if (members_.size() > heads_.size()) return grow();
    link(members_.size() - 1);
  }

  /// Whether a member lies nearer to the dart than the smaller of their radii.
  [[nodiscard]] bool refuses(const Dart& dart) const {
    const Address centre = address(dart.position);
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dz = -1; dz <= 1; ++dz)
          if (refuses_in(bucket({centre[0] + dx, centre[1] + dy, centre[2] + dz}), dart))
            return true;
    return false;
  }

 private:
  using Address = std::array<std::int64_t, 3>;
  static constexpr std::size_t kNone = ~std::size_t{0};
  struct Member {
    std::size_t dart;
    std::size_t next;  // in the same bucket
  };

  // Cells may share a bucket: that costs distance tests, never an answer.
  bool refuses_in(std::size_t bucket, const Dart& dart) const {
    for (std::size_t m = heads_[bucket]; m != kNone; m = members_[m].next) {
      const Dart& other = (*darts_)[members_[m].dart];
      const double reach = std::min(dart.radius, other.radius);
      if ((dart.position - other.position).squaredNorm() < reach * reach && dart.sees(other))
        return true;
    }
    return false;
  }

  void link(std::size_t member) {
    std::size_t& head = heads_[bucket(address((*darts_)[members_[member].dart].position))];
    members_[member].next = head;
    head = member;
  }

  void grow() {
    heads_.assign(4 * heads_.size(), kNone);
    for (std::size_t m = 0; m < members_.size(); ++m) link(m);
  }

  [[nodiscard]] Address address(const Vec3& p) const {
    const auto along = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell_)); };
    return {along(p.x()), along(p.y()), along(p.z())};
  }

  [[nodiscard]] std::size_t bucket(const Address& a) const {
    const auto part = [](std::int64_t x, std::uint64_t prime) {
      return static_cast<std::uint64_t>(x) * prime;
    };
    const std::uint64_t hash = part(a[0], 0x9e3779b97f4a7c15u) ^ part(a[1], 0xc2b2ae3d27d4eb4fu) ^
                               part(a[2], 0x165667b19e3779f9u);
    return (hash >> 32) & (heads_.size() - 1);
  }

  const std::vector<Dart>* darts_;
  double cell_;
  std::vector<std::size_t> heads_;  // per bucket; a power of two
  std::vector<Member> members_;
};

/// Accepted darts by octaves of their radius, so that a steep density stays quick.
class DartSet {
 public:
  /// Take over the accepted darts with their radius scaled.
  DartSet(std::vector<Dart>& darts, double scale) : darts_(&darts) {
    for (Dart& dart : darts) dart.radius *= scale;
    for (std::size_t k = 0; k < darts.size(); ++k) grid_of(darts[k].radius).insert(k);
  }

  /// Accept the dart unless another is too near.
  bool accept(const Dart& dart) {
    for (const auto& [octave, grid] : grids_)
      if (grid.refuses(dart)) return false;
    darts_->push_back(dart);
    grid_of(dart.radius).insert(darts_->size() - 1);
    return true;
  }

 private:
  DartGrid& grid_of(double radius) {
    const int octave = std::ilogb(radius) + 1;
    return grids_.try_emplace(octave, *darts_, std::ldexp(1.0, octave)).first->second;
  }

  std::vector<Dart>* darts_;
  std::map<int, DartGrid> grids_;
};

Sites to_sites(const Surface& surface, const std::vector<Dart>& darts) {
  Sites sites;
  for (const Dart& dart : darts) {
    sites.positions.push_back(dart.position);
    sites.faces.push_back(surface.original_face(dart.face));
    sites.barycentric.push_back(dart.barycentric);
  }
  return sites;
}

// Random sequential packing jams at 0.776 of the hexagonal spacing; the last darts before that take
// very long.
constexpr double kFirstRadius = 0.76;
constexpr double kShrink = 0.96;
constexpr std::size_t kPatience = 4;  // darts per wanted sample at one radius

}  // namespace

Sites random_start(const Surface& surface, std::size_t count, std::uint64_t seed) {
  DartBoard board(surface, count);
  Random random(seed);
  std::vector<Dart> darts;
  while (darts.size() < count) {
    darts.push_back(board.draw(random));
    board.take(darts.back());
  }
  return to_sites(surface, darts);
}

Sites poisson_start(const Surface& surface, std::size_t count, std::uint64_t seed,
                    const Context* context) {
  DartBoard board(surface, count);
  Random random(seed);
  std::vector<Dart> darts;
  darts.reserve(count);
  // Where n points have the density n phi / mass, their hexagonal spacing is sqrt(2 mass / (sqrt(3)
  // n phi)).
  const double spacing_at_1 = surface.spacing(count) * std::sqrt(surface.mass() / surface.area());
  double scale = 1.0;
  for (double fraction = kFirstRadius; darts.size() < count; fraction *= kShrink, scale = kShrink) {
    DartSet accepted(darts, scale);
    for (std::size_t thrown = 0; thrown < kPatience * count && darts.size() < count; ++thrown) {
      if (context && thrown % 1024 == 0) context->check();
      Dart dart = board.draw(random);
      dart.radius = fraction * spacing_at_1 / std::sqrt(dart.density);
      if (accepted.accept(dart)) board.take(dart);
    }
  }
  return to_sites(surface, darts);
}

}  // namespace dapple
