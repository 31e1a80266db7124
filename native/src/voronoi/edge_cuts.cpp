// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/edge_cuts.hpp"

#include <algorithm>

namespace dapple {
namespace {

constexpr double kLong = 4.0;  // squared spacings between a cut and its sites: others are between
constexpr int kMostSteps = 1 << 16;  // rounding must not lead around forever

}  // namespace

void EdgeCutter::find(std::span<const FaceEdges::Ends> edges, std::span<const char> counts,
                      std::span<const VertexLabel> labels, double squared_spacing,
                      std::span<std::atomic<char>> descends, EdgeCuts& result) {
  cut_.resize(std::max(cut_.size(), edges.size() + 1));
  result.numbers_.resize(edges.size());
  result.cuts_.clear();
  result.more_.clear();
  std::size_t count = 0;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [low, high] = edges[e];
    const VertexLabel a = labels[as_index(low)], b = labels[as_index(high)];
    const bool here = counts.empty() || counts[e] != 0;
    const bool cut = here && a.site != b.site && a.site >= 0 && b.site >= 0;
    result.numbers_[e] = cut ? static_cast<std::uint16_t>(count) : EdgeCuts::kNone;
    cut_[count] = static_cast<std::uint16_t>(e);
    count += cut ? 1 : 0;
    const std::size_t farther = as_index(a.squared_distance > b.squared_distance ? low : high);
    descends[here && a.site == b.site ? farther : descends.size() - 1].store(
        1, std::memory_order_relaxed);
  }
  for (std::size_t first = 0; first < count; first += kStaged) {
    const std::span<const std::uint16_t> cut =
        std::span(cut_).subspan(first, std::min(kStaged, count - first));
    stage(cut, edges, labels);
    cut_staged(cut.size());
    for (std::size_t k = 0; k < cut.size(); ++k) store(k, edges[cut[k]], squared_spacing, result);
  }
}

void EdgeCutter::stage(std::span<const std::uint16_t> cut, std::span<const FaceEdges::Ends> edges,
                       std::span<const VertexLabel> labels) {
  Staged& s = staged_;
  const Vec3 *const vertices = vertices_.data(), *const sites = lists_->positions();
  for (std::size_t k = 0; k < cut.size(); ++k) {
    const auto [low, high] = edges[cut[k]];
    const std::int32_t i = labels[as_index(low)].site, j = labels[as_index(high)].site;
    const Triple a(vertices[low]), b(vertices[high]), x(sites[i]);
    const Triple r = a - x, l = b - a, d = Triple(sites[j]) - x;
    s.ax[k] = a.x, s.ay[k] = a.y, s.az[k] = a.z;
    s.rx[k] = r.x, s.ry[k] = r.y, s.rz[k] = r.z;
    s.lx[k] = l.x, s.ly[k] = l.y, s.lz[k] = l.z;
    s.dx[k] = d.x, s.dy[k] = d.y, s.dz[k] = d.z;
    s.i[k] = i;
    s.j[k] = j;
  }
}

/// Cut each edge by the bisector of the sites of its ends.
void EdgeCutter::cut_staged(std::size_t count) {
  Staged& s = staged_;
  for (std::size_t k = 0; k < count; ++k) {
    const double dx = s.dx[k], dy = s.dy[k], dz = s.dz[k];
    const double offset =
        0.5 * (dx * dx + dy * dy + dz * dz) - (s.rx[k] * dx + s.ry[k] * dy + s.rz[k] * dz);
    double t = offset / (s.lx[k] * dx + s.ly[k] * dy + s.lz[k] * dz);
    t = t > 0.0 ? t : 0.0;
    t = t < 1.0 ? t : 1.0;
    const double px = t * s.lx[k], py = t * s.ly[k], pz = t * s.lz[k];
    const double qx = s.rx[k] + px, qy = s.ry[k] + py, qz = s.rz[k] + pz;
    s.squared[k] = qx * qx + qy * qy + qz * qz;
    s.px[k] = s.ax[k] + px;
    s.py[k] = s.ay[k] + py;
    s.pz[k] = s.az[k] + pz;
  }
}

void EdgeCutter::store(std::size_t k, const FaceEdges::Ends& ends, double squared_spacing,
                       EdgeCuts& result) {
  const Staged& s = staged_;
  EdgeCuts::Cut& cut = result.cuts_.emplace_back();
  cut.first.x = {s.px[k], s.py[k], s.pz[k]};
  cut.first.beyond = s.j[k];
  cut.more = 0;
  if (is_single(k, squared_spacing)) return;
  links_.clear();
  follow(Triple(vertices_[as_index(ends[0])]), Triple(vertices_[as_index(ends[1])]), s.i[k],
         s.j[k]);
  cut.first = links_.front();
  if (links_.size() == 1) return;
  cut.at = static_cast<std::uint32_t>(result.more_.size());
  cut.more = static_cast<std::uint32_t>(links_.size() - 1);
  result.more_.insert(result.more_.end(), links_.begin(), links_.end());
}

/// Whether no third site is nearer to the cut than those of the ends.
bool EdgeCutter::is_single(std::size_t k, double squared_spacing) const {
  const Staged& s = staged_;
  return s.squared[k] <= kLong * squared_spacing &&
         lists_->nearer({s.px[k], s.py[k], s.pz[k]}, s.squared[k], s.i[k], s.j[k]) < 0;
}

/// Follow the segment from a in the cell of i to b in that of j.
void EdgeCutter::follow(const Triple& a, const Triple& b, std::int32_t i, std::int32_t j) {
  const Triple along = b - a;
  double now = 0.0;
  std::int32_t last = -1;
  for (int step = 0; i != j; ++step) {
    const NearLists::Exit exit = lists_->exit(i, a, along, now, 1.0, last);
    const std::int32_t next = exit.site < 0 || step == kMostSteps ? j : exit.site;
    now = std::clamp(exit.t, now, 1.0);
    links_.push_back({a + now * along, next});
    last = i;
    i = next;
  }
}

}  // namespace dapple
