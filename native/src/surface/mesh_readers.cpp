// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_readers.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <dapple/limits.hpp>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "surface/mesh_text.hpp"

namespace dapple {
namespace {

// ---- all formats ----

std::string text(std::size_t k) { return std::to_string(k); }

void check_room(std::size_t vertices, std::size_t faces) {
  if (vertices > kMostVertices || faces > kMostSurfaceFaces)
    throw ReadError("holds " + text(vertices) + " vertices and " + text(faces) +
                    " triangles: at most " + text(kMostVertices) + " and " +
                    text(kMostSurfaceFaces) + " are possible");
}

/// Polygons, cut into fans; whether their vertices are there is known at the end.
class Faces {
 public:
  /// \param corners indices from 0 on; fewer than three make no face
  void add(const std::vector<std::int64_t>& corners) {
    for (std::size_t k = 2; k < corners.size(); ++k)
      fans_.push_back({corners[0], corners[k - 1], corners[k]});
  }

  /// \throw ReadError naming the first triangle with a vertex that is not there
  [[nodiscard]] std::vector<Face> checked(std::size_t vertices) const {
    check_room(vertices, fans_.size());
    std::vector<Face> faces;
    faces.reserve(fans_.size());
    for (const auto& fan : fans_) {
      for (const std::int64_t v : fan)
        if (v < 0 || static_cast<std::uint64_t>(v) >= vertices)
          throw ReadError("face " + text(faces.size()) + " has vertex " + std::to_string(v) +
                          ", outside 0.." +
                          std::to_string(static_cast<std::int64_t>(vertices) - 1));
      faces.push_back({static_cast<std::int32_t>(fan[0]), static_cast<std::int32_t>(fan[1]),
                       static_cast<std::int32_t>(fan[2])});
    }
    return faces;
  }

