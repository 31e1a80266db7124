// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <bit>
#include <optional>
#include <unordered_map>

#include "surface/mesh_builder.hpp"
#include "surface/mesh_readers.hpp"

namespace dapple {
namespace {

std::string text(std::size_t k) { return std::to_string(k); }

/// The bits of a position, so that NaN equals itself; 0 and -0 are one position.
struct PlaceKey {
  explicit PlaceKey(const Vec3& p)
      : bits{std::bit_cast<std::uint64_t>(p.x() + 0.0), std::bit_cast<std::uint64_t>(p.y() + 0.0),
             std::bit_cast<std::uint64_t>(p.z() + 0.0)} {}
  bool operator==(const PlaceKey&) const = default;

  std::array<std::uint64_t, 3> bits;
};

struct PlaceHash {
  std::size_t operator()(const PlaceKey& key) const {
    std::uint64_t hash = 0;
    for (const std::uint64_t part : key.bits)
      hash = (hash ^ part ^ (part >> 29)) * 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 32);
  }
};

/// Creates one vertex for each position.
class Places {
 public:
  explicit Places(std::vector<Vec3>& vertices) : vertices_(vertices) {}

  std::int64_t at(const Vec3& point) {
    const auto [found, is_new] =
        known_.try_emplace(PlaceKey(point), static_cast<std::int64_t>(vertices_.size()));
    if (is_new) vertices_.push_back(point);
    return found->second;
  }

 private:
  std::vector<Vec3>& vertices_;
  std::unordered_map<PlaceKey, std::int64_t, PlaceHash> known_;
};

constexpr std::size_t kHeader = 84, kTriangle = 50, kNormal = 12;
constexpr std::size_t kUnknown = 0xffffffff;  // written before the triangles are counted

/// The number of triangles that a binary file declares.
std::size_t promised(std::string_view bytes) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < 4; ++k)
    count |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[80 + k])) << (8 * k);
  return count;
}

bool exact(std::string_view bytes) {
  return bytes.size() >= kHeader && bytes.size() == kHeader + kTriangle * promised(bytes);
}

/// Whether a text begins with the keyword of STL.
bool begins_solid(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return same_word(text.substr(0, 5), "solid");
}

/// The number of triangles of a binary file. Programs that write triangles as a stream leave a
/// wrong count, so the file's size determines the number if it fits whole triangles.
std::size_t held(std::string_view bytes) {
  if (bytes.size() < kHeader)
    throw ReadError(
        "is not an STL file: it neither begins with 'solid' nor has the size of the triangles that "
        "it declares");
  const std::size_t count = promised(bytes), there = (bytes.size() - kHeader) / kTriangle;
  const bool whole = (bytes.size() - kHeader) % kTriangle == 0;
  if (whole && (there > count || count == kUnknown)) return there;
  if (there == count) return count;  // followed by less than one triangle
  throw ReadError("is not an STL file, or is cut off: it declares " + text(count) +
                  " triangles and has room for " + text(there));
}

/// Three numbers of single precision, little-endian.
Vec3 stl_point(std::string_view bytes) {
  Vec3 point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 4; ++k)
      bits |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[4 * axis + k]))
              << (8 * k);
    point[static_cast<Eigen::Index>(axis)] = std::bit_cast<float>(bits);
  }
  return point;
}

void read_binary(std::string_view bytes, std::size_t count, Places& places, MeshBuilder& mesh) {
  for (std::size_t f = 0; f < count; ++f) {
    check_at(f);
    const std::string_view triangle = bytes.substr(kHeader + f * kTriangle + kNormal);
    const std::array<std::int64_t, 3> corners = {places.at(stl_point(triangle)),
                                                 places.at(stl_point(triangle.substr(12))),
                                                 places.at(stl_point(triangle.substr(24)))};
    mesh.add_polygon(corners);
  }
}

void read_text(std::string_view bytes, Places& places, MeshBuilder& mesh) {
  Lines lines(bytes);
  std::vector<std::int64_t> corners;
  while (lines.next()) {
    if (same_word(lines.words[0], "vertex")) {
      const auto [x, y, z] = lines.numbers<3>(1, "coordinate");
      corners.push_back(places.at({x, y, z}));
    }
    if (!same_word(lines.words[0], "endloop")) continue;
    if (corners.size() < 3) lines.refuse("ends a loop of fewer than 3 vertices");
    mesh.add_polygon(corners);
    corners.clear();
  }
  if (!corners.empty()) throw ReadError("ends within a loop");
}

/// Whether the file is a text file; a binary header may also begin with 'solid'.
bool is_text(std::string_view bytes) {
  return begins_solid(bytes) && bytes.substr(0, 400).find('\0') == bytes.npos;
}

}  // namespace

MeshArrays read_stl(std::string_view bytes) {
  MeshBuilder mesh;
  Places places(mesh.vertices);
  if (exact(bytes)) {
    read_binary(bytes, promised(bytes), places, mesh);
  } else {
    const PlainText plain(bytes);
    if (is_text(plain.view()))
      read_text(plain.view(), places, mesh);
    else
      read_binary(bytes, held(bytes), places, mesh);
  }
  return mesh.build();
}

}  // namespace dapple
