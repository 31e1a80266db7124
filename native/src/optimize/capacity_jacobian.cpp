// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/capacity_jacobian.hpp"

#include <algorithm>
#include <numeric>

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1024;

/// Sum of the fluxes of a cell's boundaries with one neighbor; a cell can have several of them
/// around a torus or a thin part.
Vec3 flux_between(const RestrictedVoronoi& diagram, std::size_t cell, std::size_t neighbor) {
  Vec3 sum = Vec3::Zero();
  for (const CellBoundary& side : diagram.boundary(cell))
    if (static_cast<std::size_t>(side.neighbor) == neighbor) sum += side.flux;
  return sum;
}

bool lists(const RestrictedVoronoi& diagram, std::size_t cell, std::size_t neighbor) {
  const auto sides = diagram.boundary(cell);
  return std::any_of(sides.begin(), sides.end(), [&](const CellBoundary& side) {
    return static_cast<std::size_t>(side.neighbor) == neighbor;
  });
}

/// Call visit(j) for each neighbor of a cell once.
template <typename Visit>
void for_each_neighbor(const RestrictedVoronoi& diagram, std::size_t cell, const Visit& visit) {
  const auto sides = diagram.boundary(cell);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const std::int32_t j = sides[k].neighbor;
    if (std::none_of(sides.begin(), sides.begin() + static_cast<std::ptrdiff_t>(k),
                     [&](const CellBoundary& side) { return side.neighbor == j; }))
      visit(static_cast<std::size_t>(j));
  }
}

struct Pair {
  std::size_t cell, other;
};

/// Pairs (neighbor, cell) in which the cell lists a neighbor that does not list the cell, because
/// of rounding or uncovered faces; sorted.
std::vector<Pair> one_sided(const RestrictedVoronoi& diagram) {
  const std::size_t count = diagram.cells.size();
  std::vector<std::vector<Pair>> found((count + kGrain - 1) / kGrain);
  parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for_each_neighbor(diagram, i, [&](std::size_t j) {
        if (!lists(diagram, j, i)) found[begin / kGrain].push_back({j, i});
      });
  });
  std::vector<Pair> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  std::sort(all.begin(), all.end(), [](const Pair& a, const Pair& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.other < b.other;
  });
  return all;
}

}  // namespace

void CapacityJacobian::update(const RestrictedVoronoi& diagram,
                              std::span<const std::int32_t> members,
                              const std::vector<TangentBasis>& bases, double factor) {
  members_ = members;
  own_.resize(diagram.cells.size());
  starts_.assign(diagram.cells.size() + 1, 0);
  const std::vector<Pair> extra = one_sided(diagram);
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for_each_neighbor(diagram, i, [&](std::size_t) { ++starts_[i + 1]; });
  });
  for (const Pair& pair : extra) ++starts_[pair.cell + 1];
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  others_.resize(starts_.back());
  out_.resize(starts_.back());
  in_.resize(starts_.back());
  const auto before = [](const Pair& pair, std::size_t cell) { return pair.cell < cell; };
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::size_t next = starts_[i];
      const auto add = [&](std::size_t j) {
        others_[next] = static_cast<std::int32_t>(j);
        out_[next] = to_tangent(bases[site(i)], flux_between(diagram, i, j), factor);
        in_[next++] = to_tangent(bases[site(j)], flux_between(diagram, j, i), factor);
      };
      for_each_neighbor(diagram, i, add);
      for (auto pair = std::lower_bound(extra.begin(), extra.end(), i, before);
           pair != extra.end() && pair->cell == i; ++pair)
        add(pair->other);
      Vec3 own = Vec3::Zero();
      for (const CellBoundary& side : diagram.boundary(i)) own += side.flux;
      own_[i] = to_tangent(bases[site(i)], own, factor);
    }
  });
}

void CapacityJacobian::add_product(const TangentVectors& v, std::vector<double>& change,
                                   TangentVectors& result) const {
  change.resize(own_.size());
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double sum = own_[i].dot(v[site(i)]);
      for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k)
        sum -= in_[k].dot(v[site(static_cast<std::size_t>(others_[k]))]);
      change[i] = sum;
    }
  });
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Tangent sum = change[i] * own_[i];
      for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k)
        sum += -change[static_cast<std::size_t>(others_[k])] * out_[k];
      result[site(i)] += sum;
    }
  });
}

void CapacityJacobian::add_blocks(std::vector<TangentBlock>& blocks) const {
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      blocks[site(i)].add_square(own_[i]);
      for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k) blocks[site(i)].add_square(out_[k]);
    }
  });
}

}  // namespace dapple
