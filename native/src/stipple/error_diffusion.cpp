// SPDX-License-Identifier: GPL-3.0-or-later
#include "stipple/error_diffusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/random.hpp"

namespace dapple {
namespace {

constexpr double kBlocks = 4.0;  // blocks per dot

/// The fractional number of dots of each class in each block.
class Wanted {
 public:
  Wanted(std::span<const Image> densities, std::span<const std::size_t> counts)
      : classes_(counts.size()), image_(densities[0]) {
    const double dots =
        static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    const auto pixels = static_cast<double>(image_.rows * image_.columns);
    side_ = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::sqrt(pixels / std::max(1.0, kBlocks * dots))));
    columns_ = (image_.columns + side_ - 1) / side_;
    rows_ = (image_.rows + side_ - 1) / side_;
    values_.assign(columns_ * rows_ * classes_, 0.0);
    for (std::size_t c = 0; c < classes_; ++c)
      if (counts[c] > 0) add(densities[c].values, static_cast<double>(counts[c]), c);
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::span<double> at(std::size_t row, std::size_t column) {
    return std::span(values_).subspan((row * columns_ + column) * classes_, classes_);
  }

  /// A random position in a block; blocks at the last row and column may be smaller.
  [[nodiscard]] Vec2 place(std::size_t row, std::size_t column, Random& random) const {
    const auto within = [&](std::size_t block, std::size_t limit) {
      const auto low = static_cast<double>(block * side_);
      const auto high = static_cast<double>(std::min((block + 1) * side_, limit));
      return low + random.uniform() * (high - low);
    };
    const double x = within(column, image_.columns);
    return {x, within(row, image_.rows)};
  }

 private:
  void add(const std::vector<double>& density, double count, std::size_t c) {
    const double scale = count / std::accumulate(density.begin(), density.end(), 0.0);
    for (std::size_t k = 0; k < density.size(); ++k)
      at(k / image_.columns / side_, k % image_.columns / side_)[c] += scale * density[k];
  }

  std::size_t classes_;
  const Image& image_;
  std::size_t side_ = 1, columns_ = 0, rows_ = 0;
  std::vector<double> values_;
};

class Diffusion {
 public:
  Diffusion(std::span<const Image> densities, std::span<const std::size_t> counts,
            std::uint64_t seed)
      : wanted_(densities, counts), counts_(counts), random_(seed), unplaced_(counts.size(), 0.0) {
    for (std::size_t row = 0; row < wanted_.rows(); ++row)
      for (std::size_t column = 0; column < wanted_.columns(); ++column)
        filled_.push_back(total(wanted_.at(row, column)) > 0.0);
  }

  Diffused run(const Context* context) {
    for (std::size_t row = 0; row < wanted_.rows(); ++row) {
      if (context) context->check();
      for (std::size_t k = 0; k < wanted_.columns(); ++k)
        visit(row, row % 2 == 0 ? k : wanted_.columns() - 1 - k, row % 2 == 0 ? 1 : -1);
    }
    settle_counts();
    return std::move(dots_);
  }

 private:
  static double total(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
  }

  [[nodiscard]] bool filled(std::ptrdiff_t row, std::ptrdiff_t column) const {
    return row < static_cast<std::ptrdiff_t>(wanted_.rows()) && column >= 0 &&
           column < static_cast<std::ptrdiff_t>(wanted_.columns()) &&
           filled_[static_cast<std::size_t>(row) * wanted_.columns() +
                   static_cast<std::size_t>(column)];
  }

  void visit(std::size_t row, std::size_t column, std::ptrdiff_t forward) {
    if (!filled(static_cast<std::ptrdiff_t>(row), static_cast<std::ptrdiff_t>(column))) return;
    const std::span<double> lack = wanted_.at(row, column);
    for (std::size_t c = 0; c < lack.size(); ++c) {
      lack[c] += unplaced_[c];
      unplaced_[c] = 0.0;
    }
    for (double left = std::round(total(lack)); left > 0.0; left -= 1.0) {
      const auto most = std::max_element(lack.begin(), lack.end());
      *most -= 1.0;
      dots_.positions.push_back(wanted_.place(row, column, random_));
      dots_.classes.push_back(static_cast<std::int32_t>(most - lack.begin()));
    }
    pass_on(static_cast<std::ptrdiff_t>(row), static_cast<std::ptrdiff_t>(column), forward, lack);
  }

  /// Distribute an error to the following blocks. Empty blocks are skipped, because errors moved
  /// there would be lost or become dots.
  void pass_on(std::ptrdiff_t row, std::ptrdiff_t column, std::ptrdiff_t forward,
               std::span<const double> lack) {
    struct Share {
      std::ptrdiff_t row, column;
      double weight;
    };
    const std::array<Share, 4> shares = {{{row, column + forward, 7.0},
                                          {row + 1, column - forward, 3.0},
                                          {row + 1, column, 5.0},
                                          {row + 1, column + forward, 1.0}}};
    double weights = 0.0;
    for (const Share& share : shares)
      if (filled(share.row, share.column)) weights += share.weight;
    for (std::size_t c = 0; c < lack.size() && weights == 0.0; ++c) unplaced_[c] += lack[c];
    for (const Share& share : shares) {
      if (weights == 0.0 || !filled(share.row, share.column)) continue;
      const std::span<double> to =
          wanted_.at(static_cast<std::size_t>(share.row), static_cast<std::size_t>(share.column));
      for (std::size_t c = 0; c < lack.size(); ++c) to[c] += share.weight / weights * lack[c];
    }
  }

  /// Corrects the error that remains after the last blocks: the last dots change their classes or
  /// are removed, or dots are added beside them.
  void settle_counts() {
    std::vector<std::ptrdiff_t> missing(counts_.begin(), counts_.end());
    for (const std::int32_t c : dots_.classes) --missing[static_cast<std::size_t>(c)];
    const auto lacking = [&] { return std::max_element(missing.begin(), missing.end()); };
    for (std::size_t k = dots_.classes.size(); k-- > 0;) {
      std::int32_t& own = dots_.classes[k];
      if (missing[static_cast<std::size_t>(own)] >= 0) continue;
      ++missing[static_cast<std::size_t>(own)];
      const auto to = lacking();
      if (*to > 0) {
        --*to;
        own = static_cast<std::int32_t>(to - missing.begin());
      } else {
        dots_.classes.erase(dots_.classes.begin() + static_cast<std::ptrdiff_t>(k));
        dots_.positions.erase(dots_.positions.begin() + static_cast<std::ptrdiff_t>(k));
      }
    }
    for (auto to = lacking(); to != missing.end() && *to > 0; to = lacking()) {
      --*to;
      dots_.classes.push_back(static_cast<std::int32_t>(to - missing.begin()));
      dots_.positions.push_back(somewhere());
    }
  }

  [[nodiscard]] Vec2 somewhere() {
    const auto last = static_cast<std::size_t>(
        std::find(filled_.rbegin(), filled_.rend(), true).base() - filled_.begin() - 1);
    return wanted_.place(last / wanted_.columns(), last % wanted_.columns(), random_);
  }

  Wanted wanted_;
  std::span<const std::size_t> counts_;
  Random random_;
  std::vector<bool> filled_;
  std::vector<double> unplaced_;  // deficits that no neighboring block could take
  Diffused dots_;
};

}  // namespace

Diffused diffuse_errors(std::span<const Image> densities, std::span<const std::size_t> counts,
                        std::uint64_t seed, const Context* context) {
  return Diffusion(densities, counts, seed).run(context);
}

}  // namespace dapple
