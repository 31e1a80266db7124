// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "voronoi/cell_builder.hpp"

namespace dapple {

/// Keeps builders of cells for later evaluations. Every member may be called from several
/// threads.
class CellBuilders {
 public:
  /// Compute cells with a free builder that had this set of sites before, or with a new one.
  /// \param surface must outlive this
  /// \param set     as in Domain::update_cells(); others as in CellBuilder::build()
  void build(const Surface& surface, std::size_t set, const Sites& sites, Cells cells,
             bool leaves_gaps, Context* context, RestrictedVoronoi& diagram) {
    std::unique_ptr<CellBuilder> builder = take(surface, set);
    builder->build(sites, nullptr, cells, leaves_gaps, context, diagram);
    const std::lock_guard lock(mutex_);
    free_[{&surface, set}].push_back(std::move(builder));
  }

 private:
  std::unique_ptr<CellBuilder> take(const Surface& surface, std::size_t set) {
    const std::lock_guard lock(mutex_);
    std::vector<std::unique_ptr<CellBuilder>>& free = free_[{&surface, set}];
    if (free.empty()) return std::make_unique<CellBuilder>(surface);
    std::unique_ptr<CellBuilder> last = std::move(free.back());
    free.pop_back();
    return last;
  }

  std::mutex mutex_;
  std::map<std::pair<const Surface*, std::size_t>, std::vector<std::unique_ptr<CellBuilder>>> free_;
};

}  // namespace dapple