 private:
  std::vector<std::array<std::int64_t, 3>> fans_;
};

/// Numbers from the word `first` on.
Vec3 point_in(const Lines& lines, std::size_t first) {
  Vec3 point;
  if (lines.words.size() < first + 3) lines.refuse("has fewer than 3 coordinates");
  for (std::size_t k = 0; k < 3; ++k)
    if (!parse(lines.words[first + k], point[static_cast<Eigen::Index>(k)]))
      lines.refuse("has " + quoted(lines.words[first + k]) + " for a coordinate");
  return point;
}

std::int64_t index_in(const Lines& lines, std::string_view word) {
  std::int64_t index = 0;
  if (!parse(word, index)) lines.refuse("has " + quoted(word) + " for an index");
  return index;
}

// ---- OFF ----

/// Whether a word is OFF with letters before it that say what follows the coordinates.
bool is_off(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N"})
    if (word.substr(0, prefix.size()) == prefix) word.remove_prefix(prefix.size());
  return word == "OFF";
}

/// The numbers of vertices and faces.
std::array<std::size_t, 2> off_counts(Lines& lines) {
  if (!lines.next() || !is_off(lines.words[0]))
    throw ReadError("is no OFF file in text: it does not begin with OFF");
  lines.words.erase(lines.words.begin());
  if (lines.words.empty() && !lines.next()) throw ReadError("ends after its first line");
  std::array<std::size_t, 2> counts{};
  if (lines.words.size() < 2) lines.refuse("has no numbers of vertices and faces");
  for (std::size_t k = 0; k < 2; ++k)
    if (!parse(lines.words[k], counts[k]))
      lines.refuse("has " + quoted(lines.words[k]) + " for a number of vertices or faces");
  return counts;
}

// ---- OBJ ----

/// A line that ends with a backslash goes on in the next.
bool next_statement(Lines& lines) {
  if (!lines.next()) return false;
  std::vector<std::string_view> words;
  while (lines.words.back() == "\\") {
    lines.words.pop_back();
    words.insert(words.end(), lines.words.begin(), lines.words.end());
    if (!lines.next()) break;
  }
  lines.words.insert(lines.words.begin(), words.begin(), words.end());
  return !lines.words.empty();
}

/// From 0 on, of v, v/vt, v//vn or v/vt/vn; they count from 1, or back from the last.
std::int64_t obj_index(const Lines& lines, std::string_view word, std::size_t vertices) {
  const std::int64_t index = index_in(lines, word.substr(0, word.find('/')));
  if (index == 0) lines.refuse("has the index 0, and OBJ counts from 1");
  return index > 0 ? index - 1 : static_cast<std::int64_t>(vertices) + index;
}

// ---- PLY ----

enum class Number { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::size_t size_of(Number kind) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(kind)];
}

struct Property {
  std::string name;
  Number kind;
  std::optional<Number> length = {};  // of a list: what its length is
};

struct Element {
  std::string name;
  std::size_t count;
  std::vector<Property> properties = {};
};

enum class Form { kNone, kText, kLittle, kBig };

struct PlyHeader {
  Form form = Form::kNone;
  std::vector<Element> elements = {};
};

const std::map<std::string_view, Number>& ply_numbers() {
  static const std::map<std::string_view, Number> kNumbers = {
      {"char", Number::kInt8},     {"int8", Number::kInt8},     {"uchar", Number::kUint8},
      {"uint8", Number::kUint8},   {"short", Number::kInt16},   {"int16", Number::kInt16},
      {"ushort", Number::kUint16}, {"uint16", Number::kUint16}, {"int", Number::kInt32},
      {"int32", Number::kInt32},   {"uint", Number::kUint32},   {"uint32", Number::kUint32},
      {"float", Number::kFloat},   {"float32", Number::kFloat}, {"double", Number::kDouble},
      {"float64", Number::kDouble}};
  return kNumbers;
}

[[noreturn]] void refuse_header(const Lines& lines) {
  lines.refuse("of its header is wrong: " + quoted(lines.line));
}

Number number_named(const Lines& lines, std::string_view name) {
  const auto found = ply_numbers().find(name);
  if (found == ply_numbers().end()) refuse_header(lines);
  return found->second;
}

Form form_named(const Lines& lines, std::string_view name) {
  if (name == "ascii") return Form::kText;
  if (name == "binary_little_endian") return Form::kLittle;
  if (name == "binary_big_endian") return Form::kBig;
  refuse_header(lines);
}

/// A line of the header that says something.
void add_line(const Lines& lines, PlyHeader& header) {
  const auto& words = lines.words;
  if (words[0] == "format" && words.size() == 3) {
    header.form = form_named(lines, words[1]);
  } else if (words[0] == "element" && words.size() == 3) {
    std::size_t count = 0;
    if (!parse(words[2], count)) refuse_header(lines);
    header.elements.push_back({std::string(words[1]), count});
  } else if (words[0] == "property" && !header.elements.empty() && words.size() == 3) {
    header.elements.back().properties.push_back(
        {std::string(words[2]), number_named(lines, words[1])});
  } else if (words[0] == "property" && !header.elements.empty() && words.size() == 5 &&
             words[1] == "list") {
    header.elements.back().properties.push_back(
        {std::string(words[4]), number_named(lines, words[3]), number_named(lines, words[2])});
  } else if (words[0] != "comment" && words[0] != "obj_info") {
    refuse_header(lines);
  }
}

PlyHeader read_header(Lines& lines) {
  if (!lines.next() || lines.number != 1 || lines.words[0] != "ply")
    throw ReadError("is no PLY file: it does not begin with 'ply'");
  PlyHeader header;
  while (true) {
    if (!lines.next()) throw ReadError("its header has no end");
    if (lines.words[0] == "end_header") break;
    add_line(lines, header);
  }
  if (header.form == Form::kNone) throw ReadError("its header has no format");
  return header;
}

/// The numbers behind the header, one after the other.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, Form form) : form_(form), left_(bytes), lines_(bytes) {}

  /// What a number takes at least.
  [[nodiscard]] std::size_t least(Number kind) const {
    return form_ == Form::kText ? 1 : size_of(kind);
  }
  [[nodiscard]] std::size_t bytes_left() const {
    return form_ == Form::kText ? lines_.rest().size() + lines_.line.size() : left_.size();
  }

  double take(Number kind) { return form_ == Form::kText ? take_word() : take_bytes(kind); }

 private:
  double take_word() {
    while (next_ >= lines_.words.size()) {
      if (!lines_.next()) throw ReadError("ends too early");
      next_ = 0;
    }
    double value = 0.0;
    if (!parse(lines_.words[next_], value))
      throw ReadError("has " + quoted(lines_.words[next_]) + " for a number");
    ++next_;
    return value;
  }

