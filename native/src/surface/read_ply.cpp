// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "surface/mesh_builder.hpp"
#include "surface/mesh_readers.hpp"

namespace dapple {
namespace {

std::string text(std::size_t k) { return std::to_string(k); }

enum class Number {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat,
  kDouble
};

std::size_t size_of(Number kind) {
  constexpr std::array<std::size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(kind)];
}

struct Property {
  std::string name;
  Number kind;
  std::optional<Number> length = {};  // type of the length of a list
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
      {"long", Number::kInt64},    {"int64", Number::kInt64},   {"ulong", Number::kUint64},
      {"uint64", Number::kUint64}, {"float", Number::kFloat},   {"float32", Number::kFloat},
      {"double", Number::kDouble}, {"float64", Number::kDouble}};
  return kNumbers;
}

[[noreturn]] void refuse_header(const Lines& lines) {
  lines.refuse("of its header is wrong: " + quoted(lines.line));
}

/// Also accepts the names of C and numpy: uint8_t, UInt8.
Number number_named(const Lines& lines, std::string_view name) {
  std::string small(name);
  for (char& c : small)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (small.size() > 2 && small.ends_with("_t")) small.resize(small.size() - 2);
  const auto found = ply_numbers().find(small);
  if (found == ply_numbers().end()) refuse_header(lines);
  return found->second;
}

Form form_named(const Lines& lines, std::string_view name) {
  if (name == "ascii") return Form::kText;
  if (name == "binary_little_endian") return Form::kLittle;
  if (name == "binary_big_endian") return Form::kBig;
  refuse_header(lines);
}

/// Adds a line of the header that is not a comment.
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
    throw ReadError("is not a PLY file: it does not begin with 'ply'");
  PlyHeader header;
  while (true) {
    if (!lines.next()) throw ReadError("its header has no end");
    if (lines.words[0] == "end_header") break;
    add_line(lines, header);
  }
  if (header.form == Form::kNone) throw ReadError("its header has no format");
  return header;
}

/// Reads the numbers after the header in sequence.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, Form form) : form_(form), left_(bytes), lines_(bytes) {}

  /// The smallest size of a number in bytes.
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
      throw ReadError("has " + quoted(lines_.words[next_]) + " instead of a number");
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
      case Number::kInt64:
        return as<std::int64_t>(bytes);
      case Number::kUint64:
        return as<std::uint64_t>(bytes);
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
  std::size_t next_ = 0;  // word of the current line
};

/// The meaning of a number of a vertex or face.
struct Use {
  enum Kind { kOther, kPlace, kNormal, kUv, kColor } kind = kOther;
  std::size_t axis = 0;
};

Use use_named(const std::string& name) {
  static const std::map<std::string_view, Use> kUses = {{"x", {Use::kPlace, 0}},
                                                        {"y", {Use::kPlace, 1}},
                                                        {"z", {Use::kPlace, 2}},
                                                        {"nx", {Use::kNormal, 0}},
                                                        {"ny", {Use::kNormal, 1}},
                                                        {"nz", {Use::kNormal, 2}},
                                                        {"u", {Use::kUv, 0}},
                                                        {"v", {Use::kUv, 1}},
                                                        {"s", {Use::kUv, 0}},
                                                        {"t", {Use::kUv, 1}},
                                                        {"texture_u", {Use::kUv, 0}},
                                                        {"texture_v", {Use::kUv, 1}},
                                                        {"texture_s", {Use::kUv, 0}},
                                                        {"texture_t", {Use::kUv, 1}},
                                                        {"red", {Use::kColor, 0}},
                                                        {"green", {Use::kColor, 1}},
                                                        {"blue", {Use::kColor, 2}},
                                                        {"alpha", {Use::kColor, 3}},
                                                        {"r", {Use::kColor, 0}},
                                                        {"g", {Use::kColor, 1}},
                                                        {"b", {Use::kColor, 2}},
                                                        {"a", {Use::kColor, 3}},
                                                        {"diffuse_red", {Use::kColor, 0}},
                                                        {"diffuse_green", {Use::kColor, 1}},
                                                        {"diffuse_blue", {Use::kColor, 2}}};
  const auto found = kUses.find(name);
  return found == kUses.end() ? Use() : found->second;
}

/// The divisor of colors of this type; the range of floats is determined later.
double full(Number kind) {
  if (kind == Number::kFloat || kind == Number::kDouble) return 1.0;
  return kind == Number::kUint16 ? 65535.0 : 255.0;
}

