// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstring>
#include <dapple/surface.hpp>
#include <numeric>

#include "mesh_area.hpp"
#include "surface/mesh_readers.hpp"

// Files as other programs write them, all with the same cube.

namespace dapple::test {
namespace {

using Reader = MeshArrays (*)(std::string_view);

constexpr std::array<std::array<int, 4>, 6> kSides = {
    {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};

Vec3 corner(int k) { return {k % 2 * 1.0, k / 2 % 2 * 1.0, k / 4 * 1.0}; }

std::string place(int k) {
  std::string words;
  for (const int value : {k % 2, k / 2 % 2, k / 4})
    words.append(words.empty() ? "" : " ").append(std::to_string(value));
  return words;
}

/// Lines of the eight corners with text before and after each.
std::string places(const std::string& before, const std::string& behind = "") {
  std::string lines;
  for (int k = 0; k < 8; ++k) lines.append(before).append(place(k)).append(behind).append("\n");
  return lines;
}

/// Lines of the six sides, with indices counted from `first`, each followed by `behind`.
std::string sides(const std::string& before, int first = 0, const std::string& behind = "") {
  std::string lines;
  for (const auto& side : kSides) {
    lines += before;
    for (const int k : side) lines.append(" ").append(std::to_string(first + k)).append(behind);
    lines += "\n";
  }
  return lines;
}

std::string obj() { return places("v ") + sides("f", 1); }
std::string off() { return "OFF\n8 6 0\n" + places("") + sides("4"); }

std::string ply_header(const std::string& form = "ascii", const std::string& list = "uchar int") {
  return "ply\nformat " + form +
         " 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 6\nproperty list " +
         list + " vertex_indices\nend_header\n";
}
std::string ply() { return ply_header() + places("") + sides("4"); }

std::string stl(const std::string& name = "solid cube") {
  std::string text = name + "\n";
  for (const auto& side : kSides)
    for (const std::size_t k : {1u, 2u})
      text += "facet normal 0 0 1\n outer loop\n  vertex " + place(side[0]) + "\n  vertex " +
              place(side[k]) + "\n  vertex " + place(side[k + 1]) + "\n endloop\nendfacet\n";
  return text + "endsolid cube\n";
}

template <typename T>
std::string raw(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

std::string binary_stl(std::uint32_t says, std::string head = "made by somebody") {
  head.resize(80, '\0');
  std::string bytes = head + raw(says);
  for (const auto& side : kSides)
    for (const std::size_t k : {1u, 2u}) {
      bytes += std::string(12, '\0');
      for (const int c : {side[0], side[k], side[k + 1]})
        for (const double x : corner(c)) bytes += raw(static_cast<float>(x));
      bytes += std::string(2, '\0');
    }
  return bytes;
}

const std::vector<std::pair<Reader, std::string>>& texts() {
  static const std::vector<std::pair<Reader, std::string>> kTexts = {
      {read_obj, obj()}, {read_off, off()}, {read_ply, ply()}, {read_stl, stl()}};
  return kTexts;
}

void expect_cube(const MeshArrays& mesh, const std::string& name = "") {
  EXPECT_EQ(mesh.vertices.size(), 8u) << name;
  EXPECT_EQ(mesh.faces.size(), 12u) << name;
  EXPECT_DOUBLE_EQ(area_of(mesh.vertices, mesh.faces), 6.0) << name;
}

void expect_refused(Reader read, const std::string& bytes, const std::string& part) {
  try {
    (void)read(bytes);
    ADD_FAILURE() << "was read: " << part;
  } catch (const ReadError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

std::string utf16(const std::string& text, bool big) {
  std::string bytes = big ? "\xfe\xff" : "\xff\xfe";
  for (const char c : text) {
    if (big) bytes += '\0';
    bytes += c;
    if (!big) bytes += '\0';
  }
  return bytes;
}

TEST(FoundFiles, AByteOrderMarkIsNoPartOfTheFirstWord) {
  for (const auto& [read, text] : texts()) expect_cube(read("\xef\xbb\xbf" + text), text);
}

TEST(FoundFiles, Utf16IsTextToo) {
  for (const auto& [read, text] : texts())
    for (const bool big : {false, true}) {
      expect_cube(read(utf16(text, big)), text);
      expect_cube(read(utf16(text, big).substr(2)), text);
    }
}

TEST(FoundFiles, LinesMayEndWithACarriageReturn) {
  for (const auto& [read, text] : texts()) {
    std::string returns = text, both;
    std::replace(returns.begin(), returns.end(), '\n', '\r');
    for (const char c : text) both += c == '\n' ? "\r\n" : std::string(1, c);
    expect_cube(read(returns), text);
    expect_cube(read(both), text);
  }
}

TEST(FoundFiles, ABinaryPlyMayHaveAHeaderWithCarriageReturns) {
  std::string header = ply_header("binary_little_endian");
  std::replace(header.begin(), header.end(), '\n', '\r');
  std::string bytes = header;
  for (int k = 0; k < 8; ++k)
    for (const double x : corner(k)) bytes += raw(x);
  for (const auto& side : kSides) {
    bytes += raw(std::uint8_t{4});
    for (const int k : side) bytes += raw(std::int32_t{k});
  }
  expect_cube(read_ply(bytes));
  expect_cube(read_ply("\xef\xbb\xbf" + bytes));
}

TEST(FoundFiles, AnStlThatSaysTooFewTrianglesLosesNone) {
  for (const std::uint32_t says : {0u, 5u, 12u, 0xffffffffu})
    expect_cube(read_stl(binary_stl(says)));
  expect_cube(read_stl(binary_stl(12) + "made by somebody"));  // no triangle is lost
}

TEST(FoundFiles, AnStlOfAnotherSizeThanItSaysIsRefused) {
  expect_refused(read_stl, binary_stl(13), "declares 13 triangles and has room for 12");
  expect_refused(read_stl, binary_stl(5) + "more", "declares 5 triangles");
  expect_refused(read_stl, binary_stl(12).substr(0, 200), "has room for 2");
}

TEST(FoundFiles, ABinaryStlMayBeginWithSolid) {
  expect_cube(read_stl(binary_stl(12, "solid made by somebody")));
  expect_cube(read_stl(binary_stl(5, "solid made by somebody")));
}

TEST(FoundFiles, AnStlMayBeInCapitals) {
  std::string capitals = stl();
  for (char& c : capitals) c = static_cast<char>(std::toupper(c));
  expect_cube(read_stl(capitals));
  expect_cube(read_stl(stl("Solid")));
  expect_cube(read_stl("\n  " + stl()));
}

TEST(FoundFiles, TheCountsOfAnOffMayStandInItsFirstLine) {
  for (const char* head : {"OFF8 6 0\n", "OFF 8 6 0\n", "off\n8 6 0\n", "8 6 0\n", "OFF\n\n8 6\n"})
    expect_cube(read_off(head + places("") + sides("4")), head);
  expect_refused(read_off, "OFF BINARY\n", "is a binary OFF file: write it as text");
  expect_refused(read_off, "OFFICE\n8 6 0\n", "does not begin with OFF");
}

TEST(FoundFiles, OffKeepsColorsNormalsAndTextureCoordinates) {
  const std::string faces = sides("4");
  const MeshArrays colors =
      read_off("COFF # made\n# by\n8 6 0\n" + places("", " 255 0 51") + faces);
  expect_cube(colors);
  ASSERT_EQ(colors.colors.size(), 12u);
  EXPECT_EQ(colors.colors[3][1], (Color{1.0f, 0.0f, 0.2f, 1.0f}));
  const MeshArrays normals = read_off("NOFF\n8 6 0\n" + places("", " 0 0 2") + faces);
  EXPECT_EQ(normals.normals[11][2], Vec3(0, 0, 2));
  const MeshArrays all =
      read_off("STCNOFF\n8 6 0\n" + places("", " 0 0 2 0.5 0.25 1 0.5 7 8") + faces);
  EXPECT_EQ(all.uv[0][0], Vec2(7, 8));
  EXPECT_EQ(all.colors[0][0], (Color{0.5f, 0.25f, 1.0f, 0.5f}));
  EXPECT_EQ(all.normals[0][0], Vec3(0, 0, 2));
  const MeshArrays sided = read_off("OFF\n8 6 0\n" + places("") + sides("4", 0) + "# end\n");
  EXPECT_TRUE(sided.colors.empty());
}

TEST(FoundFiles, OffHasColorsOfFaces) {
  std::string text = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 1 0 255 0 0\n";
  const MeshArrays mesh = read_off(text);
  EXPECT_EQ(mesh.colors[0][2], (Color{1.0f, 0.0f, 0.0f, 1.0f}));
  EXPECT_EQ(mesh.colors[1][2], (Color{0.0f, 1.0f, 0.0f, 0.0f}));
}

TEST(FoundFiles, FacesOfAnOffMayBeBrokenOverSeveralLines) {
  std::string text = "OFF\n8 6 0\n" + places("");
  for (const auto& side : kSides) {
    text += "4 " + std::to_string(side[0]) + " \n\n# broken\n" + std::to_string(side[1]) + "\n";
    text += std::to_string(side[2]) + " " + std::to_string(side[3]) + "\n";
  }
  expect_cube(read_off(text));
}

TEST(FoundFiles, AFaceOfAnOffDoesNotTakeCornersOfTheNextOne) {
  const std::string head = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n";
  expect_refused(read_off, head + "3 0 1\n3 0 2 1\n", "line 6 has 2 corners but declares 3");
  expect_refused(read_off, head + "3 0 1 2\n3 0\n2\n", "line 7 has 1 corners but declares 3");
}

TEST(FoundFiles, PlyHasStripsOfTriangles) {
  const MeshArrays mesh = read_ply(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
      "0\n1 1 0\n9 0 1 2 3 -1 0 2 1 -1\n");
  EXPECT_EQ(mesh.faces, (std::vector<Face>{{0, 1, 2}, {2, 1, 3}, {0, 2, 1}}));
}

TEST(FoundFiles, PlyHasNumbersOf64BitsAndOtherNames) {
  std::string bytes = ply_header("binary_little_endian", "uint64 int64");
  for (int k = 0; k < 8; ++k)
    for (const double x : corner(k)) bytes += raw(x);
  for (const auto& side : kSides) {
    bytes += raw(std::uint64_t{4});
    for (const int k : side) bytes += raw(std::int64_t{k});
  }
  expect_cube(read_ply(bytes));
  for (const char* list : {"uint8_t int32_t", "UChar Int", "ulong long", "uint8 uint64"})
    expect_cube(read_ply(ply_header("ascii", list) + places("") + sides("4")), list);
}

TEST(FoundFiles, PlyMayHaveFacesBeforeVertices) {
  expect_cube(
      read_ply("ply\nformat ascii 1.0\nelement face 6\nproperty list uchar int vertex_index\n"
               "element vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
               "end_header\n" +
               sides("4") + places("")));
}

TEST(FoundFiles, PlyKeepsWhatItSaysOfVerticesAndFaces) {
  const MeshArrays mesh = read_ply(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\n"
      "property double z\nproperty double nx\nproperty double ny\nproperty double nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\n"
      "property float t\nproperty float wet\nelement face 2\nproperty list uchar int "
      "vertex_indices\nproperty float fur\nend_header\n"
      "0 0 0 0 0 1 255 0 0 0 0 1\n1 0 0 0 0 1 255 0 0 1 0 2\n1 1 0 0 0 1 0 0 51 1 1 3\n"
      "0 1 0 0 0 1 0 0 0 0 1 4\n0 2 0 0 1 0 0 0 0 0 2 5\n4 0 1 2 3 0.5\n3 3 2 4 1.5\n");
  ASSERT_EQ(mesh.faces.size(), 3u);
  EXPECT_EQ(mesh.polygons, (std::vector<std::int32_t>{0, 0, 1}));
  EXPECT_EQ(mesh.normals[2][2], Vec3(0, 1, 0));
  EXPECT_EQ(mesh.colors[1][1], (Color{0.0f, 0.0f, 0.2f, 1.0f}));
  EXPECT_EQ(mesh.uv[1][2], Vec2(0, 1));
  ASSERT_EQ(mesh.attributes.size(), 2u);
  EXPECT_EQ(mesh.attributes[0].name, "wet");
  EXPECT_EQ(mesh.attributes[0].values, (std::vector<double>{1, 2, 3, 4, 5}));
  EXPECT_TRUE(mesh.attributes[1].at_faces);
  EXPECT_EQ(mesh.attributes[1].values, (std::vector<double>{0.5, 0.5, 1.5}));
}

TEST(FoundFiles, PlyHasTextureCoordinatesAtCorners) {
  const MeshArrays mesh = read_ply(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float "
      "texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 0\n");
  ASSERT_EQ(mesh.uv.size(), 2u);
  EXPECT_EQ(mesh.uv[0][2], Vec2(1, 1));
  EXPECT_EQ(mesh.uv[1][1], Vec2(0, 0));
}

/// Both sides of a quad used to be cut along different diagonals and counted twice.
TEST(FoundFiles, PolygonsOnEachOtherAreCutAlike) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  for (const std::string second :
       {"f 4 3 2 1\n", "f 3 2 1 4\n", "f 2 3 4 1\n", "f -1 -2 -3 -4\n"}) {
    for (const bool own : {false, true}) {
      if (own && second[2] != '-') continue;
      const MeshArrays mesh = read_obj(square + "f 1 2 3 4\n" + (own ? square : "") + second);
      ASSERT_EQ(mesh.faces.size(), 4u);
      const Surface surface(mesh.vertices, mesh.faces);
      EXPECT_EQ(surface.doubled_faces(), 2u) << second;
      EXPECT_DOUBLE_EQ(surface.area(), 1.0) << second;
    }
  }
}

TEST(FoundFiles, AllSidesOfACubeAreCutAlikeTwice) {
  std::string text = places("v ");
  for (std::size_t at = text.find(" 0"); at != std::string::npos; at = text.find(" 0", at))
    text.replace(at, 2, " -1");
  text += sides("f", 1);
  for (const auto& side : kSides) {
    text += "f";
    for (std::size_t k = 4; k-- > 0;) text.append(" ").append(std::to_string(1 + side[k]));
    text += "\n";
  }
  const MeshArrays mesh = read_obj(text);
  const Surface surface(mesh.vertices, mesh.faces);
  EXPECT_EQ(surface.doubled_faces(), 12u);
  EXPECT_DOUBLE_EQ(surface.area(), 24.0);
}

TEST(FoundFiles, ObjLinesGoOnBehindABackslash) {
  std::string text = places("v ");
  for (const auto& side : kSides) {
    text += "f";
    for (const int k : side) text.append(" ").append(std::to_string(k + 1)).append("\\\n");
    text += "\n";
  }
  expect_cube(read_obj(text));
  expect_cube(read_obj("# by C:\\somebody\\\n" + obj()));
}

TEST(FoundFiles, ObjCountsBackFromTheLast) { expect_cube(read_obj(places("v ") + sides("f", -8))); }

TEST(FoundFiles, ObjCornersHaveTextureCoordinatesNormalsBothOrNone) {
  const std::string head = places("v ") + "vt 0.5 0.25\nvn 0 0 2\n";
  const MeshArrays both = read_obj(head + sides("f", 1, "/1/1"));
  const MeshArrays normals = read_obj(head + sides("f", 1, "//1"));
  const MeshArrays uv = read_obj(head + sides("f", 1, "/-1"));
  for (const MeshArrays* mesh : {&both, &normals, &uv}) expect_cube(*mesh);
  EXPECT_EQ(both.uv[11][2], Vec2(0.5, 0.25));
  EXPECT_EQ(both.normals[11][2], Vec3(0, 0, 2));
  EXPECT_TRUE(normals.uv.empty());
  EXPECT_EQ(normals.normals.size(), 12u);
  EXPECT_TRUE(uv.normals.empty());
  EXPECT_EQ(uv.uv.size(), 12u);
  EXPECT_TRUE(read_obj(obj()).uv.empty());
}

TEST(FoundFiles, ObjHasColorsOfVertices) {
  const MeshArrays mesh = read_obj(places("v ", " 1 0 0.5") + sides("f", 1));
  EXPECT_EQ(mesh.colors[5][1], (Color{1.0f, 0.0f, 0.5f, 1.0f}));
}

}  // namespace
}  // namespace dapple::test
