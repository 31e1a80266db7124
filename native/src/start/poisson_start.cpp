// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/poisson_start.hpp>

#include "base/validate.hpp"
#include "start/class_start.hpp"

namespace dapple {

Sites random_start(const Surface& surface, std::size_t count, std::uint64_t seed) {
  check_count("count", count);
  return random_start({{{&surface, count}}, &surface, 0.0, seed});
}

Sites poisson_start(const Surface& surface, std::size_t count, std::uint64_t seed,
                    Context* context) {
  check_count("count", count);
  return poisson_start({{{&surface, count}}, &surface, 0.0, seed}, context);
}

}  // namespace dapple
