// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#ifdef _WIN32
#include <process.h>
#define getpid _getpid
#else
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

#include <csignal>
#include <dapple/errors.hpp>
#include <dapple/mesh_file.hpp>
#include <dapple/surface.hpp>
#include <fstream>
#include <limits>
#include <numbers>

#include "invariants.hpp"
#include "shapes.hpp"
#include "throws.hpp"

namespace dapple::test {
namespace {

namespace fs = std::filesystem;

/// An empty folder for one test, removed at the end.
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

  /// Check that the file is rejected by name, or that its content is rejected as a surface.
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

  [[nodiscard]] static std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  [[nodiscard]] std::size_t files_there() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }

  fs::path folder_;
};

constexpr std::array<const char*, 4> kSuffixes = {".ply", ".off", ".obj", ".stl"};

#ifndef _WIN32
/// While this exists, files of this process cannot grow beyond a size, as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : before_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit low{bytes, limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &low);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }

 private:
  rlimit limit_{};
  void (*before_)(int);
};
#endif

/// Coordinates that need all digits of a double, far from the origin and tiny.
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

TEST_F(MeshFile, AFileWithoutFacesIsReadOnRequest) {
  const fs::path file = write_text("empty.obj", "v 0 0 0\n");
  expect_message<FileError>([&] { (void)read_mesh(file); }, {"empty.obj", "holds no faces"});
  EXPECT_EQ(read_mesh(file, true).vertices.size(), 1u);
}

TEST_F(MeshFile, ReadsNumbersOfVerticesThatHaveNoFaces) {
  const std::string text =
      "\xef\xbb\xbfply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
      "element vertex 2\nproperty float x\nproperty int64 id\nend_header\n3 0 1 1\n1 7\n2 8\n";
  const auto columns = read_vertex_columns(write_text("points.ply", text));
  ASSERT_EQ(columns.size(), 2u);
  EXPECT_EQ(columns[1].name, "id");
  EXPECT_EQ(columns[1].values, (std::vector<double>{7, 8}));
  expect_message<FileError>([&] { (void)read_vertex_columns(write_text("no.ply", "x")); },
                            {"no.ply", "does not begin with 'ply'"});
}

TEST_F(MeshFile, NamesAFileItCannotWrite) {
  const Shape shape = tetrahedron();
  const fs::path nowhere = path("no such folder") / "mesh.ply";
  expect_message<FileError>([&] { write_mesh(nowhere, shape.vertices, shape.faces); },
                            {"mesh.ply"});
  expect_message<FileError>([&] { write_mesh(path("mesh.strange"), shape.vertices, shape.faces); },
                            {"mesh.strange"});
}

