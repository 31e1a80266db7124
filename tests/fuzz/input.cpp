// SPDX-License-Identifier: GPL-3.0-or-later
#include "input.hpp"

#include <algorithm>
#include <cmath>
#include <dapple/errors.hpp>
#include <limits>

namespace dapple::fuzz {
namespace {

using test::Random;

std::int32_t as_index(std::size_t k) { return static_cast<std::int32_t>(k); }

/// Triangles over a few points of a lattice: coincident, collinear, coplanar, crossing, repeated.
Shape crossing(Bytes& bytes) {
  Shape shape{"Crossing", {}, {}};
  const int vertices = bytes.between(3, 14);
  for (int k = 0; k < vertices; ++k) {
    const int code = bytes.byte();
    shape.vertices.emplace_back(code % 5 - 2, code / 5 % 5 - 2, code / 25 % 5 - 2);
  }
  const int faces = bytes.between(1, 24);
  const auto corner = [&] { return static_cast<std::int32_t>(bytes.below(vertices)); };
  for (int f = 0; f < faces; ++f) {
    const Face face = {corner(), corner(), corner()};
    shape.faces.push_back(face);
  }
  return shape;
}

/// A heap of long thin triangles that share one corner.
Shape needles(Bytes& bytes) {
  Shape shape{"Needles", {Vec3::Zero()}, {}};
  Random random(bytes.byte());
  const double width = bytes.power(-9, -1);
  const int count = bytes.between(1, 20);
  for (std::int32_t k = 0; k < count; ++k) {
    const Vec3 tip = random.in_box();
    shape.vertices.push_back(tip);
    shape.vertices.push_back(tip + width * random.in_box());
    shape.faces.push_back({0, 2 * k + 1, 2 * k + 2});
  }
  return shape;
}

Shape drawn(Bytes& bytes) {
  Random random(bytes.byte());
  Shape shape = test::random_shape(random);
  shape.density.clear();
  shape.density_at = DensityAt::kVertices;
  return shape;
}

Shape regular(Bytes& bytes, int family) {
  switch (family) {
    case 0:
      return test::grid(bytes.between(1, 12));
    case 1:
      return test::icosphere(bytes.below(3));
    case 2:
      return test::box(bytes.between(1, 5));
    case 3:
      return test::blob(bytes.below(3));
    case 4: {
      const int around = bytes.between(3, 16);
      return test::torus(around, bytes.between(3, 10));
    }
    case 5: {
      const int around = bytes.between(3, 16);
      return test::tube(around, bytes.between(1, 10));
    }
    case 6:
      return test::triangle();
    default:
      return test::octahedron();
  }
}

Shape troubled(Bytes& bytes, int family) {
  switch (family) {
    case 0:
      return test::needle();
    case 1: {
      const int cells = bytes.between(1, 8);
      return test::two_sheets(cells, bytes.one_in(4) ? 0.0 : bytes.power(-9, 0));
    }
    case 2:
      return test::two_components();
    case 3:
      return test::many_components(bytes.between(1, 60));
    case 4:
      return test::moebius(bytes.between(3, 20));
    case 5:
      return test::fin(bytes.between(1, 6));
    case 6:
      return test::tee(bytes.between(1, 4));
    case 7:
      return test::bow_tie();
    case 8:
      return test::isolated_vertices();
    case 9:
      return test::zero_area_faces();
    case 10:
      return test::duplicate_faces();
    default:
      return test::flipped_faces();
  }
}

Shape family(Bytes& bytes) {
  switch (bytes.below(6)) {
    case 0:
    case 1:
      return regular(bytes, bytes.below(8));
    case 2:
      return troubled(bytes, bytes.below(12));
    case 3:
      return drawn(bytes);
    case 4:
      return crossing(bytes);
    default:
      return needles(bytes);
  }
}

/// Stretch one axis, turn, scale, move away.
Shape placed(Bytes& bytes, Shape shape) {
  const int axis = bytes.below(3);
  const double stretch = bytes.one_in(4) ? bytes.power(-8, 2) : 1.0;
  const double angle = bytes.one_in(3) ? bytes.share() : 0.0;
  const double size = bytes.one_in(4) ? bytes.power(-6, 6) : 1.0;
  const double away = bytes.one_in(4) ? bytes.power(0, 6) : 0.0;
  const Vec3 direction(1.0, -0.7, 0.3);
  return test::mapped(std::move(shape), [&](const Vec3& p) {
    Vec3 moved = p;
    moved[axis] *= stretch;
    return Vec3(size * (test::rotated(moved, angle) + away * direction));
  });
}

/// Vertices that are moved onto others, onto edges, or to any numbers. Each call that takes bytes
/// is a statement of its own: compilers differ in which argument they evaluate first.
void damage_vertices(Bytes& bytes, std::vector<Vec3>& vertices) {
  const auto any = [&] { return vertices[bytes.whole() % vertices.size()]; };
  for (int rounds = bytes.below(4); rounds > 0; --rounds) {
    Vec3& vertex = vertices[bytes.whole() % vertices.size()];
    const Vec3 a = any();
    const Vec3 b = any();
    switch (bytes.below(5)) {
      case 0:
        vertex = a;
        break;
      case 1:
        vertex = 0.5 * (a + b);
        break;
      case 2:
        vertex += bytes.power(-12, 0) * (a - b);
        break;
      case 3:
        vertex += bytes.between(-1.0, 1.0) * (a - b);
        break;
      default:
        vertex[bytes.below(3)] = bytes.wild();
    }
  }
}

void damage_faces(Bytes& bytes, Shape& shape) {
  for (int rounds = bytes.below(4); rounds > 0; --rounds) {
    Face& face = shape.faces[bytes.whole() % shape.faces.size()];
    const Face other = shape.faces[bytes.whole() % shape.faces.size()];
    const auto corner = static_cast<std::size_t>(bytes.below(3));
    switch (bytes.below(5)) {
      case 0:
        face = other;
        break;
      case 1:
        face[corner] = other[0];
        break;
      case 2:
        std::swap(face[0], face[1]);
        break;
      case 3:
        face[corner] = as_index(bytes.whole() % shape.vertices.size());
        break;
      default:
        bytes.set_wild();
        face[corner] = static_cast<std::int32_t>(bytes.whole());
    }
  }
}

/// Most are drawn, so that few bytes make many; some say each.
std::vector<double> take_numbers(Bytes& bytes, std::size_t count) {
  std::vector<double> values(count, 1.0);
  const int kind = bytes.below(4);
  Random random(bytes.byte());
  const double spread = kind == 2 ? bytes.power(0, 12) : 1.0;
  for (double& value : values) {
    if (kind == 0) value = random.below(5) == 0 ? 0.0 : random.between(0.1, 3.0);
    if (kind == 1) value = random.below(6) == 0 ? 1.0 : 0.0;
    if (kind == 2) value = std::pow(spread, random.between(-1.0, 1.0));
    if (kind == 3) value = bytes.byte() / 16.0;
  }
  if (bytes.one_in(16)) {
    values[bytes.whole() % count] = bytes.wild();
  }
  if (bytes.one_in(16)) {
    const double unit = bytes.power(-200, 200);
    for (double& value : values) value *= unit;
  }
  return values;
}

/// Of which the square of a square is no number: it is enough that such a surface is made.
bool is_extreme(double value) { return value < 1e-70 || value > 1e70; }

/// No density in a part of a surface, by the order of its vertices or faces: in single ones, in
/// half of it, in all but an island or but one. \param group numbers that belong together
void take_zeros(Bytes& bytes, std::vector<double>& values, std::size_t group) {
  const std::size_t count = values.size() / group;
  const std::size_t begin = bytes.whole() % count, length = 1 + count / 8;
  const int kind = bytes.below(4);
  Random random(bytes.byte());
  for (std::size_t k = 0; k < count; ++k) {
    const bool inside = (k + count - begin) % count < length;
    const bool zero = kind == 0   ? random.below(3) == 0
                      : kind == 1 ? k < begin
                      : kind == 2 ? !inside
                                  : k != begin;
    if (!zero) continue;
    for (std::size_t g = 0; g < group; ++g) values[k * group + g] = 0.0;
  }
}

Vec3 take_weights(Bytes& bytes) {
  Vec3 weights = Vec3::Zero();
  const int corner = bytes.below(3);
  switch (bytes.below(5)) {
    case 0:
      weights[corner] = 1.0;
      break;
    case 1:
      weights[corner] = bytes.share();
      weights[(corner + 1) % 3] = 1.0 - weights[corner];
      break;
    default: {
      const double u = bytes.share(), v = bytes.share();
      weights = u + v > 1.0 ? Vec3(u + v - 1.0, 1.0 - u, 1.0 - v) : Vec3(1.0 - u - v, u, v);
    }
  }
  return weights;
}

}  // namespace

Shape take_shape(Bytes& bytes) {
  Shape shape = family(bytes);
  if (bytes.one_in(6)) shape = test::soup(shape);
  if (bytes.one_in(6)) shape = test::split_edges(shape, bytes.between(5.0, 90.0));
  if (bytes.one_in(8) && shape.faces.size() < 200)
    shape = test::joined(shape, test::mapped(shape, [](const Vec3& p) { return p; }));
  if (bytes.one_in(2)) shape = placed(bytes, std::move(shape));
  if (bytes.one_in(3)) damage_vertices(bytes, shape.vertices);
  if (bytes.one_in(4)) damage_faces(bytes, shape);
  Values values = take_values(bytes, shape.vertices.size(), shape.faces.size());
  shape.density_at = values.at;
  shape.density = std::move(values.values);
  return shape;
}

Values take_values(Bytes& bytes, std::size_t vertices, std::size_t faces) {
  if (bytes.one_in(2)) return {};
  const int at = bytes.below(3);
  const std::size_t counts[] = {vertices, faces, 3 * faces};
  Values values{static_cast<DensityAt>(at), take_numbers(bytes, counts[at])};
  if (bytes.one_in(2))
    take_zeros(bytes, values.values, at == 2 && bytes.one_in(2) ? std::size_t{3} : 1);
  if (bytes.one_in(32)) {
    bytes.set_wild();
    values.values.pop_back();
  }
  return values;
}

std::optional<Surface> take_surface(Bytes& bytes, const Shape& shape) try {
  SurfaceOptions options;
  switch (bytes.below(8)) {
    case 5:
      options.weld = std::nullopt;
      break;
    case 6:
      options.weld = 0.0;
      break;
    case 7:
      options.weld = bytes.one_in(4) ? bytes.wild() : bytes.power(-9, -1);
      break;
    default:
      break;
  }
  options.merge_doubled = !bytes.one_in(4);
  Surface surface(shape.vertices, shape.faces, Density{shape.density_at, shape.density}, options);
  if (is_extreme(surface.area()) || is_extreme(surface.capacity())) return std::nullopt;
  return surface;
} catch (const SurfaceError&) {
  return std::nullopt;
}

std::vector<Vec3> take_frame(Bytes& bytes, const std::vector<Vec3>& vertices) {
  std::vector<Vec3> moved = vertices;
  switch (bytes.below(6)) {
    case 0:
      moved = test::deformed(vertices, bytes.between(0.0, 6.0));
      break;
    case 1: {
      const Vec3 scale{bytes.between(0.1, 3.0), bytes.between(0.1, 3.0), bytes.between(0.1, 3.0)};
      for (Vec3& p : moved) p = p.cwiseProduct(scale);
      break;
    }
    case 2: {
      const double angle = bytes.between(-3.0, 3.0);
      for (Vec3& p : moved) p = test::rotated(p, angle) + Vec3(angle, 1.0, 0.0);
      break;
    }
    case 3: {
      Random random(bytes.byte());
      const double size = bytes.power(-9, 0) * (vertices.front() - vertices.back()).norm();
      for (Vec3& p : moved) p += size * random.in_box();
      break;
    }
    case 4:
      damage_vertices(bytes, moved);
      break;
    default:
      break;  // as it was
  }
  if (bytes.one_in(16)) {
    const double size = bytes.power(-9, 9);
    for (Vec3& p : moved) p *= size;
  }
  return moved;
}

Sites take_sites(Bytes& bytes, const Surface& surface, int count) {
  Sites sites;
  for (int k = 0; k < count; ++k) {
    if (k > 0 && bytes.one_in(8)) {
      const std::size_t other = bytes.whole() % sites.size();
      sites.faces.push_back(sites.faces[other]);
      sites.barycentric.push_back(sites.barycentric[other]);
    } else {
      sites.faces.push_back(as_index(bytes.whole() % surface.face_count()));
      sites.barycentric.push_back(take_weights(bytes));
    }
    sites.positions.push_back(surface.point(sites.faces.back(), sites.barycentric.back()));
  }
  return sites;
}

std::optional<Samples> take_samples(Bytes& bytes, const Surface& surface, int most) try {
  const Sites sites = take_sites(bytes, surface, bytes.below(most + 1));
  std::vector<std::int32_t> ids, classes;
  if (bytes.one_in(4))
    for (std::size_t k = 0; k < sites.size(); ++k) ids.push_back(7 * as_index(k) + 3);
  if (bytes.one_in(4))
    for (std::size_t k = 0; k < sites.size(); ++k) classes.push_back(bytes.below(3));
  Samples samples = bind_samples(surface, sites.faces, sites.barycentric, ids, classes);
  if (samples.size() > 0 && bytes.one_in(16)) {
    bytes.set_wild();
    samples.ids[0] = std::numeric_limits<std::int32_t>::max() - bytes.byte();
    samples.positions[bytes.whole() % samples.size()][bytes.below(3)] = bytes.wild();
  }
  return samples;
} catch (const ArgumentError&) {
  return std::nullopt;
}

void take_zeros(Bytes& bytes, Image& image) {
  if (bytes.one_in(2)) take_zeros(bytes, image.values, 1);
}

Image take_image(Bytes& bytes, double most) {
  Image image;
  image.rows = static_cast<std::size_t>(bytes.between(1, 12));
  image.columns = static_cast<std::size_t>(bytes.between(1, 12));
  image.values = take_numbers(bytes, image.rows * image.columns);
  const double largest = *std::max_element(image.values.begin(), image.values.end());
  if (most > 0.0 && largest > most)
    for (double& value : image.values) value = std::min(most, value / largest * most);
  take_zeros(bytes, image);
  if (bytes.one_in(32)) {
    bytes.set_wild();
    image.rows = bytes.one_in(2) ? bytes.whole() : image.rows - 1;
  }
  return image;
}

std::size_t take_count(Bytes& bytes, int most) {
  if (!bytes.one_in(64)) return static_cast<std::size_t>(bytes.between(1, most));
  bytes.set_wild();
  return bytes.one_in(2) ? 0 : kMostSamples + 1 + bytes.byte();
}

double take_option(Bytes& bytes, const Range& range, double value) {
  switch (bytes.below(16)) {
    case 12:
      value = bytes.share();
      break;
    case 13:
      value = 4.0 * bytes.share() * (std::abs(value) < kFinite ? value : 1.0);
      break;
    case 14:
      value = bytes.power(-9, 2);
      break;
    case 15:
      bytes.set_wild();
      // Not the largest numbers: a weight of them makes every energy infinite.
      value = bytes.one_in(2) ? bytes.wild() : range.min;
      return std::isfinite(value) ? std::clamp(value, -1e12, 1e12) : value;
    default:
      return value;
  }
  return std::clamp(value, std::nextafter(range.min, kFinite), range.max);
}

std::int64_t take_option(Bytes& bytes, const Range& range, std::int64_t value) {
  switch (bytes.below(16)) {
    case 13:
    case 14:
      return bytes.between(1, 40);
    case 15:
      bytes.set_wild();
      return static_cast<std::int64_t>(std::max(range.min, -1e9)) + bytes.between(-1, 2);
    default:
      return value;
  }
}

}  // namespace dapple::fuzz
