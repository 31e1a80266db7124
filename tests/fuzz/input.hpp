// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <concepts>
#include <dapple/option_tables.hpp>
#include <dapple/samples.hpp>
#include <dapple/types.hpp>
#include <optional>
#include <shapes.hpp>

#include "bytes.hpp"

namespace dapple::fuzz {

using test::Shape;

// What a verb is given, made of bytes: ordinary for most of them, now and then beyond every rule.

/// A mesh of a family, of at most some 400 faces: perhaps stretched, scaled, far from the origin,
/// with repeated vertices, damaged vertices and faces, and a density.
[[nodiscard]] Shape take_shape(Bytes& bytes);

/// The shape as a surface, welded in some way; none where it is refused.
[[nodiscard]] std::optional<Surface> take_surface(Bytes& bytes, const Shape& shape);

/// Values for a density of the surface, of one kind; none: 1 everywhere.
struct Values {
  DensityAt at = DensityAt::kVertices;
  std::vector<double> values = {};

  [[nodiscard]] Density density() const { return {at, values}; }
};
[[nodiscard]] Values take_values(Bytes& bytes, std::size_t vertices, std::size_t faces);

/// The vertices a little later: bent, moved, stretched, or damaged.
[[nodiscard]] std::vector<Vec3> take_frame(Bytes& bytes, const std::vector<Vec3>& vertices);

/// Sites on the surface, also at corners, on edges and at the same place.
[[nodiscard]] Sites take_sites(Bytes& bytes, const Surface& surface, int count);

/// The same with normals, ids and classes; they may break a rule.
[[nodiscard]] std::optional<Samples> take_samples(Bytes& bytes, const Surface& surface,
                                                  int most = 40);

/// A picture of at most 12 x 12 pixels, in half of the cases with parts that are 0.
[[nodiscard]] Image take_image(Bytes& bytes, double most = 1.0);

/// In half of the cases, parts of a picture become 0.
void take_zeros(Bytes& bytes, Image& image);

/// A number of samples; rarely none.
[[nodiscard]] std::size_t take_count(Bytes& bytes, int most = 60);

/// An option's value: mostly the default, else one that may make sense, rarely a wild one.
double take_option(Bytes& bytes, const Range& range, double value);
std::int64_t take_option(Bytes& bytes, const Range& range, std::int64_t value);

/// Options of any struct with a table (option.hpp). The evaluations stay few, and the threads are
/// not chosen here: targets compare numbers of them.
template <class Struct>
void take_options(Bytes& bytes, Struct& options) {
  for_each_option(options, [&]<class Owner, class Value>(const Option<Owner, Value>& option,
                                                         Value& value) {
    const std::string_view name = option.name;
    if (name == "threads") return;
    if constexpr (std::same_as<Value, bool>)
      value = bytes.one_in(4) ? !value : value;
    else if constexpr (std::is_enum_v<Value>)
      value = bytes.one_in(4) ? choices_of(value)[1].value : value;
    else if constexpr (std::same_as<Value, std::uint64_t>)
      value = bytes.one_in(4) ? bytes.whole() : bytes.byte();
    else if constexpr (std::integral<Value>)
      value =
          static_cast<Value>(take_option(bytes, option.range, static_cast<std::int64_t>(value)));
    else
      value = take_option(bytes, option.range, value);
    if constexpr (std::same_as<Value, int>) {
      if (name == "max_evaluations") value = std::min(value, 30);
      if (name == "sweeps") value = std::min(value, 2);
      if (name == "history") value = std::min(value, 50);
    }
  });
}

}  // namespace dapple::fuzz
