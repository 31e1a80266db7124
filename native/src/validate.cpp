// SPDX-License-Identifier: GPL-3.0-or-later
#include "validate.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace dapple {
namespace {

constexpr double kFarthestUv = 1e6;  // beyond that pixels lose their digits

}  // namespace

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

void check_face_indices(const char* name, std::span<const std::int32_t> faces,
                        const Surface& surface) {
  for (std::size_t k = 0; k < faces.size(); ++k)
    if (faces[k] < 0 || static_cast<std::size_t>(faces[k]) >= surface.face_count())
      throw ArgumentError(entry(name, k) + " is " + std::to_string(faces[k]) +
                          ", outside the surface's faces 0.." +
                          std::to_string(surface.face_count() - 1));
}

void check_same_length(const char* name, std::size_t length, const char* other,
                       std::size_t expected) {
  if (length != expected)
    throw ArgumentError(std::string(name) + " has " + std::to_string(length) + " entries and " +
                        other + " has " + std::to_string(expected) + ": they must match");
}

void check_uv(const Surface& surface, std::span<const FaceUv> uv) {
  check_same_length("uv", uv.size(), "faces", surface.face_count());
  for (std::size_t f = 0; f < uv.size(); ++f)
    for (std::size_t c = 0; c < 3; ++c)
      if (!uv[f][c].allFinite() || uv[f][c].cwiseAbs().maxCoeff() > kFarthestUv)
        throw ArgumentError("uv[" + std::to_string(f) + ", " + std::to_string(c) + "] is (" +
                            number(uv[f][c].x()) + ", " + number(uv[f][c].y()) +
                            "): it must be finite and within 1e6 of 0");
}

void check_positive(const char* name, double value) {
  if (!std::isfinite(value) || !(value > 0.0))
    throw ArgumentError(std::string(name) + " is " + number(value) + ": it must be finite and > 0");
}

void check_sites(const Surface& surface, const Sites& sites) {
  check_same_length("faces", sites.faces.size(), "positions", sites.size());
  check_finite("positions", sites.positions);
  check_face_indices("faces", sites.faces, surface);
}

void check_image(const char* name, const Image& image) {
  if (image.rows == 0 || image.columns == 0)
    throw ArgumentError(std::string(name) + " has " + std::to_string(image.rows) + " rows and " +
                        std::to_string(image.columns) + " columns: at least one pixel is needed");
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
