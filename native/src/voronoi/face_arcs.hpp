// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "voronoi/edge_cuts.hpp"

namespace dapple {

/// Divides a face among the cells that its border meets. The border consists of arcs of one cell
/// each; cells are convex, so an arc whose two neighbors are one cell ends at a chord, and an arc
/// between two other cells at the point where the three meet, if no fourth site is nearer to that
/// point. Such arcs are completed one after another, and their neighbors then meet.
class FaceArcs {
 public:
  /// The border of a cell's piece, as far as it is known; counter-clockwise.
  struct Arc {
    std::int32_t site;
    std::size_t begin, end;  // of the points
    [[nodiscard]] std::span<const Triple> points() const {
      return std::span(room).subspan(begin, end - begin);
    }
    [[nodiscard]] const Triple& first() const { return room[begin]; }
    [[nodiscard]] const Triple& last() const { return room[end - 1]; }
    void append(const Triple& x) { room[end++] = x; }

    static constexpr std::size_t kRoom = 40;
    std::array<Triple, kRoom + 1> room;
  };
  /// The common boundary of two pieces.
  struct Chord {
    std::int32_t i, j;
    Triple p, q;
  };

  /// Forget the last face.
  void start() { size_ = 0; }
  /// Add a corner of the face and the cuts of the edge behind it; `next` is the label of the next
  /// corner. False if there are too many.
  [[nodiscard]] bool add(const Triple& corner, std::int32_t site, std::int32_t next,
                         std::span<const EdgeCuts::Link> cuts, bool upward);

  /// Divide the face. False if that cannot be decided in this way.
  /// \param meeting_point(i, j, k) the point of the face where three cells meet, if there is one
  template <typename MeetingPoint>
  [[nodiscard]] bool divide(const MeetingPoint& meeting_point);

  /// The pieces, of which those with fewer than three points have no area, and their boundaries.
  [[nodiscard]] std::span<const Arc> pieces() const { return std::span(arcs_).first(count_); }
  [[nodiscard]] std::span<const Chord> chords() const {
    return std::span(chords_).first(chord_count_);
  }

 private:
  static constexpr std::size_t kMostPoints = 24, kMostArcs = 12;
  /// A point of the face's border, and the cell behind it.
  struct Point {
    Triple x;
    std::int32_t site;
    bool is_cut;
  };

  [[nodiscard]] bool make_arcs();
  [[nodiscard]] Arc& open(std::size_t k) { return arcs_[open_[k]]; }
  void close(std::size_t k) {
    for (--open_count_; k < open_count_; ++k) open_[k] = open_[k + 1];
  }
  void add_chord(std::int32_t i, std::int32_t j, const Triple& p, const Triple& q) {
    chords_[chord_count_++] = {i, j, p, q};
  }
  [[nodiscard]] bool join_around(std::size_t k);
  [[nodiscard]] bool end_at(std::size_t k, const Triple& x);
  void finish_two();
  void finish_three(const Triple& x);

  std::array<Point, kMostPoints> points_;
  std::size_t size_ = 0;
  std::array<Arc, kMostArcs> arcs_;
  std::size_t count_ = 0;
  std::array<std::size_t, kMostArcs> open_;  // arcs that are not complete, around the face
  std::size_t open_count_ = 0;
  std::array<Chord, 2 * kMostArcs> chords_;
  std::size_t chord_count_ = 0;
};

template <typename MeetingPoint>
bool FaceArcs::divide(const MeetingPoint& meeting_point) {
  if (!make_arcs()) return false;
  Triple x;
  for (std::size_t k = 0, tried = 0; open_count_ > 3;) {
    if (tried == open_count_) return false;
    k = k < open_count_ ? k : 0;
    const std::int32_t last = open((k + open_count_ - 1) % open_count_).site;
    const std::int32_t next = open((k + 1) % open_count_).site;
    if (last == next) {
      if (!join_around(k)) return false;
    } else if (meeting_point(last, open(k).site, next, x)) {
      if (!end_at(k, x)) return false;
    } else {
      ++k;
      ++tried;
      continue;
    }
    tried = 0;
  }
  if (open_count_ == 2) {
    finish_two();
    return true;
  }
  const std::int32_t a = open(0).site, b = open(1).site, c = open(2).site;
  if (a == b || b == c || c == a || !meeting_point(a, b, c, x)) return false;
  finish_three(x);
  return true;
}

}  // namespace dapple
