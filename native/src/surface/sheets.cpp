// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/sheets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "base/progress.hpp"
#include "base/sets.hpp"
#include "surface/ordered_surface.hpp"

namespace dapple {
namespace {

constexpr double kBeside = 0.94;  // cosine of the angle between two sheets: 20 degrees
constexpr double kFewest = 10.0;  // cells on a sheet: fewer are less even than connected ones
constexpr std::size_t kMostAround = 16;  // faces at an edge; more are left connected
constexpr double kSteps = 1e6;           // of a length, so that rounding errors decide nothing
constexpr std::int32_t kNone = -1;

std::size_t as_size(std::int32_t k) { return static_cast<std::size_t>(k); }

/// How two sheets meet at edges of three or more faces, in lengths of these.
struct Meeting {
  double straight = 0.0;  // more, the straighter one continues the other
  double beside = 0.0;    // where they lie beside each other
};

/// A half-edge at an edge of three or more faces.
struct Side {
  std::int32_t sheet;
  Vec3 across;  // unit, in the face; zero without area
};

class SheetFinder {
 public:
  SheetFinder(const Surface& surface, const Context* context)
      : mesh_(surface.ordered()), context_(context), sets_(find_seams() ? mesh_.face_count() : 0) {}

  std::vector<std::int32_t> components(double cells) {
    if (!has_seams_) return {};
    join_sheets();
    meet();
    measure(cells);
    find_conflicts();
    if (conflicts_.empty()) return {};
    join_straightest();
    return numbers();
  }

 private:
  using Pair = std::pair<std::int32_t, std::int32_t>;

  [[nodiscard]] std::int32_t half_edges() const {
    return static_cast<std::int32_t>(3 * mesh_.face_count());
  }

  [[nodiscard]] bool is_seam(std::int32_t h) const {
    const std::int32_t g = mesh_.next_around(h);
    return g != h && mesh_.next_around(g) != h;
  }

  bool find_seams() {
    for (std::int32_t h = 0; h < half_edges() && !has_seams_; ++h) {
      check_at(context_, as_size(h));
      has_seams_ = is_seam(h);
    }
    return has_seams_;
  }

  /// Sheets are connected over edges of two faces.
  void join_sheets() {
    for (std::int32_t h = 0; h < half_edges(); ++h) {
      check_at(context_, as_size(h));
      const std::int32_t g = mesh_.next_around(h);
      if (g > h && !is_seam(h)) sets_.join(h / 3, g / 3);
    }
  }

  [[nodiscard]] Side side(std::int32_t h) {
    const Face& corners = mesh_.corners(face_of(h));
    const auto corner = [&](std::int32_t k) -> const Vec3& {
      return mesh_.vertex(corners[as_size((h + k) % 3)]);
    };
    const Vec3 along = (corner(1) - corner(0)).stableNormalized();
    const Vec3 to = corner(2) - corner(0);
    return {sets_.find(h / 3), (to - to.dot(along) * along).stableNormalized()};
  }

  void meet() {
    std::vector<Side> around;
    for (std::int32_t h = 0; h < half_edges(); ++h) {
      check_at(context_, as_size(h));
      if (!is_seam(h) || edge_of(mesh_, h) != h) continue;
      around = {side(h)};
      for (std::int32_t g = mesh_.next_around(h); g != h; g = mesh_.next_around(g))
        around.push_back(side(g));
      meet(around, edge_length(mesh_, h));
    }
  }

  void meet(const std::vector<Side>& around, double length) {
    const bool many = around.size() > kMostAround;
    for (std::size_t j = 1; j < around.size(); ++j)
      for (std::size_t i = many ? j - 1 : 0; i < j; ++i) {
        if (around[i].sheet == around[j].sheet) continue;
        Meeting& meeting = meetings_[std::minmax(around[i].sheet, around[j].sheet)];
        const double cosine = around[i].across.dot(around[j].across);
        meeting.straight += length * (1.0 - cosine);
        if (cosine > kBeside && !many) meeting.beside += length;
      }
  }

  /// The cells of each sheet, by its first face.
  void measure(double cells) {
    cells_.assign(mesh_.face_count(), 0.0);
    for (std::size_t f = 0; f < cells_.size(); ++f)
      cells_[as_size(sets_.find(static_cast<std::int32_t>(f)))] +=
          cells * mesh_.geometry(nth_face(f)).moments.capacity / mesh_.unit_capacity();
  }

  void find_conflicts() {
    for (const auto& [sheets, meeting] : meetings_) {
      const auto [a, b] = sheets;
      if (!(meeting.beside > 0.0) || std::min(cells_[as_size(a)], cells_[as_size(b)]) < kFewest)
        continue;
      conflicts_[a].insert(b);
      conflicts_[b].insert(a);
    }
  }

  [[nodiscard]] bool are_in_conflict(std::int32_t a, std::int32_t b) const {
    const auto known = conflicts_.find(a);
    return known != conflicts_.end() && known->second.contains(b);
  }

  /// Connect sheets that continue each other, the straightest first.
  void join_straightest() {
    std::vector<std::tuple<std::int64_t, std::int32_t, std::int32_t>> order;
    order.reserve(meetings_.size());
    double longest = std::numeric_limits<double>::min();  // faces may all lie on each other
    for (const auto& [_, meeting] : meetings_) longest = std::max(longest, meeting.straight);
    for (const auto& [sheets, meeting] : meetings_)
      order.emplace_back(-std::llround(kSteps * (meeting.straight / longest)), sheets.first,
                         sheets.second);
    std::sort(order.begin(), order.end());
    for (const auto& [_, one, other] : order) {
      const std::int32_t a = sets_.find(one), b = sets_.find(other);
      if (a != b && !are_in_conflict(a, b)) join(std::min(a, b), std::max(a, b));
    }
  }

  void join(std::int32_t a, std::int32_t b) {
    sets_.join(a, b);
    const auto known = conflicts_.find(b);
    if (known == conflicts_.end()) return;
    for (const std::int32_t other : known->second) {
      conflicts_[other].erase(b);
      conflicts_[other].insert(a);
      conflicts_[a].insert(other);
    }
    conflicts_.erase(b);
  }

  std::vector<std::int32_t> numbers() {
    std::vector<std::int32_t> result(mesh_.face_count(), kNone), of_set(result.size(), kNone);
    std::int32_t count = 0;
    for (std::size_t f = 0; f < result.size(); ++f) {
      if (!mesh_.counts(nth_face(f))) continue;
      std::int32_t& number = of_set[as_size(sets_.find(static_cast<std::int32_t>(f)))];
      if (number == kNone) number = count++;
      result[f] = number;
    }
    return count > mesh_.components() ? result : std::vector<std::int32_t>{};
  }

  const OrderedSurface& mesh_;
  const Context* context_;
  bool has_seams_ = false;
  Sets sets_;                                                 // of faces: sheets, then components
  std::map<Pair, Meeting> meetings_;                          // by the first faces of two sheets
  std::vector<double> cells_;                                 // per sheet, by its first face
  std::map<std::int32_t, std::set<std::int32_t>> conflicts_;  // of sets
};

}  // namespace

std::vector<std::int32_t> components_of_sheets(const Surface& surface, double cells,
                                               const Context* context) {
  return SheetFinder(surface, context).components(cells);
}

}  // namespace dapple
