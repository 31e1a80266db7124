// SPDX-License-Identifier: GPL-3.0-or-later
#include "shapes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <ostream>
#include <set>
#include <utility>

namespace dapple::test {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

std::int32_t as_index(std::size_t value) { return static_cast<std::int32_t>(value); }

/// Two triangles for the quad a, b, c, d.
void add_quad(Shape& shape, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
  shape.faces.push_back({a, b, c});
  shape.faces.push_back({a, c, d});
}

/// Give vertices at the same place the same index.
Shape welded(const Shape& shape) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::map<Vec3, std::int32_t, decltype(less)> index(less);
  Shape result{shape.name, {}, {}};
  for (const Face& face : shape.faces) {
    Face corner{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& p = shape.vertices[static_cast<std::size_t>(face[c])];
      const auto [at, fresh] = index.try_emplace(p, as_index(result.vertices.size()));
      if (fresh) result.vertices.push_back(p);
      corner[c] = at->second;
    }
    result.faces.push_back(corner);
  }
  return result;
}

/// Split every face in four, with new vertices in the middle of the edges.
Shape subdivided(const Shape& shape) {
  Shape result{shape.name, shape.vertices, {}};
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto [at, fresh] =
        middles.try_emplace(std::minmax(a, b), as_index(result.vertices.size()));
    if (fresh) {
      const Vec3 sum =
          shape.vertices[static_cast<std::size_t>(a)] + shape.vertices[static_cast<std::size_t>(b)];
      result.vertices.push_back(0.5 * sum);
    }
    return at->second;
  };
  for (const auto& [a, b, c] : shape.faces) {
    const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    result.faces.insert(result.faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return result;
}

Shape icosahedron() {
  const double t = std::numbers::phi;
  return {"Icosahedron",
          {{-1, t, 0},
           {1, t, 0},
           {-1, -t, 0},
           {1, -t, 0},
           {0, -1, t},
           {0, 1, t},
           {0, -1, -t},
           {0, 1, -t},
           {t, 0, -1},
           {t, 0, 1},
           {-t, 0, -1},
           {-t, 0, 1}},
          {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
           {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
           {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
}

Shape named(Shape shape, std::string name) {
  shape.name = std::move(name);
  return shape;
}

/// Quads over a rectangular array of vertices; a wrapped direction joins its end to its start.
Shape lattice(std::string name, int columns, int rows, bool wrap_columns, bool wrap_rows,
              const std::function<Vec3(double, double)>& at) {
  Shape shape{std::move(name), {}, {}};
  const int across = columns + (wrap_columns ? 0 : 1);
  const int down = rows + (wrap_rows ? 0 : 1);
  for (int r = 0; r < down; ++r)
    for (int c = 0; c < across; ++c)
      shape.vertices.push_back(at(double(c) / columns, double(r) / rows));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int c1 = (c + 1) % across, r1 = (r + 1) % down;
      add_quad(shape, r * across + c, r * across + c1, r1 * across + c1, r1 * across + c);
    }
  return shape;
}

double wave(const Vec3& p) {
  return 1.0 + 0.8 * std::sin(3.0 * p.x()) * std::cos(2.0 * p.y() + p.z());
}

double only_above(const Vec3& p) { return std::max(0.0, p.x() - 0.3); }

std::vector<Shape> make_all_shapes() {
  std::vector<Shape> shapes = {triangle(),
                               tetrahedron(),
                               octahedron(),
                               grid(6),
                               box(3),
                               icosphere(2),
                               blob(2),
                               torus(24, 12),
                               tube(12, 8),
                               needle(),
                               two_sheets(4, 0.05),
                               two_components(),
                               many_components(40),
                               moebius(24),
                               fin(4),
                               tee(2),
                               bow_tie(),
                               isolated_vertices(),
                               zero_area_faces(),
                               duplicate_faces(),
                               flipped_faces()};
  for (const char* name : {"Grid", "Box", "Blob", "Fin", "ZeroAreaFaces"}) {
    const auto at =
        std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.name == name; });
    shapes.push_back(named(with_density(*at, wave), at->name + "Dense"));
  }
  shapes.push_back(named(with_density(grid(6), only_above), "GridHalfEmpty"));
  shapes.push_back(named(with_face_density(grid(6), only_above), "GridEmptyFaces"));
  shapes.push_back(named(with_face_density(blob(2), wave), "BlobFaces"));
  shapes.push_back(named(with_corner_density(fin(4), wave), "FinCorners"));
  shapes.push_back(named(with_corner_density(zero_area_faces(), wave), "ZeroAreaFacesCorners"));
  return shapes;
}

Shape random_soup(Random& random) {
  Shape shape{"Soup", {}, {}};
  const std::int32_t faces = 1 + random.below(20);
  for (std::int32_t f = 0; f < faces; ++f) {
    const Vec3 middle = random.in_box();
    for (int c = 0; c < 3; ++c) shape.vertices.push_back(middle + 0.5 * random.in_box());
    shape.faces.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return shape;
}

Shape jittered(Shape shape, double size, Random& random) {
  for (Vec3& p : shape.vertices) p += size * random.in_box();
  return shape;
}

Shape random_hat(Random& random) {
  const int corners = 3 + random.below(9);
  Shape shape{"Hat", {Vec3(0, 0, random.between(0.2, 3.0))}, {}};
  for (int k = 0; k < corners; ++k) {
    const double angle = kTurn * k / corners;
    shape.vertices.emplace_back(std::cos(angle), std::sin(angle), 0.2 * random.uniform());
    shape.faces.push_back({0, 1 + k, 1 + (k + 1) % corners});
  }
  return shape;
}

}  // namespace

std::uint32_t Random::bits() {
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005u + 1442695040888963407u;
  const auto mixed = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
  const auto turn = static_cast<std::uint32_t>(old >> 59);
  return (mixed >> turn) | (mixed << ((32 - turn) & 31));
}

Vec3 Random::in_box() {
  const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
  return {x, y, z};
}

Vec3 Random::weights() {
  double u = uniform(), v = uniform();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {1.0 - u - v, u, v};
}

Vec3 Random::inner_weights() { return Vec3::Constant(0.1) + 0.7 * weights(); }

std::vector<double> Random::densities(std::size_t count) {
  std::vector<double> result(count);
  for (double& value : result) value = below(5) == 0 ? 0.0 : between(0.1, 3.0);
  return result;
}

Vec3 Shape::point(std::int32_t face, const Vec3& weights) const {
  const Face& corner = faces[static_cast<std::size_t>(face)];
  Vec3 sum = Vec3::Zero();
  for (int c = 0; c < 3; ++c)
    sum += weights[c] * vertices[static_cast<std::size_t>(corner[static_cast<std::size_t>(c)])];
  return sum;
}

double Shape::face_area(std::int32_t face) const {
  const auto [a, b, c] = faces[static_cast<std::size_t>(face)];
  const Vec3& p = vertices[static_cast<std::size_t>(a)];
  const Vec3 u = vertices[static_cast<std::size_t>(b)] - p;
  const Vec3 v = vertices[static_cast<std::size_t>(c)] - p;
  return 0.5 * u.cross(v).norm();
}

std::vector<bool> Shape::counted() const {
  std::set<std::array<std::array<double, 3>, 3>> seen;
  std::vector<bool> result;
  for (const Face& face : faces) {
    std::array<std::array<double, 3>, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& p = vertices[static_cast<std::size_t>(face[c])];
      corners[c] = {p.x(), p.y(), p.z()};
    }
    std::sort(corners.begin(), corners.end());
    result.push_back(seen.insert(corners).second);
  }
  return result;
}

double Shape::area() const {
  double sum = 0.0;
  const std::vector<bool> counts = counted();
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (counts[f]) sum += face_area(as_index(f));
  return sum;
}

double Shape::capacity() const {
  if (density.empty()) return area();
  double sum = 0.0;
  const std::vector<bool> counts = counted();
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (counts[f]) sum += face_area(as_index(f)) * densities(as_index(f)).mean();
  return sum;
}

Vec3 Shape::densities(std::int32_t face) const {
  if (density.empty()) return Vec3::Ones();
  const auto f = static_cast<std::size_t>(face);
  Vec3 result;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t at[] = {static_cast<std::size_t>(faces[f][c]), f, 3 * f + c};
    result[static_cast<Eigen::Index>(c)] = density[at[static_cast<std::size_t>(density_at)]];
  }
  return result;
}

