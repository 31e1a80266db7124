// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace dapple {

/// Ask for a line of memory before it is needed.
inline void prefetch(const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#else
  static_cast<void>(address);
#endif
}

}  // namespace dapple
