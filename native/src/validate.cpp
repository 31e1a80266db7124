// SPDX-License-Identifier: GPL-3.0-or-later
#include "validate.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <dapple/samples.hpp>
#include <limits>

namespace dapple {
namespace {

constexpr double kFarthestUv = 1e6;     // beyond that pixels lose their digits
constexpr double kSumTolerance = 1e-4;  // single-precision storage stays far below this
constexpr double kElsewhere = 1e-6;     // of the surface's size: farther is no rounding ...
constexpr double kCoordinates = 1e-12;  // ... nor is this much of the coordinates

void check_barycentric(const std::string& name, std::span<const Vec3> rows) {
  check_finite(name.c_str(), rows);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].minCoeff() < -kSumTolerance)
      throw ArgumentError(entry(name.c_str(), k) + " has the negative coordinate " +
                          number(rows[k].minCoeff()));
    if (std::abs(rows[k].sum() - 1.0) > kSumTolerance)
      throw ArgumentError(entry(name.c_str(), k) + " sums to " + number(rows[k].sum()) +
                          ": it must sum to 1");
  }
}

/// \pre the rows belong to faces of the surface
void check_places(const std::string& owner, const Surface& surface, const Sites& sites) {
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const Vec3& x = sites.positions[k];
    const double distance = (x - surface.point(sites.faces[k], sites.barycentric[k])).norm();
    const double rounding =
        kElsewhere * std::sqrt(surface.area()) + kCoordinates * x.cwiseAbs().maxCoeff();
    if (!(distance <= rounding))
      throw ArgumentError(entry((owner + ".positions").c_str(), k) + " is " + number(distance) +
                          " away from where its face and barycentric coordinates are: it is of "
                          "another surface");
  }
}

}  // namespace

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
  if (!sites.barycentric.empty())
    check_same_length("barycentric", sites.barycentric.size(), "positions", sites.size());
  check_finite("positions", sites.positions);
  check_face_indices("faces", sites.faces, surface);
}

void check_binding(const std::string& owner, const Surface& surface,
                   std::span<const std::int32_t> faces, std::span<const Vec3> barycentric) {
  const std::string prefix = owner.empty() ? "" : owner + ".";
  check_same_length((prefix + "barycentric").c_str(), barycentric.size(),
                    (prefix + "faces").c_str(), faces.size());
  check_face_indices((prefix + "faces").c_str(), faces, surface);
  check_barycentric(prefix + "barycentric", barycentric);
}

void check_bound_sites(const std::string& owner, const Surface& surface, const Sites& sites) {
  const std::string positions = owner + ".positions";
  check_same_length((owner + ".faces").c_str(), sites.faces.size(), positions.c_str(),
                    sites.size());
  check_binding(owner, surface, sites.faces, sites.barycentric);
  check_finite(positions.c_str(), sites.positions);
  check_places(owner, surface, sites);
}

void check_samples(const Surface& surface, const Samples& samples, const std::string& owner) {
  check_bound_sites(owner, surface, {samples.positions, samples.faces, samples.barycentric});
  const auto check_length = [&](const char* name, std::size_t length) {
    check_same_length((owner + "." + name).c_str(), length, (owner + ".positions").c_str(),
                      samples.size());
  };
  check_length("normals", samples.normals.size());
  check_length("ids", samples.ids.size());
  check_length("classes", samples.classes.size());
  if (!samples.fade.empty()) check_length("fade", samples.fade.size());
}

void check_hints(const Surface& surface, std::span<const Vec3> points,
                 std::span<const std::int32_t> hints) {
  check_finite("points", points);
  if (hints.empty()) return;
  check_same_length("hints", hints.size(), "points", points.size());
  check_face_indices("hints", hints, surface);
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
                        " more, each above all before, would exceed " + std::to_string(kMost));
}

void check_threads(int threads) {
  if (threads < 0 || threads > kMostThreads)
    throw ArgumentError("threads is " + std::to_string(threads) + ": it must be in 0.." +
                        std::to_string(kMostThreads));
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
