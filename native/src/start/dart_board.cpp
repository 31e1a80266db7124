// SPDX-License-Identifier: GPL-3.0-or-later
#include "start/dart_board.hpp"

#include <algorithm>
#include <cmath>

#include "base/allot.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

/// The quotas that remain after some darts are placed. If an island holds more than its quota, the
/// quotas of others are reduced, the largest first.
void subtract(std::vector<std::size_t>& quotas, const std::vector<std::size_t>& taken) {
  std::size_t owed = 0;
  for (std::size_t k = 0; k < quotas.size(); ++k) {
    const std::size_t given = std::min(quotas[k], taken[k]);
    quotas[k] -= given;
    owed += taken[k] - given;
  }
  for (; owed > 0; --owed) {
    const auto richest = std::max_element(quotas.begin(), quotas.end());
    if (*richest > 0) --*richest;
  }
}

}  // namespace

DartBoard::DartBoard(const Surface& surface, std::size_t count, const std::vector<Dart>& taken)
    : surface_(&surface),
      islands_(islands_of(surface)),
      places_(allot(islands_->capacities(), count)) {
  std::vector<std::size_t> held(places_.size(), 0);
  for (const Dart& dart : taken) ++held[islands_->at(dart.face)];
  subtract(places_, held);
  sum_up();
}

DartBoard::Draw DartBoard::draw(Random& random) const {
  while (true) {
    const OrderedFace face = nth_face(face_at(random.uniform() * cumulative_.back()));
    if (places_[islands_->at(face)] > 0) return draw_on(face, random);
  }
}

// The first face whose cumulative capacity is larger. A guide table is used, because a binary
// search would cause a cache miss at each step.
std::size_t DartBoard::face_at(double capacity) const {
  const std::size_t last = cumulative_.size() - 1;
  const double part = capacity / cumulative_.back() * static_cast<double>(guide_.size());
  std::size_t k = guide_[std::min(static_cast<std::size_t>(part), guide_.size() - 1)];
  while (k > 0 && cumulative_[k - 1] > capacity) --k;  // rounding
  while (k < last && cumulative_[k] <= capacity) ++k;
  return k;
}

bool DartBoard::take(const Dart& dart) {
  const std::size_t c = islands_->at(dart.face);
  if (--places_[c] > 0) return false;
  closed_ += islands_->capacities()[c];
  if (closed_ > 0.5 * cumulative_.back()) sum_up();
  return true;
}

void DartBoard::sum_up() {
  double sum = 0.0;
  closed_ = 0.0;
  cumulative_.resize(surface_->face_count());
  for (std::size_t f = 0; f < cumulative_.size(); ++f) {
    if (places_[islands_->at(nth_face(f))] > 0)
      sum += surface_->ordered().geometry(nth_face(f)).moments.capacity;
    cumulative_[f] = sum;
  }
  guide_.resize(cumulative_.size());
  std::size_t k = 0;
  for (std::size_t part = 0; part < guide_.size(); ++part) {
    const double begin = sum * static_cast<double>(part) / static_cast<double>(guide_.size());
    while (k + 1 < cumulative_.size() && cumulative_[k] <= begin) ++k;
    guide_[part] = static_cast<std::uint32_t>(k);
  }
}

// Points are uniform on the face and accepted in proportion to the density. At least a third is
// accepted, because the density is linear.
DartBoard::Draw DartBoard::draw_on(OrderedFace face, Random& random) const {
  const Vec3 values = surface_->ordered().densities(face);
  while (true) {
    const double root = std::sqrt(random.uniform());
    const double along = random.uniform();
    const Vec3 weights(1.0 - root, root * (1.0 - along), root * along);
    if (random.uniform() * values.maxCoeff() >= weights.dot(values)) continue;
    return {face, weights};
  }
}

}  // namespace dapple
