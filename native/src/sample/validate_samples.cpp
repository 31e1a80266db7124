// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample/validate_samples.hpp"

#include "base/validate.hpp"
#include "surface/validate_surface.hpp"

namespace dapple {

void check_samples(const Surface& surface, const Samples& samples, const std::string& owner) {
  check_bound_sites(owner, surface, {samples.positions, samples.faces, samples.barycentric});
  check_lengths(samples, owner);
}

void check_lengths(const Samples& samples, const std::string& owner) {
  const auto check_length = [&](const char* name, std::size_t length) {
    check_same_length((owner + "." + name).c_str(), length, (owner + ".positions").c_str(),
                      samples.size());
  };
  check_length("normals", samples.normals.size());
  check_length("ids", samples.ids.size());
  check_length("classes", samples.classes.size());
  if (!samples.fade.empty()) check_length("fade", samples.fade.size());
}

}  // namespace dapple
