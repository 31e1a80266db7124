// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <unistd.h>

#include <dapple/errors.hpp>
#include <dapple/mesh_file.hpp>
#include <dapple/surface.hpp>
#include <fstream>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

namespace fs = std::filesystem;

/// An empty folder of the test's own, gone at the end.
class MeshFile : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ =
        fs::path(testing::TempDir()) / ("dapple mesh file " + name + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path path(const std::string& name) const { return folder_ / name; }

  fs::path write_text(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

  /// Either the file is refused by name, or what was read is refused as a surface.
  static void expect_refused(const fs::path& file) {
    try {
      const MeshArrays mesh = read_mesh(file);
      (void)Surface(mesh.vertices, mesh.faces);
      ADD_FAILURE() << file << " was accepted";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(file.filename().string()), std::string::npos)
          << error.what();
    } catch (const SurfaceError& error) {
      EXPECT_NE(std::string(error.what()).find('['), std::string::npos) << error.what();
    }
  }

  fs::path folder_;
};

/// Coordinates whose digits fill a double, far from the origin and tiny.
Shape digits() {
  return mapped(blob(2), [](const Vec3& p) {
    return Vec3(p.x() / 3.0, 1e-9 * p.y() * std::numbers::pi, 1e7 + p.z());
  });
}

TEST_F(MeshFile, KeepsEveryDigitInPly) {
  const Shape shape = digits();
  write_mesh(path("mesh.ply"), shape.vertices, shape.faces);
  const MeshArrays read = read_mesh(path("mesh.ply"));
  EXPECT_TRUE(same_bytes(read.vertices, shape.vertices));
  EXPECT_EQ(read.faces, shape.faces);
}

TEST_F(MeshFile, KeepsFacesAndPlacesInOtherFormats) {
  const Shape shape = blob(2);
  for (const char* name : {"mesh.obj", "mesh.off"}) {
    write_mesh(path(name), shape.vertices, shape.faces);
    const MeshArrays read = read_mesh(path(name));
    EXPECT_EQ(read.faces, shape.faces) << name;
    ASSERT_EQ(read.vertices.size(), shape.vertices.size());
    for (std::size_t k = 0; k < read.vertices.size(); ++k)
      ASSERT_LE((read.vertices[k] - shape.vertices[k]).norm(), 1e-5) << name;
  }
}

TEST_F(MeshFile, KeepsFacesThatFitNoHalfEdgeMesh) {
  for (const Shape& shape :
       {fin(3), moebius(12), bow_tie(), duplicate_faces(), flipped_faces(), isolated_vertices()}) {
    write_mesh(path("mesh.ply"), shape.vertices, shape.faces);
    const MeshArrays read = read_mesh(path("mesh.ply"));
    EXPECT_TRUE(same_bytes(read.vertices, shape.vertices)) << shape.name;
    EXPECT_EQ(read.faces, shape.faces) << shape.name;
  }
}

TEST_F(MeshFile, CutsPolygonsIntoFans) {
  const fs::path file = write_text(
      "quad.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nf 1 2 3 4\nf 1 4 5\n");
  const std::vector<Face> expected = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(read_mesh(file).faces, expected);
}

TEST_F(MeshFile, ReadsTextPly) {
  const fs::path file =
      write_text("text.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
                 "property double z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n0.1 0 0\n0 1e-3 2\n3 0 1 2\n");
  const MeshArrays read = read_mesh(file);
  ASSERT_EQ(read.vertices.size(), 3u);
  EXPECT_EQ(read.vertices[1], Vec3(0.1, 0, 0));
  EXPECT_EQ(read.vertices[2], Vec3(0, 1e-3, 2));
}

TEST_F(MeshFile, TakesPathsWithSpacesAndLetters) {
  const Shape shape = tetrahedron();
  write_mesh(path("a mesh \u00e9\u4e2d.ply"), shape.vertices, shape.faces);
  EXPECT_EQ(read_mesh(path("a mesh \u00e9\u4e2d.ply")).faces, shape.faces);
}

TEST_F(MeshFile, NamesAFileThatIsNotThere) {
  expect_message<FileError>([&] { (void)read_mesh(path("absent.ply")); }, {"absent.ply"});
  expect_message<FileError>([&] { (void)read_mesh(folder_); }, {folder_.filename().string()});
}

TEST_F(MeshFile, NamesAFileItCannotRead) {
  for (const char* text :
       {"", "hello", "ply\n", "ply\nformat binary_little_endian 1.0\nend_header\n"}) {
    const fs::path file = write_text("broken.ply", text);
    expect_message<FileError>([&] { (void)read_mesh(file); }, {"broken.ply"});
  }
  const fs::path strange = write_text("mesh.strange", "v 0 0 0\n");
  expect_message<FileError>([&] { (void)read_mesh(strange); }, {"mesh.strange"});
}

TEST_F(MeshFile, RefusesAFileCutShort) {
  const Shape shape = blob(1);
  write_mesh(path("whole.ply"), shape.vertices, shape.faces);
  std::ifstream whole(path("whole.ply"), std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(whole), {});
  for (const double share : {0.01, 0.2, 0.5, 0.9, 0.999}) {
    const auto length = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
    SCOPED_TRACE(share);
    expect_refused(write_text("cut.ply", bytes.substr(0, length)));
  }
}

TEST_F(MeshFile, RefusesBadIndicesAndNumbers) {
  expect_refused(write_text("high.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"));
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty "
      "double z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  expect_refused(write_text("nan.ply", header + "0 0 0\nnan 0 0\n0 1 2\n3 0 1 2\n"));
  expect_refused(write_text("high.ply", header + "0 0 0\n1 0 0\n0 1 2\n3 0 1 7\n"));
  expect_refused(write_text("low.ply", header + "0 0 0\n1 0 0\n0 1 2\n3 0 1 -1\n"));
}

TEST_F(MeshFile, NamesAFileItCannotWrite) {
  const Shape shape = tetrahedron();
  const fs::path nowhere = path("no such folder") / "mesh.ply";
  expect_message<FileError>([&] { write_mesh(nowhere, shape.vertices, shape.faces); },
                            {"mesh.ply"});
  expect_message<FileError>([&] { write_mesh(path("mesh.strange"), shape.vertices, shape.faces); },
                            {"mesh.strange"});
}

}  // namespace
}  // namespace dapple::test
