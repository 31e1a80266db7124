// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_writers.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>

#include "base/progress.hpp"
#include "base/validate.hpp"

namespace dapple {
namespace {

void add(std::string& text, double value) {
  std::array<char, 32> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + 32, value).ptr);
}

/// Call add(row) for each row.
template <typename Row, typename Add>
void for_each_row(std::span<const Row> rows, const Add& add) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    check_at(k);
    add(rows[k]);
  }
}

void add_place(std::string& text, const Vec3& p) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (axis > 0) text += ' ';
    add(text, p[axis]);
  }
  text += '\n';
}

/// \param first the number of the first vertex
void add_face(std::string& text, const char* before, const Face& face, std::int32_t first) {
  const auto& [a, b, c] = face;
  text += before + std::to_string(a + first) + " " + std::to_string(b + first) + " " +
          std::to_string(c + first) + "\n";
}

/// Append a value in little-endian order.
template <typename T>
void add_bytes(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

void add_single(std::string& bytes, const Vec3& p) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) add_bytes(bytes, static_cast<float>(p[axis]));
}

void check_single(std::span<const Vec3> vertices) {
  for (std::size_t k = 0; k < vertices.size(); ++k)
    if (!(vertices[k].cwiseAbs().maxCoeff() <= std::numeric_limits<float>::max()))
      throw ArgumentError(entry("vertices", k) + " has the coordinate " +
                          number(vertices[k].cwiseAbs().maxCoeff()) +
                          ", too large for STL: write .ply, .off or .obj");
}

}  // namespace

std::string to_off(std::span<const Vec3> vertices, std::span<const Face> faces) {
  std::string text =
      "OFF\n" + std::to_string(vertices.size()) + " " + std::to_string(faces.size()) + " 0\n";
  for_each_row(vertices, [&](const Vec3& p) { add_place(text, p); });
  for_each_row(faces, [&](const Face& f) { add_face(text, "3 ", f, 0); });
  return text;
}

std::string to_obj(std::span<const Vec3> vertices, std::span<const Face> faces) {
  std::string text;
  for_each_row(vertices, [&](const Vec3& p) {
    text += "v ";
    add_place(text, p);
  });
  for_each_row(faces, [&](const Face& f) { add_face(text, "f ", f, 1); });
  return text;
}

std::string to_ply(std::span<const Vec3> vertices, std::span<const Face> faces) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
      std::to_string(faces.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for_each_row(vertices, [&](const Vec3& p) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) add_bytes(bytes, p[axis]);
  });
  for_each_row(faces, [&](const Face& face) {
    add_bytes(bytes, static_cast<std::uint8_t>(3));
    for (const std::int32_t v : face) add_bytes(bytes, v);
  });
  return bytes;
}

std::string to_stl(std::span<const Vec3> vertices, std::span<const Face> faces) {
  check_single(vertices);
  std::string bytes(80, '\0');
  add_bytes(bytes, static_cast<std::uint32_t>(faces.size()));
  for_each_row(faces, [&](const Face& face) {
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return vertices[static_cast<std::size_t>(face[k])];
    };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).stableNormalized();
    add_single(bytes, normal.allFinite() ? normal : Vec3(Vec3::Zero()));
    for (std::size_t k = 0; k < 3; ++k) add_single(bytes, corner(k));
    add_bytes(bytes, std::uint16_t{0});
  });
  return bytes;
}

}  // namespace dapple