  double take_bytes(Number kind) {
    const std::size_t size = size_of(kind);
    if (left_.size() < size) throw ReadError("ends too early");
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), left_.data(), size);
    left_.remove_prefix(size);
    if ((form_ == Form::kBig) == (std::endian::native == std::endian::little))
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    return value_of(bytes, kind);
  }

  template <typename T>
  static double as(const std::array<char, 8>& bytes) {
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return static_cast<double>(value);
  }

  static double value_of(const std::array<char, 8>& bytes, Number kind) {
    switch (kind) {
      case Number::kInt8:
        return as<std::int8_t>(bytes);
      case Number::kUint8:
        return as<std::uint8_t>(bytes);
      case Number::kInt16:
        return as<std::int16_t>(bytes);
      case Number::kUint16:
        return as<std::uint16_t>(bytes);
      case Number::kInt32:
        return as<std::int32_t>(bytes);
      case Number::kUint32:
        return as<std::uint32_t>(bytes);
      case Number::kFloat:
        return as<float>(bytes);
      case Number::kDouble:
        break;
    }
    return as<double>(bytes);
  }

  Form form_;
  std::string_view left_;
  Lines lines_;
  std::size_t next_ = 0;  // word of the present line
};

class PlyReader {
 public:
  PlyReader(PlyBody body, MeshArrays& mesh) : body_(std::move(body)), mesh_(mesh) {}

  void read(const Element& element) {
    std::size_t least = 0;
    for (const Property& property : element.properties)
      least += body_.least(property.length.value_or(property.kind));
    if (least == 0 ? element.count > 0 : element.count > body_.bytes_left() / least)
      throw ReadError("is too short for " + text(element.count) + " '" + element.name + "'");
    for (std::size_t row = 0; row < element.count; ++row) read_row(element);
  }

  [[nodiscard]] const Faces& faces() const { return faces_; }

 private:
  void read_row(const Element& element) {
    const bool is_vertex = element.name == "vertex";
    Vec3 point = Vec3::Zero();
    for (const Property& property : element.properties) {
      if (property.length) {
        read_list(element, property, *property.length);
        continue;
      }
      const double value = body_.take(property.kind);
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
        point[property.name[0] - 'x'] = value;
    }
    if (is_vertex) mesh_.vertices.push_back(point);
  }

  void read_list(const Element& element, const Property& property, Number counted_as) {
    const double length = body_.take(counted_as);
    if (!(length >= 0.0 && length <= static_cast<double>(body_.bytes_left())))
      throw ReadError("has a list of length " + std::to_string(length) + " in '" + element.name +
                      "'");
    const bool is_face = element.name == "face" &&
                         (property.name == "vertex_indices" || property.name == "vertex_index");
    std::vector<std::int64_t> corners;
    for (double k = 0.0; k < length; k += 1.0) {
      const double value = body_.take(property.kind);
      if (is_face) corners.push_back(whole(value));
    }
    faces_.add(corners);
  }

  static std::int64_t whole(double value) {
    if (!(std::abs(value) < 0x1p53) || value != std::floor(value))
      throw ReadError("has " + std::to_string(value) + " for an index");
    return static_cast<std::int64_t>(value);
  }

  PlyBody body_;
  MeshArrays& mesh_;
  Faces faces_;
};

const Element& vertex_element(const PlyHeader& header) {
  for (const Element& element : header.elements)
    if (element.name == "vertex") return element;
  throw ReadError("has no element 'vertex'");
}

void check_coordinates(const Element& vertex) {
  for (const char* axis : {"x", "y", "z"})
    if (std::none_of(
            vertex.properties.begin(), vertex.properties.end(),
            [&](const Property& property) { return property.name == axis && !property.length; }))
      throw ReadError(std::string("has vertices without ") + axis);
}

// ---- STL ----

/// The bits of a place, so that what is no number is equal to itself; 0 and -0 are one place.
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

/// Gives each place one vertex.
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

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50, kStlNormal = 12;

