// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/class_parts.hpp"

#include <algorithm>
#include <map>

namespace dapple {
namespace {

/// A sample of a class, and its index among the samples of all classes.
struct Row {
  std::size_t rank;
  std::int32_t of_class;
  std::size_t index;
};

/// The samples in order: known ones at their previous index, new ones after them.
std::vector<Row> in_order(const Samples& before, std::span<const Samples> parts) {
  std::map<std::int32_t, std::size_t> place;
  for (std::size_t k = 0; k < before.size(); ++k) place.emplace(before.ids[k], k);
  std::vector<Row> rows;
  for (std::size_t c = 0; c < parts.size(); ++c) {
    for (std::size_t k = 0; k < parts[c].size(); ++k) {
      const auto known = place.find(parts[c].ids[k]);
      const std::size_t rank = known == place.end() ? before.size() : known->second;
      rows.push_back({rank, static_cast<std::int32_t>(c), k});
    }
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.rank < b.rank; });
  return rows;
}

}  // namespace

Samples of_class(const Surface& surface, const Samples& all, std::int32_t one) {
  std::vector<std::int32_t> faces, ids;
  std::vector<Vec3> barycentric;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all.classes[k] != one) continue;
    faces.push_back(all.faces[k]);
    barycentric.push_back(all.barycentric[k]);
    ids.push_back(all.ids[k]);
  }
  Samples result = bind_samples(surface, faces, barycentric, ids);
  const auto c = static_cast<std::size_t>(one);
  if (c < all.report.classes.size()) result.report.energy = all.report.classes[c].energy;
  return result;
}

Samples joined(const Surface& surface, const Samples& before, std::span<const Samples> parts) {
  std::vector<std::int32_t> faces, ids, classes;
  std::vector<Vec3> barycentric;
  for (const Row& row : in_order(before, parts)) {
    const Samples& part = parts[static_cast<std::size_t>(row.of_class)];
    faces.push_back(part.faces[row.index]);
    barycentric.push_back(part.barycentric[row.index]);
    ids.push_back(part.ids[row.index]);
    classes.push_back(row.of_class);
  }
  return bind_samples(surface, faces, barycentric, ids, classes);
}

}  // namespace dapple
