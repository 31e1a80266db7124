// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <dapple/surface.hpp>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace dapple::test {

/// A small generator (PCG-XSH-RR, O'Neill 2014) that is independent of the code under test.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 0x853c49e6748fea9bu) {
    bits();
  }

  std::uint32_t bits();
  double uniform() { return bits() * 0x1p-32; }  // [0, 1)
  double between(double low, double high) { return low + (high - low) * uniform(); }
  std::int32_t below(std::int32_t end) { return static_cast<std::int32_t>(uniform() * end); }
  Vec3 in_box();         // [-1, 1]^3
  Vec3 weights();        // uniform barycentric coordinates
  Vec3 inner_weights();  // at least 0.1 from every edge
  std::vector<double> densities(std::size_t count);

 private:
  std::uint64_t state_;
};

/// The arrays of a surface, as a caller provides them.
struct Shape {
  std::string name;
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  std::vector<double> density = {};
  DensityAt density_at = DensityAt::kVertices;

  [[nodiscard]] Surface surface() const {
    return Surface(vertices, faces, Density{density_at, density});
  }
  [[nodiscard]] Vec3 densities(std::int32_t face) const;  // at its corners
  [[nodiscard]] Vec3 point(std::int32_t face, const Vec3& weights) const;
  [[nodiscard]] double face_area(std::int32_t face) const;
  /// Per face, whether it counts: no earlier face has the same corners.
  [[nodiscard]] std::vector<bool> counted() const;
  [[nodiscard]] double area() const;      // of faces that count
  [[nodiscard]] double capacity() const;  // integral of the density
};

/// Prints a shape in messages of parametrized tests.
void PrintTo(const Shape& shape, std::ostream* out);

using DensityFunction = std::function<double(const Vec3&)>;

[[nodiscard]] Shape with_density(Shape shape, const DensityFunction& density);
/// The shape with the function's values at the middles of the faces as density.
[[nodiscard]] Shape with_face_density(Shape shape, const DensityFunction& density);
/// The shape with the function's values at the corners times (1 + face % 3) as density, which jumps
/// at most edges.
[[nodiscard]] Shape with_corner_density(Shape shape, const DensityFunction& density);
[[nodiscard]] Shape mapped(Shape shape, const std::function<Vec3(const Vec3&)>& map);
[[nodiscard]] Shape joined(const Shape& a, const Shape& b);

/// The shape with three separate vertices per face, as in an STL file.
[[nodiscard]] Shape soup(const Shape& shape);
/// The shape with vertices split at edges sharper than `degrees`, as for hard edges.
[[nodiscard]] Shape split_edges(const Shape& shape, double degrees);

// Well-behaved shapes.
[[nodiscard]] Shape triangle();
[[nodiscard]] Shape tetrahedron();
[[nodiscard]] Shape octahedron();
[[nodiscard]] Shape grid(int cells);              // unit square in the plane z = 0
[[nodiscard]] Shape box(int cells);               // unit cube, welded along its creases
[[nodiscard]] Shape icosphere(int subdivisions);  // radius 1
[[nodiscard]] Shape blob(int subdivisions);       // a bumpy icosphere
[[nodiscard]] Shape torus(int around, int tube);  // radii 1 and 0.4
[[nodiscard]] Shape tube(int around, int along);  // open cylinder, two border loops

// Difficult shapes.
[[nodiscard]] Shape needle();  // 1 : 1e6
[[nodiscard]] Shape two_sheets(int cells, double gap);
[[nodiscard]] Shape two_components();
[[nodiscard]] Shape many_components(int count);
[[nodiscard]] Shape moebius(int segments);
[[nodiscard]] Shape fin(int cells);  // three sheets along one edge
[[nodiscard]] Shape tee(int cells);  // a wall standing on the middle of a floor, x = 0
[[nodiscard]] Shape bow_tie();
[[nodiscard]] Shape isolated_vertices();
[[nodiscard]] Shape zero_area_faces();
[[nodiscard]] Shape duplicate_faces();
[[nodiscard]] Shape flipped_faces();

/// Every shape above, at sizes for quick tests, some with a density.
[[nodiscard]] const std::vector<Shape>& all_shapes();

/// A random small mesh (soup, bumpy sphere, crumpled sheet or pointed hat) with or without a random
/// density.
[[nodiscard]] Shape random_shape(Random& random);

/// Random sites, uniform by area; optionally away from the edges of faces.
[[nodiscard]] Sites random_sites(const Shape& shape, std::size_t count, Random& random,
                                 bool inner = false);

/// Sites with the difficulties of real input: copies of others, and sites on vertices and edges.
[[nodiscard]] Sites degenerate_sites(const Shape& shape, std::size_t count, Random& random);

/// A rotation about a skew axis.
[[nodiscard]] Vec3 rotated(const Vec3& point, double angle);

/// The vertices bent and expanded, increasingly with `time`.
[[nodiscard]] std::vector<Vec3> deformed(const std::vector<Vec3>& vertices, double time);

/// The shape's name, for the name of a parametrized test.
template <typename Info>
std::string shape_name(const Info& info) {
  return info.param.name;
}

}  // namespace dapple::test
