// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <dapple/decals.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(Texels& t) { return std::tie(t.rows, t.columns, t.faces, t.barycentric); }
inline void check_members(const Texels& t) {
  python::check_equal(t.faces.size(), t.rows * t.columns);
  python::check_equal(t.barycentric.size(), t.faces.size());
  if (t.faces.empty()) throw ArgumentError("it has no texels");
}

}  // namespace dapple

namespace dapple::python {
namespace {

std::vector<py::ssize_t> shape_of(const Texels& texels) {
  return {static_cast<py::ssize_t>(texels.rows), static_cast<py::ssize_t>(texels.columns)};
}

std::shared_ptr<Texels> find_texels(const Surface& surface, const py::object& uv,
                                    Whole<std::size_t, "rows", 0, kMostPixels> rows,
                                    Whole<std::size_t, "columns", 0, kMostPixels> columns,
                                    Whole<int, "margin", 0, kMostInt> margin,
                                    const ContextPtr& context) {
  const DoubleArray coordinates = corner_rows("uv", uv, 2);
  return run(context, [&](Context* watched) {
    return std::make_shared<Texels>(
        texels(surface, as_face_uv(coordinates), rows, columns, margin, watched));
  });
}

py::tuple cover_texels(const Surface& surface, const Samples& samples, const py::object& radii,
                       const py::object& tangents, const Texels& texels,
                       const ContextPtr& context) {
  const DoubleArray sizes = doubles("radii", radii, 0);
  const DoubleArray directions = doubles("tangents", tangents, 3);
  DecalCover found = run(context, [&](Context* watched) {
    return decal_cover(surface, samples, as_span(sizes), as_points(directions), texels, watched);
  });
  std::vector<double> places;
  for (const Vec2& place : found.places) places.insert(places.end(), {place.x(), place.y()});
  std::vector<py::ssize_t> shape = shape_of(texels);
  const py::object samples_of = give(std::move(found.samples)).attr("reshape")(shape);
  shape.push_back(2);
  return py::make_tuple(samples_of, give(std::move(places)).attr("reshape")(shape));
}

}  // namespace

void bind_texture(py::module_& m) {
  py::class_<Texels, std::shared_ptr<Texels>> type(
      m, "Texels", "Where on a surface the texels of a picture lie; see texels().");
  def_pickle<Texels>(type, "Texels");
  type.def_property_readonly(
          "faces",
          [](const py::object& self) {
            const auto& t = self.cast<const Texels&>();
            return view(self, t.faces.data(), shape_of(t));
          },
          "(rows, columns) int32: the face under each texel, -1 where none is near.")
      .def_property_readonly(
          "barycentric",
          [](const py::object& self) {
            const auto& t = self.cast<const Texels&>();
            std::vector<py::ssize_t> shape = shape_of(t);
            shape.push_back(3);
            return view(self, t.barycentric.front().data(), shape);
          },
          "(rows, columns, 3) float64, sum 1; in the margin outside a face some are negative.");

  m.def("texels", &find_texels, py::arg("surface"), py::arg("uv"), py::arg("rows"),
        py::arg("columns"), py::kw_only(), py::arg("margin") = 4, py::arg("context") = nullptr,
        R"(Find the face under the center of each texel of a picture.

Where texture coordinates overlap, the lowest face has the texel. Texels beside the faces continue the nearest one, so
that filtering does not bleed the background in at seams.

Args:
    surface: a Surface with m faces.
    uv: (m, 3, 2) float64: texture coordinates of the corners; (0, 0) is the outer corner of the first texel, (1, 1)
        that of the last. Parts outside [0, 1] are ignored.
    rows, columns: size of the picture, >= 1; row 0 is at v = 0.
    margin: width of the margin beside the faces, in texels, >= 0.
    context: a Context for progress and cancel.

Returns:
    Texels.

Raises:
    ValueError: naming the first texture coordinate that is not finite or beyond 1e6, or the size that is 0.
    Cancelled: through the context.)");

  m.def("decal_cover", &cover_texels, py::arg("surface"), py::arg("samples"), py::arg("radii"),
        py::arg("tangents"), py::arg("texels"), py::kw_only(), py::arg("context") = nullptr,
        R"(Which sample's decal covers each texel, and where on it (Chen et al. 2012, Fig. 16b).

A square decal lies around each sample, its x axis along the tangent, y along normal x tangent; distances from its
center are kept. Faces turned away from the sample's normal belong to another sheet and get nothing.
dapple3d.texturing.bake() paints with it.

Args:
    surface: the Surface.
    samples: n Samples on it.
    radii: (n,) float64 >= 0: half the side of each decal, in the surface's units.
    tangents: (n, 3) float64, not along the normal.
    texels: from texels().
    context: a Context for progress and cancel.

Returns:
    samples: (rows, columns) int32, -1 where there is no decal.
    places: (rows, columns, 2) float64 in [-1, 1]: x and y on the decal.

Raises:
    ValueError: naming the first radius that is negative or not finite, or tangent along the normal.
    Cancelled: through the context.)");
}

}  // namespace dapple::python
