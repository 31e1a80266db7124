// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "density/piece_finder.hpp"

namespace dapple {

/// A surface whose faces are cut into pieces of a few cells each, and sites on it.
///
/// Where straight lines go through walls, faces are divided again among all sites that reach them.
/// On a wall of a few large faces these would be all sites; on pieces of it they are the nearby
/// ones.
class CutSurface {
 public:
  explicit CutSurface(Refined refined) : refined_(std::move(refined)), finder_(refined_) {}
  CutSurface(const CutSurface&) = delete;
  CutSurface& operator=(const CutSurface&) = delete;

  [[nodiscard]] const Surface& surface() const { return refined_.surface; }
  /// The caller's face of the whole surface that a face of this one is a piece of.
  [[nodiscard]] std::int32_t parent(std::int32_t face) const {
    return refined_.parents[static_cast<std::size_t>(face)];
  }
  /// The sites of the whole surface: the same positions on the pieces that hold them.
  [[nodiscard]] Sites on_pieces(const Sites& sites) const;

 private:
  Refined refined_;
  PieceFinder finder_;
};

/// The surface cut for `count` sites; null if no face holds the cells of many. Depends only on the
/// surface and the order of magnitude of `count`.
/// \throw Cancelled
[[nodiscard]] std::shared_ptr<const CutSurface> cut_for(const Surface& surface, std::size_t count,
                                                        Context* context = nullptr);

}  // namespace dapple
