// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <dapple/context.hpp>

namespace dapple::python {

/// Seconds by stage.
inline pybind11::dict profile_dict(const Profile& profile) {
  pybind11::dict result;
  for (std::size_t k = 0; k < kStageNames.size(); ++k) result[kStageNames[k]] = profile.seconds[k];
  return result;
}

}  // namespace dapple::python
