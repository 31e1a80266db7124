// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/validate_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/validate.hpp"

namespace dapple {
namespace {

constexpr double kFarthestUv = 1e6;     // larger values cannot resolve pixels
constexpr double kSumTolerance = 1e-4;  // errors of single-precision storage are far smaller
constexpr double kElsewhere = 1e-6;     // of the surface's size: more is not a rounding error
constexpr double kCoordinates = 1e-12;  // of the coordinates: likewise

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

/// A site whose position does not match its barycentric coordinates.
struct Elsewhere {
  std::size_t site;
  double distance;
};

/// \pre the rows belong to faces of the surface
std::optional<Elsewhere> first_elsewhere(const Surface& surface, const Sites& sites) {
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const Vec3& x = sites.positions[k];
    const double distance = (x - surface.point(sites.faces[k], sites.barycentric[k])).norm();
    const double rounding =
        kElsewhere * std::sqrt(surface.area()) + kCoordinates * x.cwiseAbs().maxCoeff();
    if (!(distance <= rounding)) return Elsewhere{k, distance};
  }
  return std::nullopt;
}

}  // namespace

void check_sites(const Surface& surface, const Sites& sites) {
  check_same_length("faces", sites.faces.size(), "positions", sites.size());
  if (!sites.barycentric.empty())
    check_same_length("barycentric", sites.barycentric.size(), "positions", sites.size());
  check_finite("positions", sites.positions);
  check_face_indices("faces", sites.faces, surface.face_count());
}

void check_binding(const std::string& owner, const Surface& surface,
                   std::span<const std::int32_t> faces, std::span<const Vec3> barycentric) {
  const std::string prefix = owner.empty() ? "" : owner + ".";
  check_same_length((prefix + "barycentric").c_str(), barycentric.size(),
                    (prefix + "faces").c_str(), faces.size());
  check_face_indices((prefix + "faces").c_str(), faces, surface.face_count());
  check_barycentric(prefix + "barycentric", barycentric);
}

void check_bound_sites(const std::string& owner, const Surface& surface, const Sites& sites) {
  check_bound_sites(owner, std::array{&surface}, sites);
}

void check_bound_sites(const std::string& owner, std::span<const Surface* const> frames,
                       const Sites& sites) {
  const std::string positions = owner + ".positions";
  check_same_length((owner + ".faces").c_str(), sites.faces.size(), positions.c_str(),
                    sites.size());
  check_binding(owner, *frames.front(), sites.faces, sites.barycentric);
  check_finite(positions.c_str(), sites.positions);
  const std::optional<Elsewhere> found = first_elsewhere(*frames.front(), sites);
  const auto fits = [&](const Surface* frame) { return !first_elsewhere(*frame, sites); };
  if (found && std::ranges::none_of(frames.subspan(1), fits))
    throw ArgumentError(
        entry(positions.c_str(), found->site) + " is " + number(found->distance) +
        " away from the point of its face and barycentric coordinates: it belongs to "
        "another surface");
}

void check_hints(const Surface& surface, std::span<const Vec3> points,
                 std::span<const std::int32_t> hints) {
  check_finite("points", points);
  if (hints.empty()) return;
  check_same_length("hints", hints.size(), "points", points.size());
  check_face_indices("hints", hints, surface.face_count());
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

}  // namespace dapple
