// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/types.hpp>
#include <span>
#include <string>

namespace dapple {

/// "name[index]", for messages that name the first offender.
inline std::string entry(const char* name, std::size_t index) {
  return std::string(name) + "[" + std::to_string(index) + "]";
}

/// A number with enough digits to recognize it.
[[nodiscard]] std::string number(double value);

/// \throw Error naming the first point with a coordinate that is not finite
template <typename Error = ArgumentError>
void check_finite(const char* name, std::span<const Vec3> points) {
  for (std::size_t k = 0; k < points.size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(points[k][axis]))
        throw Error(entry(name, k) + " is not finite: coordinate " + std::to_string(axis) + " is " +
                    number(points[k][axis]));
}

/// \throw SurfaceError naming the first face with a missing vertex; if there is no face
void check_faces(std::span<const Face> faces, std::size_t vertex_count);

/// \throw ArgumentError naming the first index outside the surface's faces
void check_face_indices(const char* name, std::span<const std::int32_t> faces,
                        std::size_t face_count);

/// For options that a function ignores.
/// \param why there may be none
/// \throw ArgumentError if there are locked sites
void check_none_locked(const char* name, const Sites& locked, const char* why);

/// \throw ArgumentError for more samples than kMostSamples
void check_count(const std::string& name, std::size_t count);

/// \throw ArgumentError unless there are `more` ids above the last
void check_ids_left(std::int64_t last, std::size_t more);

/// \throw ArgumentError for more of them than kMostPixels
void check_pixels(const char* name, std::size_t rows, std::size_t columns);

/// \throw ArgumentError if the lengths differ
void check_same_length(const char* name, std::size_t length, const char* other,
                       std::size_t expected);

/// \throw Error unless value is finite and >= low
template <typename Error = ArgumentError>
void check_at_least(const char* name, double value, double low) {
  if (!std::isfinite(value) || value < low)
    throw Error(std::string(name) + " is " + number(value) +
                ": it must be finite and >= " + number(low));
}

/// \throw ArgumentError unless value is finite and > 0
void check_positive(const char* name, double value);

/// \throw ArgumentError naming the first value that is not finite or negative; if it has no pixel,
/// not one value for each, or is 0 everywhere
void check_image(const char* name, const Image& image);

}  // namespace dapple
