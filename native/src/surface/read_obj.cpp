// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_builder.hpp"
#include "surface/mesh_readers.hpp"

namespace dapple {
namespace {

/// A line that ends with a backslash continues in the next one.
bool next_statement(Lines& lines) {
  const auto goes_on = [&] { return !lines.words.empty() && lines.words.back().back() == '\\'; };
  if (!lines.next()) return false;
  std::vector<std::string_view> words;
  while (goes_on()) {
    lines.words.back().remove_suffix(1);
    if (lines.words.back().empty()) lines.words.pop_back();
    words.insert(words.end(), lines.words.begin(), lines.words.end());
    if (!lines.next_line()) break;
  }
  lines.words.insert(lines.words.begin(), words.begin(), words.end());
  return true;
}

/// The index counted from 0. In the file, indices count from 1, or negative ones back from the last
/// element.
std::int64_t obj_index(const Lines& lines, std::string_view word, std::size_t count) {
  const auto index = lines.number_in<std::int64_t>(word, "an index");
  if (index == 0) lines.refuse("has the index 0, and OBJ counts from 1");
  return index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
}

/// Removes and returns the part of v/vt/vn up to the next slash.
std::string_view next_part(std::string_view& word) {
  const std::size_t end = std::min(word.find('/'), word.size());
  const std::string_view part = word.substr(0, end);
  word.remove_prefix(std::min(end + 1, word.size()));
  return part;
}

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : lines_(text, '#') {}

  MeshArrays read() {
    while (next_statement(lines_))
      if (!lines_.words.empty()) read_statement();
    set_owner(mesh_.uv, some_uv_);
    set_owner(mesh_.normals, some_normals_);
    if (some_colors_) mesh_.colors.owner = Owner::kVertices;
    return mesh_.build();
  }

 private:
  void read_statement() {
    const std::string_view kind = lines_.words[0];
    if (kind == "v") read_vertex();
    if (kind == "vt") read_uv();
    if (kind == "vn") {
      const auto [x, y, z] = lines_.numbers<3>(1, "coordinate");
      mesh_.normals.values.emplace_back(x, y, z);
    }
    if (kind == "f" || kind == "fo") read_face();
  }

  /// Six numbers are a position and a color.
  void read_vertex() {
    const auto [x, y, z] = lines_.numbers<3>(1, "coordinate");
    mesh_.vertices.emplace_back(x, y, z);
    Color color = {1.0f, 1.0f, 1.0f, kNoOpacity};
    if (lines_.words.size() == 7) {
      if (!some_colors_) mesh_.colors.values.resize(mesh_.vertices.size() - 1, color);
      some_colors_ = true;
      for (std::size_t k = 0; k < 3; ++k)
        color[k] = channel(lines_.number_in<double>(lines_.words[4 + k], "a color"));
    }
    if (some_colors_) mesh_.colors.values.push_back(color);
  }

  void read_uv() {
    const double u = lines_.numbers<1>(1, "coordinate")[0];
    const double v = lines_.words.size() > 2 ? lines_.numbers<1>(2, "coordinate")[0] : 0.0;
    mesh_.uv.values.emplace_back(u, v);
  }

  void read_face() {
    corners_.clear();
    for (std::size_t k = 1; k < lines_.words.size(); ++k) {
      std::string_view word = lines_.words[k];
      corners_.push_back(obj_index(lines_, next_part(word), mesh_.vertices.size()));
      add_index(next_part(word), mesh_.uv, some_uv_);
      add_index(word, mesh_.normals, some_normals_);
    }
    mesh_.add_polygon(corners_);
  }

  template <typename T>
  void add_index(std::string_view word, Rows<T>& rows, bool& some) const {
    rows.at_corners.push_back(word.empty() ? -1 : obj_index(lines_, word, rows.values.size()));
    some = some || !word.empty();
  }

  /// Indices are ignored if no corner has one.
  template <typename T>
  static void set_owner(Rows<T>& rows, bool some) {
    if (some && !rows.values.empty()) rows.owner = Owner::kCorners;
  }

  Lines lines_;
  MeshBuilder mesh_;
  std::vector<std::int64_t> corners_;
  bool some_uv_ = false, some_normals_ = false, some_colors_ = false;
};

}  // namespace

MeshArrays read_obj(std::string_view bytes) {
  const PlainText plain(bytes);
  return ObjReader(plain.view()).read();
}

}  // namespace dapple
