// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <dapple/errors.hpp>
#include <dapple/image.hpp>
#include <dapple/surface.hpp>
#include <string>

namespace dapple {

/// "name[index]", for messages that name the first offender.
inline std::string entry(const char* name, std::size_t index) {
  return std::string(name) + "[" + std::to_string(index) + "]";
}

/// A number with enough digits to recognise it.
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

/// \throw ArgumentError naming the first index outside the surface's faces
void check_face_indices(const char* name, std::span<const std::int32_t> faces,
                        const Surface& surface);

/// \throw ArgumentError naming the first site that is not finite or whose face is out of range
void check_sites(const Surface& surface, const Sites& sites);

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

/// \throw ArgumentError unless there is a row for each face, naming the first texture coordinate
/// that is not finite or beyond 1e6
void check_uv(const Surface& surface, std::span<const FaceUv> uv);

/// \throw ArgumentError naming the first value that is not finite or negative; if it has no pixel,
/// not one value for each, or is 0 everywhere
void check_image(const char* name, const Image& image);

}  // namespace dapple
