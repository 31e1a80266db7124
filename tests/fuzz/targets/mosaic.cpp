// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/mosaic.hpp>
#include <dapple/sampler.hpp>

#include "expect.hpp"
#include "targets.hpp"

namespace dapple::fuzz {
namespace {

MosaicOptions take_mosaic_options(Bytes& bytes, const Surface& surface, std::size_t count) {
  MosaicOptions options;
  take_options(bytes, options);
  const double spacing = surface.spacing(count);
  if (bytes.one_in(2)) options.shortest_edge = 0.0;
  if (bytes.one_in(2)) options.grout = spacing * bytes.share();
  if (bytes.one_in(3)) options.thickness = spacing * bytes.share();
  if (bytes.one_in(6))
    for (std::size_t k = 0; k < count; ++k) options.insets.push_back(spacing * bytes.share());
  return options;
}

}  // namespace

void fuzz_mosaic(Bytes& bytes) {
  const Shape shape = take_shape(bytes);
  const auto surface = take_surface(bytes, shape);
  if (!surface) return;
  auto samples = take_samples(bytes, *surface, 30);
  if (bytes.one_in(2))
    samples = answer([&] {
      return sample(*surface, take_count(bytes, 30), {.optimizer = {.max_evaluations = 3}});
    });
  if (!samples) return;
  MosaicOptions options = take_mosaic_options(bytes, *surface, samples->size());
  const auto made = answer_of_threads([&](int threads) {
    options.threads = threads;
    return mosaic(*surface, *samples, options);
  });
  if (!bytes.was_wild()) {
    EXPECT_TRUE(made) << "what is plain is refused";
  }
  if (made) expect_mosaic(*surface, *made, samples->size(), options.shortest_edge);
}

}  // namespace dapple::fuzz
