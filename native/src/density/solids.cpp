// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <dapple/solids.hpp>

#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/validate.hpp"
#include "density/box_tree.hpp"
#include "density/convex.hpp"

namespace dapple {
namespace {

/// The solids that have points, by their boxes with the margin.
class Bodies {
 public:
  explicit Bodies(const Solids& solids) : margin_(solids.margin) {
    check_at_least("margin", solids.margin, 0.0);
    check_finite("points", solids.points);
    std::size_t begin = 0;
    for (std::size_t k = 0; k < solids.counts.size(); ++k) {
      check_at(k);
      const std::int32_t count = solids.counts[k];
      if (count < 0)
        throw ArgumentError(entry("counts", k) + " is " + std::to_string(count) +
                            ": it must be >= 0");
      const std::size_t end = begin + static_cast<std::size_t>(count);
      if (end > solids.points.size()) fail(solids);
      if (count > 0) add(k, solids.points.subspan(begin, end - begin));
      begin = end;
    }
    if (begin != solids.points.size()) fail(solids);
  }

  [[nodiscard]] std::span<const Eigen::AlignedBox3d> boxes() const { return boxes_; }
  [[nodiscard]] std::size_t solid(std::size_t body) const { return solids_[body]; }

  [[nodiscard]] bool touches(std::size_t body, std::span<const Vec3> points) const {
    return !are_apart(hulls_[body], points, margin_);
  }

  [[nodiscard]] bool touch(std::size_t one, std::size_t other) const {
    return !are_apart(hulls_[one], hulls_[other], 2.0 * margin_);
  }

 private:
  void add(std::size_t solid, std::span<const Vec3> hull) {
    solids_.push_back(solid);
    hulls_.push_back(hull);
    boxes_.push_back(box_around(hull, margin_));
  }

  [[noreturn]] static void fail(const Solids& solids) {
    throw ArgumentError("counts do not sum up to the " + std::to_string(solids.points.size()) +
                        " points");
  }

  double margin_;
  std::vector<std::size_t> solids_;
  std::vector<std::span<const Vec3>> hulls_;
  std::vector<Eigen::AlignedBox3d> boxes_;
};

Reach reach_of(const std::array<Vec3, 3>& face, const Bodies& bodies, const BoxTree& tree) {
  Reach found = Reach::kClear;
  tree.meeting(box_around(face), [&](std::size_t body) {
    if (found == Reach::kInside || !bodies.touches(body, face)) return;
    const bool inside = std::all_of(face.begin(), face.end(), [&](const Vec3& corner) {
      return bodies.touches(body, {&corner, 1});
    });
    found = inside ? Reach::kInside : Reach::kPartly;
  });
  return found;
}

}  // namespace

std::vector<Reach> reached_by_solids(std::span<const Vec3> vertices, std::span<const Face> faces,
                                     const Solids& solids, Context* context) {
  check_finite("vertices", vertices);
  if (!faces.empty()) check_faces(faces, vertices.size());
  const Bodies bodies(solids);
  const BoxTree tree(bodies.boxes());
  std::vector<Reach> result(faces.size(), Reach::kClear);
  Tally tally(context, faces.size());
  parallel_chunks(faces.size(), 256, [&](std::size_t begin, std::size_t end) {
    tally.check();
    for (std::size_t f = begin; f < end; ++f) {
      const auto corner = [&](std::size_t k) {
        return vertices[static_cast<std::size_t>(faces[f][k])];
      };
      result[f] = reach_of({corner(0), corner(1), corner(2)}, bodies, tree);
    }
    tally.add(end - begin);
  });
  if (context) context->advance(1.0);
  return result;
}

std::vector<std::array<std::int32_t, 2>> touching_solids(const Solids& solids, Context* context) {
  const Bodies bodies(solids);
  const BoxTree tree(bodies.boxes());
  const std::size_t count = bodies.boxes().size();
  std::vector<std::vector<std::int32_t>> others(count);
  Tally tally(context, count);
  parallel_chunks(count, 16, [&](std::size_t begin, std::size_t end) {
    tally.check();
    for (std::size_t k = begin; k < end; ++k) {
      tree.meeting(bodies.boxes()[k], [&](std::size_t other) {
        if (other > k && bodies.touch(k, other))
          others[k].push_back(static_cast<std::int32_t>(bodies.solid(other)));
      });
      std::sort(others[k].begin(), others[k].end());
    }
    tally.add(end - begin);
  });
  std::vector<std::array<std::int32_t, 2>> pairs;
  for (std::size_t k = 0; k < count; ++k)
    for (const std::int32_t other : others[k])
      pairs.push_back({static_cast<std::int32_t>(bodies.solid(k)), other});
  if (context) context->advance(1.0);
  return pairs;
}

}  // namespace dapple
