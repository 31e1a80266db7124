// SPDX-License-Identifier: GPL-3.0-or-later
#include "voronoi/face_arcs.hpp"

#include <algorithm>

namespace dapple {

bool FaceArcs::add(const Triple& corner, std::int32_t site, std::int32_t next,
                   std::span<const EdgeCuts::Link> cuts, bool upward) {
  if (size_ + cuts.size() + 3 > kMostPoints) return false;
  points_[size_++] = {corner, site, false};
  if (upward) {
    for (const EdgeCuts::Link& link : cuts) points_[size_++] = {link.x, link.beyond, true};
  } else {
    for (std::size_t k = cuts.size(); k-- > 0;)
      points_[size_++] = {cuts[k].x, k > 0 ? cuts[k - 1].beyond : next, true};
  }
  return true;
}

/// Each arc begins and ends with a cut.
bool FaceArcs::make_arcs() {
  chord_count_ = count_ = 0;
  std::size_t first = 0, cuts = 0;
  for (std::size_t k = size_; k-- > 0;) {
    if (!points_[k].is_cut) continue;
    first = k;
    ++cuts;
  }
  if (cuts < 2 || cuts > kMostArcs) return false;
  for (std::size_t n = 0; n < size_; ++n) {
    const Point& point = points_[(first + n) % size_];
    if (point.is_cut) {
      if (count_ > 0) arcs_[count_ - 1].append(point.x);
      Arc& arc = arcs_[count_];
      arc.site = point.site;
      arc.begin = arc.end = Arc::kRoom / 4;  // points may be added in front
      open_[count_] = count_;
      ++count_;
    }
    arcs_[count_ - 1].append(point.x);
  }
  arcs_[count_ - 1].append(arcs_[0].first());
  open_count_ = count_;
  return true;
}

/// Arc k lies between two arcs of one cell, which become one.
bool FaceArcs::join_around(std::size_t k) {
  const std::size_t behind = (k + 1) % open_count_;
  const Arc& arc = open(k);
  Arc &last = open((k + open_count_ - 1) % open_count_), &next = open(behind);
  add_chord(arc.site, last.site, arc.first(), arc.last());
  if (last.end + next.points().size() > Arc::kRoom) return false;
  for (const Triple& x : next.points()) last.append(x);
  next.end = next.begin;
  close(std::max(k, behind));
  close(std::min(k, behind));
  return true;
}

/// Arc k ends at a point, where its neighbors meet.
bool FaceArcs::end_at(std::size_t k, const Triple& x) {
  Arc &arc = open(k), &last = open((k + open_count_ - 1) % open_count_);
  Arc& next = open((k + 1) % open_count_);
  if (next.begin == 0 || last.end == Arc::kRoom || arc.end == Arc::kRoom) return false;
  add_chord(arc.site, last.site, arc.first(), x);
  add_chord(arc.site, next.site, x, arc.last());
  arc.append(x);
  last.append(x);
  next.room[--next.begin] = x;
  close(k);
  return true;
}

void FaceArcs::finish_two() {
  add_chord(open(0).site, open(1).site, open(0).first(), open(0).last());
}

void FaceArcs::finish_three(const Triple& x) {
  for (std::size_t k = 0; k < 3; ++k) {
    add_chord(open(k).site, open((k + 2) % 3).site, open(k).first(), x);
    open(k).append(x);
  }
}

}  // namespace dapple
