// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/capacity_jacobian.hpp"

#include <algorithm>

#include "base/prefetch.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr std::size_t kAhead = 96;          // entries that are loaded before they are needed
constexpr std::size_t kSpare = 2 * kAhead;  // at the end, never used
constexpr std::size_t kLine = 4;            // entries

/// Sum of the fluxes of a cell's boundaries from the k-th on with the k-th one's neighbor; a cell
/// can have several of them around a torus or a thin part.
Vec3 flux_from(std::span<const CellBoundary> sides, std::size_t k) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t m = k; m < sides.size(); ++m)
    if (sides[m].neighbor == sides[k].neighbor) sum += sides[m].flux;
  return sum;
}

}  // namespace

void CapacityJacobian::update(const RestrictedVoronoi& diagram,
                              std::span<const std::int32_t> members,
                              const std::vector<TangentBasis>& bases, double factor) {
  members_ = members;
  own_.resize(diagram.cells.size());
  rows_.resize(diagram.cells.size());
  std::size_t entries = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    rows_[i].first = static_cast<std::uint32_t>(entries);
    entries += diagram.rows[i].count;
  }
  others_.resize(entries + kSpare);
  out_.resize(entries + kSpare);
  in_.resize(entries + kSpare);
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) put_row(diagram, bases, factor, i);
  });
  find_columns(bases, factor);
}

/// Read a cell's boundaries, once because they are far larger than the entries.
void CapacityJacobian::put_row(const RestrictedVoronoi& diagram,
                               const std::vector<TangentBasis>& bases, double factor,
                               std::size_t cell) {
  const std::size_t first = rows_[cell].first;
  std::size_t next = first;
  const TangentBasis& basis = bases[site(cell)];
  const auto listed = others_.begin() + static_cast<std::ptrdiff_t>(first);
  const auto sides = diagram.boundary(cell);
  Vec3 own = Vec3::Zero();
  for (std::size_t k = 0; k < sides.size(); ++k) {
    own += sides[k].flux;
    const auto last = others_.begin() + static_cast<std::ptrdiff_t>(next);
    if (std::find(listed, last, sides[k].neighbor) != last) continue;
    out_[next] = to_tangent(basis, flux_from(sides, k), factor);
    others_[next++] = sides[k].neighbor;
  }
  rows_[cell].count = static_cast<std::uint32_t>(next - first);
  own_[cell] = to_tangent(basis, own, factor);
}

/// The entry of a cell for another one, or none.
std::size_t CapacityJacobian::entry(std::size_t cell, std::size_t other) const {
  for (std::size_t k = rows_[cell].first; k < rows_[cell].end(); ++k)
    if (static_cast<std::size_t>(others_[k]) == other) return k;
  return kNone;
}

/// Copy the columns from the rows. Because of rounding or uncovered faces, a cell may list a
/// neighbor that does not list the cell.
void CapacityJacobian::find_columns(const std::vector<TangentBasis>& bases, double factor) {
  std::vector<std::vector<Unlisted>> found((rows_.size() + kGrain - 1) / kGrain);
  parallel_chunks(rows_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = rows_[i].first; k < rows_[i].end(); ++k) {
        const auto j = static_cast<std::size_t>(others_[k]);
        const std::size_t back = entry(j, i);
        in_[k] = back != kNone ? out_[back] : to_tangent(bases[site(j)], Vec3::Zero(), factor);
        if (back == kNone) found[begin / kGrain].push_back({j, i, out_[k]});
      }
  });
  unlisted_.clear();
  for (const auto& part : found) unlisted_.insert(unlisted_.end(), part.begin(), part.end());
  std::sort(unlisted_.begin(), unlisted_.end(), [](const Unlisted& a, const Unlisted& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.other < b.other;
  });
}

/// Load what the cells after this one need: the products wait for memory.
inline void CapacityJacobian::prefetch_after(const std::vector<Tangent>& entries,
                                             std::size_t cell) const {
  const std::size_t first = rows_[cell].first;
  prefetch(&entries[first + kAhead]);
  prefetch(&entries[first + kAhead + kLine]);
  prefetch(&others_[first + kSpare - 1]);
}

void CapacityJacobian::add_product(const TangentVectors& v, std::vector<double>& change,
                                   TangentVectors& result) const {
  change.resize(own_.size());
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      prefetch_after(in_, i);
      double sum = own_[i].dot(v[site(i)]);
      for (std::size_t k = rows_[i].first; k < rows_[i].end(); ++k)
        sum -= in_[k].dot(v[site(static_cast<std::size_t>(others_[k]))]);
      change[i] = sum;
    }
  });
  for (const Unlisted& pair : unlisted_) change[pair.cell] -= pair.in.dot(v[site(pair.other)]);
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      prefetch_after(out_, i);
      Tangent sum = change[i] * own_[i];
      for (std::size_t k = rows_[i].first; k < rows_[i].end(); ++k)
        sum += -change[static_cast<std::size_t>(others_[k])] * out_[k];
      result[site(i)] += sum;
    }
  });
}

void CapacityJacobian::add_blocks(std::vector<TangentBlock>& blocks) const {
  parallel_chunks(own_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      blocks[site(i)].add_square(own_[i]);
      for (std::size_t k = rows_[i].first; k < rows_[i].end(); ++k)
        blocks[site(i)].add_square(out_[k]);
    }
  });
}

}  // namespace dapple