/// The number of triangles of a binary file; none if it is no such file.
std::optional<std::size_t> stl_triangles(std::string_view bytes) {
  if (bytes.size() < kStlHeader) return std::nullopt;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 4; ++k)
    count |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[80 + k])) << (8 * k);
  const std::size_t size = kStlHeader + kStlTriangle * count;
  const bool is_text = bytes.substr(0, 5) == "solid";
  return bytes.size() == size || (bytes.size() > size && !is_text) ? std::optional(count)
                                                                   : std::nullopt;
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

void read_binary_stl(std::string_view bytes, std::size_t count, Places& places, Faces& faces) {
  for (std::size_t f = 0; f < count; ++f) {
    const std::string_view triangle = bytes.substr(kStlHeader + f * kStlTriangle + kStlNormal);
    faces.add({places.at(stl_point(triangle)), places.at(stl_point(triangle.substr(12))),
               places.at(stl_point(triangle.substr(24)))});
  }
}

void read_text_stl(std::string_view bytes, Places& places, Faces& faces) {
  Lines lines(bytes);
  std::vector<std::int64_t> corners;
  while (lines.next()) {
    if (lines.words[0] == "vertex") corners.push_back(places.at(point_in(lines, 1)));
    if (lines.words[0] != "endloop") continue;
    if (corners.size() < 3) lines.refuse("ends a loop of fewer than 3 vertices");
    faces.add(corners);
    corners.clear();
  }
  if (!corners.empty()) throw ReadError("ends within a loop");
}

}  // namespace

MeshArrays read_off(std::string_view bytes) {
  Lines lines(bytes, '#');
  MeshArrays mesh;
  const auto [vertices, polygons] = off_counts(lines);
  while (mesh.vertices.size() < vertices) {
    if (!lines.next())
      throw ReadError("ends after " + text(mesh.vertices.size()) + " of " + text(vertices) +
                      " vertices");
    mesh.vertices.push_back(point_in(lines, 0));
  }
  Faces faces;
  std::vector<std::int64_t> corners;
  for (std::size_t f = 0; f < polygons; ++f) {
    if (!lines.next())
      throw ReadError("ends after " + text(f) + " of " + text(polygons) + " faces");
    const std::int64_t size = index_in(lines, lines.words[0]);
    if (size < 0 || static_cast<std::size_t>(size) >= lines.words.size())
      lines.refuse("has " + text(lines.words.size() - 1) + " corners and says " +
                   std::to_string(size));
    corners.clear();
    for (std::size_t k = 1; k <= static_cast<std::size_t>(size); ++k)
      corners.push_back(index_in(lines, lines.words[k]));
    faces.add(corners);
  }
  mesh.faces = faces.checked(mesh.vertices.size());
  return mesh;
}

MeshArrays read_obj(std::string_view bytes) {
  Lines lines(bytes, '#');
  MeshArrays mesh;
  Faces faces;
  std::vector<std::int64_t> corners;
  while (next_statement(lines)) {
    if (lines.words[0] == "v") mesh.vertices.push_back(point_in(lines, 1));
    if (lines.words[0] != "f") continue;
    corners.clear();
    for (std::size_t k = 1; k < lines.words.size(); ++k)
      corners.push_back(obj_index(lines, lines.words[k], mesh.vertices.size()));
    faces.add(corners);
  }
  mesh.faces = faces.checked(mesh.vertices.size());
  return mesh;
}

MeshArrays read_ply(std::string_view bytes) {
  Lines lines(bytes);
  const PlyHeader header = read_header(lines);
  check_coordinates(vertex_element(header));
  MeshArrays mesh;
  PlyReader reader(PlyBody(lines.rest(), header.form), mesh);
  for (const Element& element : header.elements) reader.read(element);
  mesh.faces = reader.faces().checked(mesh.vertices.size());
  return mesh;
}

MeshArrays read_stl(std::string_view bytes) {
  MeshArrays mesh;
  Places places(mesh.vertices);
  Faces faces;
  if (const auto count = stl_triangles(bytes))
    read_binary_stl(bytes, *count, places, faces);
  else if (bytes.substr(0, 5) == "solid")
    read_text_stl(bytes, places, faces);
  else
    throw ReadError(
        "is no STL file: it neither begins with 'solid' nor has the size of as many "
        "triangles as it says");
  mesh.faces = faces.checked(mesh.vertices.size());
  return mesh;
}

}  // namespace dapple