/// The scalar properties of an element, sorted by meaning.
class RowReader {
 public:
  RowReader(const Element& element, bool is_face, bool by_name = false) {
    for (const Property& property : element.properties) {
      Use use = by_name ? Use() : use_named(property.name);
      if (is_face && use.kind != Use::kColor) use = {};
      uses_.push_back(use);
      axes_[use.kind] |= property.length ? 0u : 1u << use.axis;
    }
    for (std::size_t k = 0; k < uses_.size(); ++k)
      if (!has(uses_[k].kind)) uses_[k] = {};
    for (std::size_t k = 0; k < uses_.size(); ++k) {
      const Property& property = element.properties[k];
      if (uses_[k].kind == Use::kOther && !property.length)
        others.push_back({property.name, is_face, {}});
    }
  }

  /// Whether all numbers of this meaning exist.
  [[nodiscard]] bool has(Use::Kind kind) const {
    if (kind == Use::kOther) return true;
    return (axes_[kind] & (kind == Use::kUv ? 3u : 7u)) == (kind == Use::kUv ? 3u : 7u);
  }

  void begin() {
    color_ = {0.0f, 0.0f, 0.0f, kNoOpacity};
    other_ = 0;
  }
  void put(std::size_t property, Number kind, double value) {
    const Use use = uses_[property];
    switch (use.kind) {
      case Use::kPlace:
        place_[static_cast<Eigen::Index>(use.axis)] = value;
        break;
      case Use::kNormal:
        normal_[static_cast<Eigen::Index>(use.axis)] = value;
        break;
      case Use::kUv:
        uv_[static_cast<Eigen::Index>(use.axis)] = value;
        break;
      case Use::kColor:
        color_[use.axis] = channel(value / full(kind));
        break;
      case Use::kOther:
        others[other_++].values.push_back(value);
    }
  }

  [[nodiscard]] const Vec3& place() const { return place_; }
  [[nodiscard]] const Vec3& normal() const { return normal_; }
  [[nodiscard]] const Vec2& uv() const { return uv_; }
  [[nodiscard]] const Color& color() const { return color_; }

  std::vector<MeshAttribute> others = {};

 private:
  std::vector<Use> uses_;
  std::array<unsigned, 5> axes_{};
  std::size_t other_ = 0;
  Vec3 place_ = Vec3::Zero(), normal_ = Vec3::Zero();
  Vec2 uv_ = Vec2::Zero();
  Color color_{};
};

class PlyReader {
 public:
  explicit PlyReader(PlyBody body) : body_(std::move(body)) {}

  void read(const Element& element) {
    check_room(element);
    if (element.name == "vertex")
      read_vertices(element);
    else if (element.name == "face")
      read_faces(element);
    else
      read_others(element);
  }

  MeshArrays build() { return mesh_.build(); }

  /// All numbers of the rows by name.
  std::vector<MeshAttribute> read_columns(const Element& element) {
    check_room(element);
    RowReader row(element, false, true);
    for (std::size_t k = 0; k < element.count; ++k) check_at(k), read_row(element, row);
    return std::move(row.others);
  }

 private:
  void check_room(const Element& element) const {
    std::size_t least = 0;
    for (const Property& property : element.properties)
      least += body_.least(property.length.value_or(property.kind));
    if (least == 0 ? element.count > 0 : element.count > body_.bytes_left() / least)
      throw ReadError("is too short for " + text(element.count) + " '" + element.name + "'");
  }

  void read_vertices(const Element& element) {
    RowReader row(element, false);
    if (row.has(Use::kNormal)) mesh_.normals.owner = Owner::kVertices;
    if (row.has(Use::kUv)) mesh_.uv.owner = Owner::kVertices;
    if (row.has(Use::kColor)) mesh_.colors.owner = Owner::kVertices;
    for (std::size_t k = 0; k < element.count; ++k) {
      check_at(k);
      read_row(element, row);
      mesh_.vertices.push_back(row.place());
      if (row.has(Use::kNormal)) mesh_.normals.values.push_back(row.normal());
      if (row.has(Use::kUv)) mesh_.uv.values.push_back(row.uv());
      if (row.has(Use::kColor)) mesh_.colors.values.push_back(row.color());
    }
    keep(row);
  }

  void read_faces(const Element& element) {
    RowReader row(element, true);
    std::vector<Color> colors;
    for (std::size_t k = 0; k < element.count; ++k) {
      check_at(k);
      corners_.clear();
      wedge_.clear();
      read_row(element, row);
      mesh_.add_polygon(corners_);
      add_wedge();
      if (row.has(Use::kColor)) colors.push_back(row.color());
    }
    if (some_wedge_) {
      wedges_.owner = Owner::kCorners;
      mesh_.uv = std::move(wedges_);
    }
    if (!colors.empty() && mesh_.colors.owner != Owner::kVertices)
      mesh_.colors = {Owner::kPolygons, std::move(colors)};
    keep(row);
  }

