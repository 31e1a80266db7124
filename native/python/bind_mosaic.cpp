// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <algorithm>
#include <dapple/mosaic.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(Tile& t) { return std::tie(t.cell_area, t.area, t.parts, t.loops); }
inline auto members(Mosaic& m) {
  return std::tie(m.vertices, m.corners, m.starts, m.sites, m.classes, m.faces, m.sides, m.tiles);
}

}  // namespace dapple

namespace dapple::python {
namespace {

std::ptrdiff_t empty_tiles(const Mosaic& mosaic) {
  return std::ranges::count(mosaic.tiles, 0, &Tile::parts);
}

/// \throw the exception that a warning filter raises
void warn_of_empty_tiles(const Mosaic& mosaic, const MosaicOptions& options, double spacing) {
  const auto empty = static_cast<std::size_t>(empty_tiles(mosaic));
  if (empty == 0 || (options.grout == 0.0 && options.insets.empty())) return;
  const std::string said =
      py::str(
          "{} of {} tiles are empty: nothing is left beside a grout of {:.6g}{}, where "
          "neighbors are about {:.6g} apart")
          .format(empty, mosaic.tiles.size(), options.grout,
                  options.insets.empty() ? "" : " and the insets", spacing);
  if (PyErr_WarnEx(PyExc_UserWarning, said.c_str(), 1) != 0) throw py::error_already_set();
}

std::shared_ptr<Mosaic> make_mosaic(const Surface& surface, const Samples& samples,
                                    const py::kwargs& keywords) {
  const Keywords given(kMosaic, keywords, {"insets", "context"});
  MosaicOptions options = given.options();
  if (const py::object insets = given.other("insets"); !insets.is_none()) {
    const DoubleArray values = doubles("insets", insets, 0);
    options.insets.assign(values.data(), values.data() + values.size());
  }
  const ContextPtr context = given.context();
  const auto made = run(context, [&](Context* watched) {
    return std::make_shared<Mosaic>(mosaic(surface, samples, options, watched));
  });
  if (!made->tiles.empty())
    warn_of_empty_tiles(*made, options, surface.spacing(made->tiles.size()));
  return made;
}

/// A property that copies one member of every tile into an array.
template <typename Member>
auto tile_property(Member Tile::*member) {
  return [member](const Mosaic& mosaic) {
    std::vector<Member> values;
    values.reserve(mosaic.tiles.size());
    for (const Tile& tile : mosaic.tiles) values.push_back(tile.*member);
    return give(std::move(values));
  };
}

py::array sides_of(const Mosaic& mosaic) {
  std::vector<std::int32_t> values;
  values.reserve(mosaic.size());
  for (const TileSide side : mosaic.sides) values.push_back(static_cast<std::int32_t>(side));
  return give(std::move(values));
}

}  // namespace

void bind_mosaic(py::module_& m) {
  py::class_<Mosaic, std::shared_ptr<Mosaic>> type(
      m, "Mosaic",
      "A mesh of m polygons: the tiles of n samples one after another; tiles share no vertices. "
      "See mosaic().");
  def_pickle<Mosaic>(type, "Mosaic");
  type.def("__len__", &Mosaic::size)
      .def_property_readonly("vertices", array_property(&Mosaic::vertices),
                             "(v, 3) float64, a read-only view.")
      .def_property_readonly(
          "corners", array_property(&Mosaic::corners),
          "(c,) int32: vertex indices, polygon after polygon, counter-clockwise from outside.")
      .def_property_readonly("starts", array_property(&Mosaic::starts),
                             "(m + 1,) int32: polygon k is corners[starts[k]:starts[k + 1]].")
      .def_property_readonly("sites", array_property(&Mosaic::sites),
                             "(m,) int32: index of the sample whose tile a polygon is of.")
      .def_property_readonly("classes", array_property(&Mosaic::classes),
                             "(m,) int32: class of that sample.")
      .def_property_readonly(
          "faces", array_property(&Mosaic::faces),
          "(m,) int32: a face of the surface that the polygon lies on or belongs to.")
      .def_property_readonly("sides", &sides_of, "(m,) int32: 0 top, 1 wall, 2 bottom.")
      .def_property_readonly("cell_areas", tile_property(&Tile::cell_area),
                             "(n,) float64: of the cell of each sample.")
      .def_property_readonly("areas", tile_property(&Tile::area),
                             "(n,) float64: of what the grout leaves of it.")
      .def_property_readonly(
          "parts", tile_property(&Tile::parts),
          "(n,) int32: pieces of each tile, connected over edges; 0 where the grout takes all.")
      .def_property_readonly("empty", &empty_tiles, "Number of tiles of which nothing is left.")
      .def_property_readonly(
          "loops", tile_property(&Tile::loops),
          "(n,) int32: closed borders of each tile; a hole adds one, a whole component has none.");

  def_verb(
      m, kMosaic, &make_mosaic,
      R"(mosaic(surface: Surface, samples: Samples, *, {signature}, insets: numpy.ndarray | None = None, context: Context | None = None) -> Mosaic

The restricted Voronoi cells of samples as tiles (Chen et al. 2012, section 5.3 and Fig. 16a).

A tile follows the surface over faces and creases. It is the part of its cell that is farther than half the grout, and
its inset, from each plane half-way to a neighbor: straight joints of constant width. Without grout and insets neighbors
have the same points where they touch, so that tiles whose vertices are merged by place are closed where the surface is.
If tiles are empty, a warning states their number.

Args:
    surface: the Surface the samples lie on.
    samples: Samples.
    {options}
    insets: (n,) float64 >= 0: additional distance between each tile and its bisectors; None: 0.
    context: a Context for progress and cancel.

Returns:
    Mosaic.

Raises:
    ValueError: naming the option, or the first inset, that is negative or not finite.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("samples"));
}

}  // namespace dapple::python