void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }

Shape with_density(Shape shape, const DensityFunction& density) {
  shape.density.resize(shape.vertices.size());
  std::transform(shape.vertices.begin(), shape.vertices.end(), shape.density.begin(), density);
  return shape;
}

Shape with_face_density(Shape shape, const DensityFunction& density) {
  shape.density_at = DensityAt::kFaces;
  shape.density.clear();
  for (std::size_t f = 0; f < shape.faces.size(); ++f)
    shape.density.push_back(density(shape.point(as_index(f), Vec3::Constant(1.0 / 3.0))));
  return shape;
}

Shape with_corner_density(Shape shape, const DensityFunction& density) {
  shape.density_at = DensityAt::kCorners;
  shape.density.clear();
  for (std::size_t f = 0; f < shape.faces.size(); ++f)
    for (const std::int32_t v : shape.faces[f])
      shape.density.push_back(density(shape.vertices[static_cast<std::size_t>(v)]) *
                              static_cast<double>(1 + f % 3));
  return shape;
}

Shape mapped(Shape shape, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& p : shape.vertices) p = map(p);
  return shape;
}

Shape joined(const Shape& a, const Shape& b) {
  Shape result = a;
  const std::int32_t shift = as_index(a.vertices.size());
  result.vertices.insert(result.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.faces) result.faces.push_back({i + shift, j + shift, k + shift});
  return result;
}