  /// Adds the texture coordinates of the corners of a face, if it has some.
  void add_wedge() {
    const bool fits = !wedge_.empty() && wedge_.size() == 2 * corners_.size();
    some_wedge_ = some_wedge_ || fits;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      wedges_.at_corners.push_back(fits ? static_cast<std::int64_t>(wedges_.values.size())
                                        : std::int64_t{-1});
      if (fits) wedges_.values.emplace_back(wedge_[2 * k], wedge_[2 * k + 1]);
    }
  }

  void read_others(const Element& element) {
    RowReader row(element, true);
    for (std::size_t k = 0; k < element.count; ++k) {
      check_at(k);
      corners_.clear();
      wedge_.clear();
      read_row(element, row);
      if (element.name == "tristrips") add_strip();
    }
  }

  /// Adds a triangle for each three consecutive vertices, every second one reversed; -1 starts a
  /// new strip.
  void add_strip() {
    std::size_t start = 0;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      if (corners_[k] == -1) start = k + 1;
      if (k < start + 2) continue;
      const bool odd = (k - start) % 2 == 1;
      const std::array<std::int64_t, 3> corners = {corners_[k - (odd ? 1 : 2)],
                                                   corners_[k - (odd ? 2 : 1)], corners_[k]};
      if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
        mesh_.add_polygon(corners);
    }
  }

  void keep(RowReader& row) {
    for (MeshAttribute& attribute : row.others) mesh_.attributes.push_back(std::move(attribute));
  }

  void read_row(const Element& element, RowReader& row) {
    row.begin();
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.length)
        read_list(element, property, *property.length);
      else
        row.put(k, property.kind, body_.take(property.kind));
    }
  }

  void read_list(const Element& element, const Property& property, Number counted_as) {
    const double length = body_.take(counted_as);
    if (!(length >= 0.0 && length <= static_cast<double>(body_.bytes_left())))
      throw ReadError("has a list of length " + std::to_string(length) + " in '" + element.name +
                      "'");
    const bool is_indices = property.name == "vertex_indices" || property.name == "vertex_index";
    const bool is_wedge = property.name == "texcoord";
    for (double k = 0.0; k < length; k += 1.0) {
      const double value = body_.take(property.kind);
      if (is_indices) corners_.push_back(whole(value));
      if (is_wedge) wedge_.push_back(value);
    }
  }

  static std::int64_t whole(double value) {
    if (!(std::abs(value) < 0x1p53) || value != std::floor(value))
      throw ReadError("has " + std::to_string(value) + " as an index");
    return static_cast<std::int64_t>(value);
  }

  PlyBody body_;
  MeshBuilder mesh_;
  Rows<Vec2> wedges_;
  std::vector<std::int64_t> corners_;
  std::vector<double> wedge_;
  bool some_wedge_ = false;
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

MeshArrays mesh_of(std::string_view bytes) {
  Lines lines(bytes);
  const PlyHeader header = read_header(lines);
  check_coordinates(vertex_element(header));
  PlyReader reader(PlyBody(lines.rest(), header.form));
  for (const Element& element : header.elements) reader.read(element);
  return reader.build();
}

std::vector<MeshAttribute> columns_of(std::string_view bytes) {
  Lines lines(bytes);
  const PlyHeader header = read_header(lines);
  PlyReader reader(PlyBody(lines.rest(), header.form));
  for (const Element& element : header.elements) {
    std::vector<MeshAttribute> columns = reader.read_columns(element);
    if (element.name == "vertex") return columns;
  }
  throw ReadError("has no element 'vertex'");
}

/// The position of the data after the header of a binary file.
std::size_t end_of_header(std::string_view bytes) {
  constexpr std::string_view kEnd = "\rend_header\r";
  const std::size_t found = bytes.find(kEnd);
  return found == bytes.npos ? 0 : found + kEnd.size();
}

bool begins_binary(std::string_view bytes) {
  const std::size_t at = bytes.substr(0, 4096).find("format binary_");
  return at != bytes.npos && at < bytes.find("end_header");
}

template <typename Result>
Result from_lines(std::string_view bytes, Result (*read)(std::string_view)) {
  bytes = without_mark(bytes);
  if (!begins_binary(bytes)) return read(PlainText(bytes).view());
  if (bytes.substr(0, 4) != "ply\r" || bytes.substr(4, 1) == "\n") return read(bytes);
  const std::size_t end = end_of_header(bytes);
  std::string changed = with_line_feeds(bytes.substr(0, end));
  changed += bytes.substr(end);
  return read(changed);
}

}  // namespace

MeshArrays read_ply(std::string_view bytes) { return from_lines(bytes, mesh_of); }

std::vector<MeshAttribute> read_ply_columns(std::string_view bytes) {
  return from_lines(bytes, columns_of);
}

}  // namespace dapple
