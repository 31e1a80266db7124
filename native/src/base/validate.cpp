// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/validate.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

namespace dapple {
std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

void check_faces(std::span<const Face> faces, std::size_t vertex_count) {
  if (faces.empty()) throw SurfaceError("faces is empty: a surface needs at least one triangle");
  for (std::size_t k = 0; k < faces.size(); ++k)
    for (const std::int32_t v : faces[k])
      if (v < 0 || static_cast<std::size_t>(v) >= vertex_count)
        throw SurfaceError(entry("faces", k) + " has vertex index " + std::to_string(v) +
                           ", outside 0.." +
                           std::to_string(static_cast<long long>(vertex_count) - 1));
}

void check_face_indices(const char* name, std::span<const std::int32_t> faces,
                        std::size_t face_count) {
  for (std::size_t k = 0; k < faces.size(); ++k)
    if (faces[k] < 0 || static_cast<std::size_t>(faces[k]) >= face_count)
      throw ArgumentError(entry(name, k) + " is " + std::to_string(faces[k]) +
                          ", outside the surface's faces 0.." + std::to_string(face_count - 1));
}

void check_same_length(const char* name, std::size_t length, const char* other,
                       std::size_t expected) {
  if (length != expected)
    throw ArgumentError(std::string(name) + " has " + std::to_string(length) + " entries and " +
                        other + " has " + std::to_string(expected) + ": they must match");
}

void check_positive(const char* name, double value) {
  if (!std::isfinite(value) || !(value > 0.0))
    throw ArgumentError(std::string(name) + " is " + number(value) + ": it must be finite and > 0");
}

void check_none_locked(const char* name, const Sites& locked, const char* why) {
  if (locked.size() > 0)
    throw ArgumentError(std::string(name) + " holds " + std::to_string(locked.size()) +
                        " sites: it must be empty, " + why);
}

void check_count(const std::string& name, std::size_t count) {
  if (count > kMostSamples)
    throw ArgumentError(name + " is " + std::to_string(count) + ": it must be in 0.." +
                        std::to_string(kMostSamples));
}

void check_ids_left(std::int64_t last, std::size_t more) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (last + static_cast<std::int64_t>(more) > kMost)
    throw ArgumentError("ids go up to " + std::to_string(last) + ": " + std::to_string(more) +
                        " more new ids would exceed " + std::to_string(kMost));
}

void check_pixels(const char* name, std::size_t rows, std::size_t columns) {
  if (rows > 0 && columns > kMostPixels / rows)
    throw ArgumentError(std::string(name) + " has " + std::to_string(rows) + " rows and " +
                        std::to_string(columns) + " columns: at most " +
                        std::to_string(kMostPixels) + " pixels are possible");
}

void check_image(const char* name, const Image& image) {
  if (image.rows == 0 || image.columns == 0)
    throw ArgumentError(std::string(name) + " has " + std::to_string(image.rows) + " rows and " +
                        std::to_string(image.columns) + " columns: at least one pixel is needed");
  check_pixels(name, image.rows, image.columns);
  check_same_length(name, image.values.size(), "rows * columns", image.rows * image.columns);
  for (std::size_t k = 0; k < image.values.size(); ++k)
    if (!std::isfinite(image.values[k]) || image.values[k] < 0.0)
      throw ArgumentError(std::string(name) + "[" + std::to_string(k / image.columns) + ", " +
                          std::to_string(k % image.columns) + "] is " + number(image.values[k]) +
                          ": it must be finite and >= 0");
  if (*std::max_element(image.values.begin(), image.values.end()) <= 0.0)
    throw ArgumentError(std::string(name) + " is 0 everywhere: nothing can be placed");
}

}  // namespace dapple
