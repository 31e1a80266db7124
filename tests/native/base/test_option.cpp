// SPDX-License-Identifier: GPL-3.0-or-later
#include <dapple/errors.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/option_tables.hpp>
#include <dapple/population.hpp>
#include <dapple/refine_image.hpp>
#include <dapple/stipple.hpp>
#include <dapple/window_tracker.hpp>
#include <limits>
#include <set>

#include "throws.hpp"

namespace dapple::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Options of a struct; the tests set one at a time.
template <class Options>
class EveryOption : public testing::Test {};

using Structs =
    testing::Types<OptimizerOptions, SampleOptions, ClassOptions, TrackerOptions, PopulationOptions,
                   WindowOptions, StippleOptions, MosaicOptions, ImageOptions>;
TYPED_TEST_SUITE(EveryOption, Structs);

template <class Options, class Value>
void expect_refused(const char* name, Value bad) {
  Options options;
  for_each_option(options, [&](const auto& option, auto& value) {
    if constexpr (std::is_same_v<std::remove_reference_t<decltype(value)>, Value>)
      if (std::string(option.name) == name) value = bad;
  });
  expect_message<ArgumentError>([&] { check_options(options); },
                                {std::string(name) + " is ", "it must be"});
}

TYPED_TEST(EveryOption, IsInItsRangeByDefault) { EXPECT_NO_THROW(check_options(TypeParam())); }

TYPED_TEST(EveryOption, IsThereOnceWithASentence) {
  std::set<std::string> names;
  const TypeParam options;
  for_each_option(options, [&](const auto& option, const auto&) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_TRUE(std::string(option.documentation).ends_with(".")) << option.name;
  });
  EXPECT_FALSE(names.empty());
}

TYPED_TEST(EveryOption, IsNamedWhenItIsOutOfRange) {
  const TypeParam options;
  for_each_option(
      options, []<class Owner, class Value>(const Option<Owner, Value>& option, const Value&) {
        if constexpr (std::same_as<Value, double>) {
          expect_refused<TypeParam, Value>(option.name, kNan);
          if (option.range.min > -kInfinite)
            expect_refused<TypeParam, Value>(option.name, option.range.min - 1.0);
          if (option.range.max < kInfinite)
            expect_refused<TypeParam, Value>(option.name, kInfinite);
          if (option.range.open) expect_refused<TypeParam, Value>(option.name, option.range.min);
        } else if constexpr (std::same_as<Value, int>) {
          const int min = static_cast<int>(option.range.min);
          expect_refused<TypeParam, Value>(option.name, min - 1);
          if (option.range.max < kFinite)
            expect_refused<TypeParam, Value>(option.name, std::numeric_limits<int>::max());
        }
      });
}

TEST(Options, SayTheirRange) {
  const auto expect = [](const auto& options, const char* message) {
    expect_message<ArgumentError>([&] { check_options(options); }, {message});
  };
  expect(OptimizerOptions{.tolerance = -1.0}, "tolerance is -1: it must be finite and >= 0");
  expect(OptimizerOptions{.max_slide = -1.0}, "max_slide is -1: it must be >= 0");
  expect(OptimizerOptions{.patience = 0}, "patience is 0: it must be in 1..2147483647");
  expect(TrackerOptions{.pattern_strength = 1.5}, "pattern_strength is 1.5: it must be in 0..1");
  expect(SampleOptions{.threads = 5000}, "threads is 5000: it must be in 0..4096");
  expect(ImageOptions{.texels = 0.0}, "texels is 0: it must be finite and > 0");
}

TEST(Options, WithinAnotherStructAreChecked) {
  expect_message<ArgumentError>(
      [] { check_options(WindowOptions{.tracker = {.optimizer = {.history = -1}}}); },
      {"history is -1"});
}

}  // namespace
}  // namespace dapple::test
