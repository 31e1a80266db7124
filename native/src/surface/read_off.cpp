// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_builder.hpp"
#include "surface/mesh_readers.hpp"

namespace dapple {
namespace {

std::string text(std::size_t k) { return std::to_string(k); }

/// The first word of a file. Its letters say which data follow the coordinates of a vertex.
struct OffHeader {
  bool uv = false, colors = false, normals = false;
  std::size_t vertices = 0, polygons = 0;
};

bool take(std::string_view& word, std::string_view prefix) {
  if (!same_word(word.substr(0, prefix.size()), prefix)) return false;
  word.remove_prefix(prefix.size());
  return true;
}

bool is_count(std::string_view word) {
  std::size_t count = 0;
  return parse(word, count);
}

[[noreturn]] void refuse_start() {
  throw ReadError("is not an OFF text file: it does not begin with OFF");
}

/// Takes the word OFF, which some programs omit and others join with the first count.
void take_keyword(Lines& lines, OffHeader& header) {
  std::string_view& word = lines.words[0];
  if (is_count(word)) return;
  header.uv = take(word, "st");
  header.colors = take(word, "c");
  header.normals = take(word, "n");
  if (!take(word, "off") || (!word.empty() && !is_count(word))) refuse_start();
  if (word.empty()) lines.words.erase(lines.words.begin());
  if (!lines.words.empty() && same_word(lines.words[0], "binary"))
    throw ReadError("is a binary OFF file: write it as text");
}

OffHeader read_off_header(Lines& lines) {
  OffHeader header;
  if (!lines.next()) refuse_start();
  take_keyword(lines, header);
  if (lines.words.empty() && !lines.next()) throw ReadError("ends after its first line");
  if (lines.words.size() < 2) lines.refuse("has no numbers of vertices and faces");
  header.vertices = lines.number_in<std::size_t>(lines.words[0], "a number of vertices or faces");
  header.polygons = lines.number_in<std::size_t>(lines.words[1], "a number of vertices or faces");
  return header;
}

/// The color in three or four words.
Color color_in(const Lines& lines, std::size_t first, std::size_t count) {
  Color color = {0.0f, 0.0f, 0.0f, kNoOpacity};
  for (std::size_t k = 0; k < count; ++k)
    color[k] = channel(lines.number_in<double>(lines.words[first + k], "a color"));
  return color;
}

void read_vertex(const Lines& lines, const OffHeader& header, MeshBuilder& mesh) {
  const auto [x, y, z] = lines.numbers<3>(0, "coordinate");
  mesh.vertices.emplace_back(x, y, z);
  std::size_t first = 3, last = lines.words.size();
  if (header.normals && last >= first + 3) {
    const auto [nx, ny, nz] = lines.numbers<3>(first, "number");
    mesh.normals.values.emplace_back(nx, ny, nz);
    first += 3;
  }
  if (header.uv && last >= first + 2) {
    last -= 2;
    const auto [u, v] = lines.numbers<2>(last, "number");
    mesh.uv.values.emplace_back(u, v);
  }
  if (header.colors && last >= first + 3)
    mesh.colors.values.push_back(color_in(lines, first, std::min<std::size_t>(last - first, 4)));
}

/// Values are kept only if every vertex has some.
template <typename T>
void keep_at_vertices(Rows<T>& rows, std::size_t vertices) {
  if (!rows.values.empty() && rows.values.size() == vertices) rows.owner = Owner::kVertices;
}

/// Adds the words of the next lines to those of a face that some programs break over several.
/// Changes nothing if a line then has more words than the face: it is the next one.
void join_lines(Lines& lines, std::size_t words) {
  Lines ahead = lines;
  std::vector<std::string_view> joined = lines.words;
  while (joined.size() < words && ahead.next())
    joined.insert(joined.end(), ahead.words.begin(), ahead.words.end());
  if (joined.size() != words) return;
  ahead.words = std::move(joined);
  lines = std::move(ahead);
}

void read_polygon(Lines& lines, std::vector<std::int64_t>& corners) {
  const auto size = lines.number_in<std::int64_t>(lines.words[0], "an index");
  const bool broken = size > 0 && static_cast<std::size_t>(size) >= lines.words.size();
  if (broken) join_lines(lines, static_cast<std::size_t>(size) + 1);
  if (size < 0 || static_cast<std::size_t>(size) >= lines.words.size())
    lines.refuse("has " + text(lines.words.size() - 1) + " corners but declares " +
                 std::to_string(size));
  corners.clear();
  for (std::size_t k = 1; k <= static_cast<std::size_t>(size); ++k)
    corners.push_back(lines.number_in<std::int64_t>(lines.words[k], "an index"));
}

}  // namespace

MeshArrays read_off(std::string_view bytes) {
  const PlainText plain(bytes);
  Lines lines(plain.view(), '#');
  MeshBuilder mesh;
  const OffHeader header = read_off_header(lines);
  while (mesh.vertices.size() < header.vertices) {
    if (!lines.next())
      throw ReadError("ends after " + text(mesh.vertices.size()) + " of " + text(header.vertices) +
                      " vertices");
    read_vertex(lines, header, mesh);
  }
  keep_at_vertices(mesh.uv, header.vertices);
  keep_at_vertices(mesh.normals, header.vertices);
  keep_at_vertices(mesh.colors, header.vertices);
  std::vector<Color> colors;
  std::vector<std::int64_t> corners;
  for (std::size_t f = 0; f < header.polygons; ++f) {
    if (!lines.next())
      throw ReadError("ends after " + text(f) + " of " + text(header.polygons) + " faces");
    read_polygon(lines, corners);
    mesh.add_polygon(corners);
    const std::size_t more = lines.words.size() - 1 - corners.size();
    if (more == 3 || more == 4) colors.push_back(color_in(lines, corners.size() + 1, more));
  }
  if (mesh.colors.owner == Owner::kNothing && !colors.empty() && colors.size() == header.polygons)
    mesh.colors = {Owner::kPolygons, std::move(colors)};
  return mesh.build();
}

}  // namespace dapple
