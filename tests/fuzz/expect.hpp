// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <dapple/errors.hpp>
#include <dapple/mosaic.hpp>
#include <dapple/planar_sampler.hpp>
#include <dapple/refine.hpp>
#include <dapple/remesh.hpp>
#include <dapple/stipple.hpp>
#include <invariants.hpp>
#include <optional>

#include "input.hpp"

namespace dapple::fuzz {

// What holds for every input is what tells a fault from an answer. A fuzzer takes a failed
// expectation for a crash: main.cpp has GoogleTest throw.

/// What a verb returns; none if it refused by one of its own errors. Any other is a finding.
template <class Verb>
auto answer(const Verb& verb) -> std::optional<decltype(verb())> {
  try {
    return verb();
  } catch (const ArgumentError& error) {
    EXPECT_STRNE(error.what(), "");
  } catch (const FileError& error) {
    EXPECT_STRNE(error.what(), "");
  }
  return std::nullopt;
}

[[nodiscard]] bool same_bytes(const Samples& a, const Samples& b);
[[nodiscard]] bool same_bytes(const std::vector<Samples>& a, const std::vector<Samples>& b);
[[nodiscard]] bool same_bytes(const PlanarSamples& a, const PlanarSamples& b);
[[nodiscard]] bool same_bytes(const Mosaic& a, const Mosaic& b);
[[nodiscard]] bool same_bytes(const RemeshResult& a, const RemeshResult& b);
[[nodiscard]] bool same_bytes(const NextRemesh& a, const NextRemesh& b);
[[nodiscard]] bool same_bytes(const Stipples& a, const Stipples& b);
[[nodiscard]] bool same_bytes(const Refined& a, const Refined& b);

/// The answer of one thread, which two threads must give as well.
template <class Verb>
auto answer_of_threads(const Verb& verb) {
  auto one = answer([&] { return verb(1); });
  const auto two = answer([&] { return verb(2); });
  EXPECT_EQ(one.has_value(), two.has_value()) << "one number of threads is refused";
  if (one && two) {
    EXPECT_TRUE(same_bytes(*one, *two)) << "two threads differ";
  }
  return one;
}

/// Samples of the surface, as many as were asked for, none where the density is 0.
void expect_samples(const Surface& surface, const Samples& samples, std::size_t count);

/// All but their number and where the density is 0.
void expect_valid(const Surface& surface, const Samples& samples);

/// What was minimized never rises, and is a number.
void expect_descent(const Report& report);

/// Numbers that a report must have, whatever the samples are.
void expect_measured(const Report& report);

/// No sample is where the density is 0, but for locked ones.
/// \param locked ids of those
void expect_where_dense(const Surface& surface, const Samples& samples,
                        std::span<const std::int32_t> locked = {});

/// Who says that it converged has no sample without a cell, but for locked ones.
void expect_filled(const Surface& surface, const Samples& samples, Cells cells = Cells::kConnected,
                   std::span<const std::int32_t> locked = {});

/// Those of a class.
[[nodiscard]] std::size_t count_of(std::span<const std::int32_t> classes, std::int32_t wanted);

/// Area that cells may lack or have too much: half the last digits of all edges, times some clips.
[[nodiscard]] double area_rounding(const Surface& surface);

/// Polygons of at least three vertices, tile after tile; no tile larger than its cell unless the
/// tolerance has moved its corners.
void expect_mosaic(const Surface& surface, const Mosaic& mosaic, std::size_t count,
                   double tolerance);

}  // namespace dapple::fuzz
