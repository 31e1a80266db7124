// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "voronoi/cell_builder.hpp"

namespace dapple {

/// Keeps builders of cells for later evaluations. Every member may be called from several
/// threads.
class CellBuilders {
 public:
  /// Compute cells with a free builder, or with a new one.
  /// \param surface must outlive this; parameters as in CellBuilder::build()
  void build(const Surface& surface, const Sites& sites, Cells cells, bool leaves_gaps,
             Context* context, RestrictedVoronoi& diagram) {
    std::unique_ptr<CellBuilder> builder = take(surface);
    builder->build(sites, nullptr, cells, leaves_gaps, context, diagram);
    const std::lock_guard lock(mutex_);
    free_[&surface].push_back(std::move(builder));
  }

 private:
  std::unique_ptr<CellBuilder> take(const Surface& surface) {
    const std::lock_guard lock(mutex_);
    std::vector<std::unique_ptr<CellBuilder>>& free = free_[&surface];
    if (free.empty()) return std::make_unique<CellBuilder>(surface);
    std::unique_ptr<CellBuilder> last = std::move(free.back());
    free.pop_back();
    return last;
  }

  std::mutex mutex_;
  std::map<const Surface*, std::vector<std::unique_ptr<CellBuilder>>> free_;
};

}  // namespace dapple
