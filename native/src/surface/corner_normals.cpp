// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/corner_normals.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/elementary.hpp"
#include "base/parallel.hpp"
#include "base/progress.hpp"
#include "base/vectors.hpp"

namespace dapple {
namespace {

constexpr std::size_t kGrain = 4096;  // faces per chunk
constexpr double kRounding =
    1e-9;  // of a cosine, so that an edge of exactly this angle is not sharper
constexpr std::int32_t kNone = -1;
constexpr double kShort = 0x1p-100,
                 kLong = 0x1p100;  // fourth powers neither underflow nor overflow
constexpr double kSame = 1e-4;     // difference of equal normals in single precision

std::int32_t corner_of(std::int32_t half_edge) { return half_edge % 3; }
std::int32_t next_in_face(std::int32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
std::int32_t previous_in_face(std::int32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// The welded vertex that a half-edge starts from.
std::int32_t start_of(const OrderedSurface& mesh, std::int32_t h) {
  return mesh.welded(mesh.corners(face_of(h))[static_cast<std::size_t>(corner_of(h))]);
}

/// The other half-edge of an edge whose two faces have the same orientation.
std::optional<std::int32_t> twin_of(const OrderedSurface& mesh, std::int32_t h) {
  const std::int32_t twin = mesh.next_around(h);
  if (twin == h || mesh.next_around(twin) != h) return std::nullopt;
  if (start_of(mesh, twin) != start_of(mesh, next_in_face(h)) ||
      start_of(mesh, next_in_face(twin)) != start_of(mesh, h))
    return std::nullopt;
  return twin;
}

/// Whether the faces of an edge differ by more than the angle. A face without area has no normal;
/// the faces beside it are compared instead.
bool is_sharp(const OrderedSurface& mesh, std::int32_t h, std::int32_t twin, double cosine) {
  const auto normal = [&](std::int32_t k) -> const Vec3& {
    return mesh.geometry(face_of(k)).normal;
  };
  const auto differ = [&](const Vec3& a, const Vec3& b) {
    return !a.isZero(0.0) && !b.isZero(0.0) && a.dot(b) < cosine;
  };
  if (normal(h).isZero(0.0)) return !normal(twin).isZero(0.0) && is_sharp(mesh, twin, h, cosine);
  if (!normal(twin).isZero(0.0)) return differ(normal(h), normal(twin));
  for (std::int32_t k = next_in_face(twin); k != twin; k = next_in_face(k))
    if (const auto beyond = twin_of(mesh, k); beyond && differ(normal(h), normal(*beyond)))
      return true;
  return false;
}

/// \param hard per half-edge, whether its edge is hard
template <typename Hard>
std::vector<std::uint8_t> hard_edges(const OrderedSurface& mesh, const Hard& hard) {
  std::vector<std::uint8_t> result(mesh.face_count(), 0);
  parallel_chunks(result.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      for (std::int32_t k = 0; k < 3; ++k) {
        const std::int32_t h = half_edge(nth_face(f), k);
        const auto twin = twin_of(mesh, h);
        if (!twin || hard(h, *twin)) result[f] |= static_cast<std::uint8_t>(1U << k);
      }
  });
  return result;
}

double limit_of(double sharp_angle) { return direction(sharp_angle / 360.0).cosine - kRounding; }

/// Which corners of a surface share a normal.
class Fans {
 public:
  explicit Fans(const OrderedSurface& mesh) : mesh_(mesh) {}

  /// The corners that share the normal of this one, as the half-edges that start there; sorted.
  void collect(std::int32_t corner, std::vector<std::int32_t>& fan) const {
    fan.assign(1, corner);
    std::int32_t next = left_of(corner);
    for (; next != kNone && next != corner; next = left_of(next)) fan.push_back(next);
    if (next == kNone)
      for (next = right_of(corner); next != kNone; next = right_of(next)) fan.push_back(next);
    std::sort(fan.begin(), fan.end());
  }

 private:
  [[nodiscard]] bool is_hard(std::int32_t h) const {
    return (mesh_.shading().hard[as_index(face_of(h))] >> corner_of(h)) & 1U;
  }
  /// The corner at the same vertex beyond the edge that ends there, or beyond the one that starts
  /// there; kNone if that edge is hard.
  [[nodiscard]] std::int32_t left_of(std::int32_t corner) const {
    const std::int32_t edge = previous_in_face(corner);
    return is_hard(edge) ? kNone : mesh_.next_around(edge);
  }
  [[nodiscard]] std::int32_t right_of(std::int32_t corner) const {
    return is_hard(corner) ? kNone : next_in_face(mesh_.next_around(corner));
  }

  const OrderedSurface& mesh_;
};

/// Scales a vector to a length of about 1 by a power of two, so that products of coordinates
/// neither overflow nor lose digits. Of most lengths they do not, and no digit depends on it.
Vec3 of_length_one_or_so(const Vec3& v) {
  const double largest = v.cwiseAbs().maxCoeff();
  if ((largest > kShort && largest < kLong) || !(largest > 0.0)) return v;
  return v * std::ldexp(1.0, -std::ilogb(largest));
}

/// Sine and cosine of the angle of a face at one of its corners, both times the same length.
Direction directed_angle_at(const OrderedSurface& mesh, std::int32_t corner) {
  const Face& v = mesh.corners(face_of(corner));
  const auto vertex = [&](std::int32_t h) -> const Vec3& {
    return mesh.vertex(v[static_cast<std::size_t>(corner_of(h))]);
  };
  const Vec3 ahead = of_length_one_or_so(vertex(next_in_face(corner)) - vertex(corner));
  const Vec3 behind = of_length_one_or_so(vertex(previous_in_face(corner)) - vertex(corner));
  return {.cosine = ahead.dot(behind), .sine = ahead.cross(behind).norm()};
}

/// The angles of faces at many corners.
std::vector<double> angles_at(const OrderedSurface& mesh, std::span<const std::int32_t> corners) {
  std::vector<double> sines(corners.size()), cosines(corners.size()), angles(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Direction angle = directed_angle_at(mesh, corners[k]);
    sines[k] = angle.sine;
    cosines[k] = angle.cosine;
  }
  angles_of(sines, cosines, angles);
  return angles;
}

}  // namespace

double angle_at(const OrderedSurface& mesh, std::int32_t corner) {
  const Direction angle = directed_angle_at(mesh, corner);
  return angle_of(angle.sine, angle.cosine);
}

std::shared_ptr<const Shading> shading_by_angle(const OrderedSurface& mesh, double sharp_angle) {
  const double cosine = limit_of(sharp_angle);
  return std::make_shared<const Shading>(Shading{
      sharp_angle,
      hard_edges(
          mesh, [&](std::int32_t h, std::int32_t twin) { return is_sharp(mesh, h, twin, cosine); }),
      {}});
}

std::shared_ptr<const Shading> shading_of_normals(const OrderedSurface& mesh, double sharp_angle,
                                                  std::span<const Vec3> corners) {
  const double cosine = limit_of(sharp_angle);
  std::vector<Vec3> given(corners.size());
  for_each_vector(given.size(), [&](std::size_t h) {
    given[h] = corners[3 * static_cast<std::size_t>(mesh.original_face(nth_face(h / 3))) + h % 3];
  });
  const auto normal = [&](std::int32_t h) -> const Vec3& {
    return given[static_cast<std::size_t>(h)];
  };
  const auto same = [&](std::int32_t a, std::int32_t b) {
    return (normal(a) - normal(b)).squaredNorm() < kSame * kSame;
  };
  const auto unknown = [&](std::int32_t h) {
    return normal(h).isZero(0.0) || normal(next_in_face(h)).isZero(0.0);
  };
  std::vector<std::uint8_t> hard = hard_edges(mesh, [&](std::int32_t h, std::int32_t twin) {
    return unknown(h) || unknown(twin)
               ? is_sharp(mesh, h, twin, cosine)
               : !same(h, next_in_face(twin)) || !same(next_in_face(h), twin);
  });
  return std::make_shared<const Shading>(Shading{sharp_angle, std::move(hard), std::move(given)});
}

CornerNormals::CornerNormals(const OrderedSurface& mesh, std::span<const std::int32_t> faces)
    : mesh_(mesh), fan_(3 * mesh.face_count(), -1) {
  const Fans fans(mesh);
  std::vector<std::int32_t> members, fan;
  std::vector<std::size_t> ends = {0};
  for (std::size_t f = 0; f < faces.size(); ++f) {
    check_at(f);
    if (f > 0 && faces[f] == faces[f - 1]) continue;
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t corner = half_edge(mesh.ordered_face(faces[f]), k);
      if (fan_[static_cast<std::size_t>(corner)] >= 0 || is_given(corner)) continue;
      fans.collect(corner, fan);
      for (const std::int32_t member : fan)
        fan_[static_cast<std::size_t>(member)] = static_cast<std::int32_t>(ends.size() - 1);
      members.insert(members.end(), fan.begin(), fan.end());
      ends.push_back(members.size());
    }
  }
  normals_.resize(ends.size() - 1);
  parallel_chunks(normals_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const auto corners = std::span(members).subspan(ends[begin], ends[end] - ends[begin]);
    const std::vector<double> angles = angles_at(mesh, corners);
    for (std::size_t k = begin, m = 0; k < end; ++k) {
      Vec3 sum = Vec3::Zero();
      for (; m < ends[k + 1] - ends[begin]; ++m)
        sum += angles[m] * mesh.geometry(face_of(corners[m])).normal;
      sum.stableNormalize();
      normals_[k] = sum;
    }
  });
}