TEST_F(MeshFile, MergesTheCornersOfStl) {
  for (const Shape& shape : {icosphere(2), fin(3), moebius(12)}) {
    const Shape single = mapped(  // rounded to single precision
        shape, [](const Vec3& p) { return Vec3((1024.0 * p).array().round() / 1024.0); });
    write_mesh(path("mesh.stl"), single.vertices, single.faces);
    const MeshArrays read = read_mesh(path("mesh.stl"));
    ASSERT_EQ(read.vertices.size(), shape.vertices.size()) << shape.name;
    ASSERT_EQ(read.faces.size(), shape.faces.size()) << shape.name;
    for (std::size_t f = 0; f < shape.faces.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(read.vertices[static_cast<std::size_t>(read.faces[f][k])],
                  single.vertices[static_cast<std::size_t>(single.faces[f][k])]);
  }
}

TEST_F(MeshFile, ReadsTextStl) {
  const fs::path file = write_text(
      "text.stl",
      "solid two facets\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n"
      "  vertex 0 1e-3 0\n endloop\nendfacet\nfacet normal 0 0 1\n outer loop\n  vertex 1 -0 0\n"
      "  vertex 1 1 0\n  vertex 0 1e-3 0\n endloop\nendfacet\nendsolid two facets\n");
  const MeshArrays read = read_mesh(file);
  EXPECT_EQ(read.vertices.size(), 4u);
  EXPECT_EQ(read.faces, (std::vector<Face>{{0, 1, 2}, {1, 3, 2}}));
}

TEST_F(MeshFile, SkipsExtraColumns) {
  const std::vector<Face> expected = {{0, 1, 2}, {0, 2, 3}};
  const std::string corners[4] = {"0 0 0", "1 0 0", "1 1 0", "0 1 0"};
  std::string coff = "COFF # colors\n\n4 1 0\n", obj = "mtllib a.mtl\r\no thing\r\n";
  for (const std::string& corner : corners) {
    coff += corner + " 255 0 0 255\n";
    obj += "v " + corner + " 0.5 0.5 0.5\r\nvt 0 0\r\nvn 0 0 1\r\n";
  }
  EXPECT_EQ(read_mesh(write_text("a.off", coff + "4 0 1 2 3 255 255 255\n")).faces, expected);
  EXPECT_EQ(read_mesh(write_text("a.obj", obj + "usemtl b\r\nf 1/1/1 2//2 3/3 \\\r\n-1\r\n")).faces,
            expected);
  const std::string ply =
      "ply\r\nformat ascii 1.0\r\ncomment made by others\r\nelement camera 1\r\nproperty float "
      "f\r\n"
      "element vertex 4\r\nproperty uchar red\r\nproperty float x\r\nproperty double y\r\n"
      "property int z\r\nelement face 1\r\nproperty uchar flags\r\n"
      "property list uchar uint vertex_index\r\nproperty list uchar float uv\r\nend_header\r\n"
      "35.5\r\n9 0 0 0\r\n9 1 0 0\r\n9 1 1 0\r\n9 0 1 0\r\n1 4 0 1 2 3 2 0.5 0.25\r\n";
  EXPECT_EQ(read_mesh(write_text("a.ply", ply)).faces, expected);
}

TEST_F(MeshFile, ReadsBinaryPlyOfEitherEnd) {
  for (const bool big : {false, true}) {
    std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                        "_endian 1.0\nelement vertex 3\nproperty float x\nproperty short y\n"
                        "property char z\nelement face 1\nproperty list ushort uchar "
                        "vertex_indices\nend_header\n";
    const auto add = [&](auto value) {
      std::string raw(reinterpret_cast<const char*>(&value), sizeof(value));
      if (big) std::reverse(raw.begin(), raw.end());
      bytes += raw;
    };
    for (const int k : {0, 1, 2}) {
      add(0.5f * static_cast<float>(k));
      add(static_cast<std::int16_t>(-300 * k));
      add(static_cast<std::int8_t>(-k));
    }
    add(std::uint16_t{3});
    for (const int k : {2, 1, 0}) add(static_cast<std::uint8_t>(k));
    const MeshArrays read = read_mesh(write_text("binary.ply", bytes));
    ASSERT_EQ(read.vertices.size(), 3u);
    EXPECT_EQ(read.vertices[2], Vec3(1.0, -600.0, -2.0));
    EXPECT_EQ(read.faces, (std::vector<Face>{{2, 1, 0}}));
  }
}

/// Each of these files has crashed a reader.
TEST_F(MeshFile, NamesTheLineThatIsWrong) {
  const auto refused = [&](const char* name, const std::string& text, const char* part) {
    expect_message<FileError>([&] { (void)read_mesh(write_text(name, text)); }, {name, part});
  };
  refused("word.off", "COFF\n1 0 0\nx\n", "line 3");
  refused("word.off", "OFF\n1 0 0\n0 0 x\n", "line 3 has 'x' for a coordinate");
  refused("vast.off", "OFF\n2000000000 1 0\n0 0 0\n", "1 of 2000000000 vertices");
  refused("short.off", "OFF\n1 2000000000 0\n0 0 0\n", "0 of 2000000000 faces");
  refused("corners.off", "OFF\n1 1 0\n0 0 0\n900 0 0\n", "line 4");
  refused("minus.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "line 6");
  refused("orphan.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
          "line 3 of its header is wrong");
  refused("types.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n",
          "line 4 of its header is wrong");
  refused("flat.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
          "end_header\n0 0\n",
          "vertices without z");
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  refused("vast.ply",
          "ply\nformat ascii 1.0\nelement vertex 9999999999999\n" + xyz + "end_header\n",
          "too short for 9999999999999 'vertex'");
  refused("empty.ply",
          "ply\nformat ascii 1.0\nelement void 9999999999999\nelement vertex 1\n" + xyz +
              "end_header\n0 0 0\n",
          "too short for 9999999999999 'void'");
  refused("list.ply",
          "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + xyz +
              "element face 1\nproperty list int int vertex_indices\nend_header\n" +
              std::string(12, '\0') + "\xff\xff\xff\x7f" + std::string(12, '\0'),
          "list of length 2147483647");
  refused("half.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\n" + xyz +
              "element face 1\nproperty list uchar float vertex_indices\nend_header\n0 0 0\n"
              "3 0 0.5 1\n",
          "0.5");
  refused("zero.obj", "v 0 0 0\nf 1 0 1\n", "line 2 has the index 0");
  refused("back.obj", "v 0 0 0\nf 1 -1 -2\n", "vertex -1");
  refused("word.obj", "v 0 0 zero\n", "line 1 has 'zero'");
  refused("loop.stl", "solid\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", "line 5");
  refused("word.stl", "solid\nvertex 0 0\n", "line 2");
  refused("cut.stl", std::string(80, 'x') + std::string("\x02\0\0\0", 4) + std::string(50, '\0'),
          "not an STL file");
  refused("corrupt.om", "OM", ".off, .obj, .ply and .stl");
}

TEST_F(MeshFile, ReadsNumbersOfAnyLength) {
  const std::string tail = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const std::string zeros(400, '0');
  EXPECT_EQ(read_mesh(write_text("a.obj", "v 1e-400 +2 -0." + zeros + "1\n" + tail)).vertices[0],
            Vec3(0, 2, 0));
  EXPECT_EQ(read_mesh(write_text("a.obj", "v 0 0 1e400\n" + tail)).vertices[0].z(),
            std::numeric_limits<double>::infinity());
}

/// Whatever the bytes, the result is a mesh or an error with the file's name; sanitizers check the
/// rest.
TEST_F(MeshFile, SurvivesChangedBytes) {
  const Shape shape = blob(0);
  Random random(4);
  for (const char* suffix : kSuffixes) {
    const fs::path whole = path(std::string("whole") + suffix);
    write_mesh(whole, shape.vertices, shape.faces);
    const std::string bytes = bytes_of(whole);
    const auto anywhere = [&](const std::string& text) {
      return static_cast<std::size_t>(random.below(static_cast<std::int32_t>(text.size())));
    };
    for (int round = 0; round < 400; ++round) {
      std::string changed = bytes;
      for (int k = random.below(4); k >= 0; --k)
        changed[anywhere(changed)] = static_cast<char>(random.below(256));
      if (round % 3 == 0) changed.erase(anywhere(changed), 1 + anywhere(changed) % 9);
      if (round % 4 == 0) changed.insert(anywhere(changed), 3, "9-. \n\xff"[round % 6]);
      const fs::path file = write_text(std::string("changed") + suffix, changed);
      try {
        const MeshArrays mesh = read_mesh(file);
        for (const Face& face : mesh.faces)
          for (const std::int32_t v : face)
            ASSERT_TRUE(v >= 0 && static_cast<std::size_t>(v) < mesh.vertices.size());
      } catch (const FileError& error) {
        EXPECT_NE(std::string(error.what()).find("changed"), std::string::npos);
      }
    }
  }
}

#ifndef _WIN32  // requires limits of a process, links and pipes
TEST_F(MeshFile, KeepsTheOldFileOnAFullDisk) {
  const Shape shape = blob(3);
  for (const char* suffix : kSuffixes) {
    const fs::path file = write_text(std::string("mesh") + suffix, "before");
    const std::size_t files = files_there();
    {
      const FullDisk full(1000);
      expect_message<FileError>([&] { write_mesh(file, shape.vertices, shape.faces); },
                                {"mesh", suffix, "large"});
    }
    EXPECT_EQ(bytes_of(file), "before") << suffix;
    EXPECT_EQ(files_there(), files) << suffix;
  }
}

/// The disk is full at every byte of a small file and at the end of every block of a large one.
TEST_F(MeshFile, KeepsTheOldFileWhereverTheDiskBecomesFull) {
  for (const auto& [shape, step] : {std::pair(tetrahedron(), 1), std::pair(blob(3), 512)})
    for (const char* suffix : kSuffixes) {
      const fs::path file = path(std::string("mesh") + suffix);
      write_mesh(file, shape.vertices, shape.faces);
      const std::string whole = bytes_of(file);
      write_text(file.filename().string(), "before");
      for (std::size_t bytes = 0; bytes < whole.size(); bytes += static_cast<std::size_t>(step)) {
        const FullDisk full(bytes);
        EXPECT_THROW(write_mesh(file, shape.vertices, shape.faces), FileError) << bytes;
        ASSERT_EQ(bytes_of(file), "before") << suffix << " after " << bytes << " bytes";
        ASSERT_EQ(files_there(), 1u) << suffix << " after " << bytes << " bytes";
      }
      const FullDisk just_enough(whole.size());
      write_mesh(file, shape.vertices, shape.faces);
      EXPECT_EQ(bytes_of(file), whole) << suffix;
      fs::remove(file);
    }
}

TEST_F(MeshFile, WritesThroughALink) {
  const Shape shape = tetrahedron();
  write_text("there.ply", "before");
  fs::create_symlink("there.ply", path("link.ply"));
  write_mesh(path("link.ply"), shape.vertices, shape.faces);
  EXPECT_TRUE(fs::is_symlink(path("link.ply")));
  EXPECT_EQ(read_mesh(path("there.ply")).faces, shape.faces);
}

TEST_F(MeshFile, WritesIntoAPipeWithoutReplacingIt) {
  const Shape shape = tetrahedron();
  ASSERT_EQ(mkfifo(path("pipe.off").c_str(), 0600), 0);
  const int reader = open(path("pipe.off").c_str(), O_RDONLY | O_NONBLOCK);
  write_mesh(path("pipe.off"), shape.vertices, shape.faces);
  std::array<char, 4> begin{};
  EXPECT_EQ(read(reader, begin.data(), 3), 3);
  EXPECT_STREQ(begin.data(), "OFF");
  EXPECT_TRUE(fs::is_fifo(path("pipe.off")));
  close(reader);
}
#endif

TEST_F(MeshFile, WritesOnlyFacesThatItHas) {
  Shape shape = tetrahedron();
  shape.faces[2][1] = 4;
  for (const char* suffix : kSuffixes)
    expect_message<SurfaceError>(
        [&] { write_mesh(path(std::string("mesh") + suffix), shape.vertices, shape.faces); },
        {"faces[2]", "4"});
  EXPECT_EQ(files_there(), 0u);
}

TEST_F(MeshFile, RefusesCoordinatesTooLargeForStl) {
  Shape shape = tetrahedron();
  shape.vertices[1].y() = -1e39;
  expect_message<ArgumentError>([&] { write_mesh(path("mesh.stl"), shape.vertices, shape.faces); },
                                {"vertices[1]", "1e+39"});
}

}  // namespace
}  // namespace dapple::test