Shape triangle() { return {"Triangle", {{0, 0, 0}, {1, 0, 0}, {0.25, 1, 0.5}}, {{0, 1, 2}}}; }

Shape tetrahedron() {
  return {"Tetrahedron",
          {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
          {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
}

Shape octahedron() {
  return {"Octahedron",
          {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

Shape grid(int cells) {
  return lattice("Grid", cells, cells, false, false,
                 [](double u, double v) { return Vec3(u, v, 0); });
}

Shape box(int cells) {
  const Shape side = grid(cells);
  Shape sum{"Box", {}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const auto turn = [axis](double a, double b, double c) {
      Vec3 p;
      p[axis] = a;
      p[(axis + 1) % 3] = b;
      p[(axis + 2) % 3] = c;
      return p;
    };
    sum = joined(sum, mapped(side, [&](const Vec3& p) { return turn(1, p.x(), p.y()); }));
    sum = joined(sum, mapped(side, [&](const Vec3& p) { return turn(0, p.y(), p.x()); }));
  }
  return welded(sum);
}

Shape icosphere(int subdivisions) {
  Shape shape = icosahedron();
  for (int k = 0; k < subdivisions; ++k) shape = subdivided(shape);
  return named(mapped(shape, [](const Vec3& p) { return Vec3(p.normalized()); }), "Icosphere");
}

Shape blob(int subdivisions) {
  const auto bump = [](const Vec3& p) {
    return Vec3(p *
                (1.0 + 0.25 * std::sin(3.0 * p.x() + 0.5) + 0.2 * std::cos(4.0 * p.y()) * p.z()));
  };
  return named(mapped(icosphere(subdivisions), bump), "Blob");
}

Shape torus(int around, int across) {
  return lattice("Torus", around, across, true, true, [](double u, double v) {
    const double ring = 1.0 + 0.4 * std::cos(kTurn * v);
    return Vec3(ring * std::cos(kTurn * u), ring * std::sin(kTurn * u), 0.4 * std::sin(kTurn * v));
  });
}

Shape tube(int around, int along) {
  return lattice("Tube", around, along, true, false, [](double u, double v) {
    return Vec3(0.5 * std::cos(kTurn * u), 0.5 * std::sin(kTurn * u), 2.0 * v);
  });
}

Shape needle() {
  return {
      "Needle", {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-6, 0}, {0.5, -0.5, 0.1}}, {{0, 1, 2}, {1, 0, 3}}};
}

Shape two_sheets(int cells, double gap) {
  const Shape low = grid(cells);
  const auto lift = [gap](const Vec3& p) { return Vec3(p.y(), p.x(), gap); };
  return named(joined(low, mapped(low, lift)), "TwoSheets");
}

Shape two_components() {
  const auto away = [](const Vec3& p) { return Vec3(0.3 * p + Vec3(4, 0.5, 0)); };
  return named(joined(tetrahedron(), mapped(octahedron(), away)), "TwoComponents");
}

Shape many_components(int count) {
  Random random(7);
  Shape shape{"ManyComponents", {}, {}};
  for (int k = 0; k < count; ++k) {
    const Vec3 move = 5.0 * random.in_box();
    shape = joined(shape, mapped(triangle(), [&](const Vec3& p) { return Vec3(0.3 * p + move); }));
  }
  shape.name = "ManyComponents";
  return shape;
}

Shape moebius(int segments) {
  Shape shape{"Moebius", {}, {}};
  for (int k = 0; k < segments; ++k)
    for (const double side : {-0.3, 0.3}) {
      const double angle = kTurn * k / segments;
      const double ring = 1.0 + side * std::cos(0.5 * angle);
      shape.vertices.emplace_back(ring * std::cos(angle), ring * std::sin(angle),
                                  side * std::sin(0.5 * angle));
    }
  for (int k = 0; k + 1 < segments; ++k) add_quad(shape, 2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2);
  const int last = 2 * (segments - 1);
  add_quad(shape, last, last + 1, 0, 1);  // joined with half a turn
  return shape;
}

Shape fin(int cells) {
  const Shape sheet = grid(cells);
  const auto bent = [](double angle) {
    return [angle](const Vec3& p) {
      return Vec3(std::cos(angle) * p.x(), p.y(), std::sin(angle) * p.x());
    };
  };
  Shape sum = mapped(sheet, bent(0.0));
  sum = joined(sum, mapped(sheet, bent(2.0)));
  sum = joined(sum, mapped(sheet, bent(4.2)));
  return named(welded(sum), "Fin");
}

Shape tee(int cells) {
  const Shape floor =
      mapped(grid(2 * cells), [](const Vec3& p) { return Vec3(p.x() - 0.5, p.y(), 0.0); });
  const Shape wall = mapped(grid(2 * cells), [](const Vec3& p) { return Vec3(0.0, p.x(), p.y()); });
  return named(welded(joined(floor, wall)), "Tee");
}

Shape bow_tie() {
  return {"BowTie",
          {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, 1, 0.2}},
          {{0, 1, 2}, {0, 4, 3}}};
}

Shape isolated_vertices() {
  Shape shape = grid(3);
  shape.name = "IsolatedVertices";
  shape.vertices.insert(shape.vertices.begin(), {{9, 9, 9}, {-5, 0, 0}});
  for (Face& face : shape.faces)
    for (std::int32_t& v : face) v += 2;
  shape.vertices.emplace_back(0, 0, 100);
  return shape;
}

Shape zero_area_faces() {
  Shape shape = grid(4);
  shape.name = "ZeroAreaFaces";
  shape.faces.insert(shape.faces.begin(), {0, 0, 1});      // two corners are the same
  shape.faces.insert(shape.faces.begin() + 7, {0, 1, 2});  // three corners on a line
  shape.faces.push_back({6, 6, 6});
  return shape;
}

Shape duplicate_faces() {
  Shape shape = grid(3);
  shape.name = "DuplicateFaces";
  shape.faces.push_back(shape.faces[4]);
  shape.faces.push_back(shape.faces[4]);
  shape.faces.push_back(shape.faces[9]);
  return shape;
}

Shape flipped_faces() {
  Shape shape = blob(1);
  shape.name = "FlippedFaces";
  for (std::size_t f = 0; f < shape.faces.size(); f += 3)
    std::swap(shape.faces[f][1], shape.faces[f][2]);
  return shape;
}

Shape soup(const Shape& shape) {
  Shape result{shape.name + "Soup", {}, {}, {}, shape.density_at};
  if (shape.density_at != DensityAt::kVertices) result.density = shape.density;
  for (const Face& face : shape.faces) {
    const std::int32_t first = as_index(result.vertices.size());
    result.faces.push_back({first, first + 1, first + 2});
    for (const std::int32_t v : face) {
      result.vertices.push_back(shape.vertices[static_cast<std::size_t>(v)]);
      if (shape.density_at == DensityAt::kVertices && !shape.density.empty())
        result.density.push_back(shape.density[static_cast<std::size_t>(v)]);
    }
  }
  return result;
}

Shape split_edges(const Shape& shape, double degrees) {
  // A corner reuses the vertex of an earlier face if the normals of the two faces are similar.
  const auto normal = [&](const Face& f) {
    const Vec3& a = shape.vertices[static_cast<std::size_t>(f[0])];
    return Vec3((shape.vertices[static_cast<std::size_t>(f[1])] - a)
                    .cross(shape.vertices[static_cast<std::size_t>(f[2])] - a))
        .normalized();
  };
  const double most = std::cos(degrees * kTurn / 360.0);
  Shape result{shape.name + "Split", {}, {}, {}, shape.density_at};
  if (shape.density_at != DensityAt::kVertices) result.density = shape.density;
  std::vector<std::vector<std::pair<std::int32_t, Vec3>>> groups(shape.vertices.size());
  for (const Face& face : shape.faces) {
    Face split;
    for (std::size_t k = 0; k < 3; ++k) {
      auto& group = groups[static_cast<std::size_t>(face[k])];
      const auto like = std::find_if(group.begin(), group.end(), [&](const auto& one) {
        return one.second.dot(normal(face)) >= most;
      });
      if (like != group.end()) {
        split[k] = like->first;
        continue;
      }
      split[k] = as_index(result.vertices.size());
      group.emplace_back(split[k], normal(face));
      result.vertices.push_back(shape.vertices[static_cast<std::size_t>(face[k])]);
      if (shape.density_at == DensityAt::kVertices && !shape.density.empty())
        result.density.push_back(shape.density[static_cast<std::size_t>(face[k])]);
    }
    result.faces.push_back(split);
  }
  return result;
}

const std::vector<Shape>& all_shapes() {
  static const std::vector<Shape> shapes = make_all_shapes();
  return shapes;
}

Shape random_shape(Random& random) {
  Shape shape;
  switch (random.below(4)) {
    case 0:
      shape = random_soup(random);
      break;
    case 1:
      shape = jittered(icosphere(random.below(2)), 0.2, random);
      break;
    case 2:
      shape = jittered(grid(1 + random.below(5)), 0.15, random);
      break;
    default:
      shape = random_hat(random);
  }
  if (random.below(2) == 0) {
    const std::size_t counts[] = {shape.vertices.size(), shape.faces.size(),
                                  3 * shape.faces.size()};
    const auto at = static_cast<std::size_t>(random.below(3));
    shape.density_at = static_cast<DensityAt>(at);
    shape.density = random.densities(counts[at]);
  }
  if (shape.capacity() <= 0.0) shape.density.clear();
  return shape;
}

Sites random_sites(const Shape& shape, std::size_t count, Random& random, bool inner) {
  std::vector<double> sums;
  double total = 0.0;
  for (std::size_t f = 0; f < shape.faces.size(); ++f)
    sums.push_back(total += shape.face_area(as_index(f)));
  Sites sites;
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = std::upper_bound(sums.begin(), sums.end() - 1, total * random.uniform());
    const auto face = as_index(static_cast<std::size_t>(at - sums.begin()));
    sites.faces.push_back(face);
    sites.positions.push_back(shape.point(face, inner ? random.inner_weights() : random.weights()));
  }
  return sites;
}

Sites degenerate_sites(const Shape& shape, std::size_t count, Random& random) {
  Sites sites = random_sites(shape, count, random);
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t face = sites.faces[k];
    const int corner = random.below(3);
    Vec3 weights = Vec3::Zero();
    switch (random.below(6)) {
      case 0: {
        const auto other = static_cast<std::size_t>(random.below(as_index(count)));
        sites.faces[k] = sites.faces[other];
        sites.positions[k] = sites.positions[other];
        break;
      }
      case 1:
        weights[corner] = 1.0;
        sites.positions[k] = shape.point(face, weights);
        break;
      case 2:
        weights[corner] = 0.25;
        weights[(corner + 1) % 3] = 0.75;
        sites.positions[k] = shape.point(face, weights);
        break;
      default:
        break;
    }
  }
  return sites;
}

Vec3 rotated(const Vec3& point, double angle) {
  return Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()) * point;
}

std::vector<Vec3> deformed(const std::vector<Vec3>& vertices, double time) {
  std::vector<Vec3> result;
  for (const Vec3& p : vertices) {
    const double swell = 1.0 + 0.15 * std::sin(time) * std::sin(2.0 * p.z());
    const Eigen::AngleAxisd bend(0.4 * std::sin(time) * p.z(), Vec3::UnitX());
    result.emplace_back(bend * Vec3(swell * p.x(), swell * p.y(), p.z()));
  }
  return result;
}

}  // namespace dapple::test