const Vec3& CornerNormals::at(OrderedFace face, std::int32_t corner) const {
  const std::int32_t h = half_edge(face, corner);
  if (is_given(h)) return mesh_.shading().given[static_cast<std::size_t>(h)];
  return normals_[static_cast<std::size_t>(fan_[static_cast<std::size_t>(h)])];
}

Vec3 CornerNormals::direction_at(OrderedFace face, std::int32_t corner) const {
  return direction_of(face, at(face, corner));
}

Vec3 CornerNormals::between(OrderedFace face, const Vec3& weights) const {
  Vec3 sum = Vec3::Zero();
  for (std::int32_t c = 0; c < 3; ++c) sum += weights[c] * at(face, c);
  return direction_of(face, sum);
}

Vec3 CornerNormals::direction_of(OrderedFace face, const Vec3& sum) const {
  const Vec3& own = mesh_.geometry(face).normal;
  return sum.norm() > 1e-6 ? sum.normalized() : own.isZero(0.0) ? Vec3(0, 0, 1) : own;
}

bool CornerNormals::is_given(std::int32_t corner) const {
  const std::vector<Vec3>& given = mesh_.shading().given;
  return !given.empty() && !given[static_cast<std::size_t>(corner)].isZero(0.0);
}

}  // namespace dapple
