// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/poisson_start.hpp>

#include "class_start.hpp"

namespace dapple {

Sites random_start(const Surface& surface, std::size_t count, std::uint64_t seed) {
  return random_start({{{&surface, count}}, &surface, 0.0, seed});
}

Sites poisson_start(const Surface& surface, std::size_t count, std::uint64_t seed,
                    const Context* context) {
  return poisson_start({{{&surface, count}}, &surface, 0.0, seed}, context);
}

}  // namespace dapple
