// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/line_samples.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(LineSamples& s) { return std::tie(s.samples, s.tangents, s.lines, s.lengths); }
inline void check_members(const LineSamples& s) {
  for (const std::size_t length : {s.tangents.size(), s.lines.size()})
    python::check_equal(length, s.samples.size());
}

}  // namespace dapple

namespace dapple::python {
namespace {

std::shared_ptr<LineSamples> sample_on_lines(const Surface& surface, Count count,
                                             const py::kwargs& keywords) {
  const Keywords given(kSampleLines, keywords, {"edges", "context"});
  LineOptions options = given.options();
  if (const py::object edges = given.other("edges"); !edges.is_none()) {
    const IntArray rows = integers("edges", edges, 2);
    for (py::ssize_t k = 0; k < rows.shape(0); ++k)
      options.edges.push_back({rows.at(k, 0), rows.at(k, 1)});
  }
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<LineSamples>(sample_lines(surface, count, options, watched));
  });
}

}  // namespace

void bind_lines(py::module_& m) {
  py::class_<LineSamples, std::shared_ptr<LineSamples>> type(
      m, "LineSamples",
      "n samples along the k lines of a surface; all arrays are read-only views. See "
      "sample_lines().");
  def_pickle<LineSamples>(type, "LineSamples");
  type.def("__len__", [](const LineSamples& s) { return s.samples.size(); })
      .def_property_readonly(
          "samples",
          [](const py::object& self) {
            (void)self.cast<const LineSamples&>();  // refuses one without its constructor
            const auto whole = self.cast<std::shared_ptr<LineSamples>>();
            return std::shared_ptr<Samples>(whole, &whole->samples);
          },
          "The Samples: corners first, then line after line, along each. Normals are the mean of "
          "the faces' there; report.spacing is the mean distance along lines.")
      .def_property_readonly("tangents", array_property(&LineSamples::tangents),
                             "(n, 3) float64: unit vectors along the lines.")
      .def_property_readonly("lines", array_property(&LineSamples::lines),
                             "(n,) int32: the line of each sample; -1 at corners.")
      .def_property_readonly("lengths", array_property(&LineSamples::lengths),
                             "(k,) float64: length of each line.");

  def_verb(
      m, kSampleLines, &sample_on_lines,
      R"(sample_lines(surface: Surface, count: int, *, {signature}, edges: numpy.ndarray | None = None, context: Context | None = None) -> LineSamples

Exactly count samples on creases, borders and marked edges, as many for each length as the surface's density has it.

Lines go from corner to corner: where they end, meet or turn by more than 45 degrees. Each gets samples in proportion to
the integral of the density along it (method of Sainte-Lague), and has them at equal shares of that integral. Creases that
are noise of a scan are left out as by remesh(); on meshes of fewer than 200 faces all count. Samples keep their faces and barycentric coordinates while the surface
deforms.

Args:
    surface: the Surface.
    count: number of samples, >= 1.
    {options}
    edges: (k, 2) int32: edges that are lines besides creases and borders, by their vertices. A polyline is its edges.
    context: a Context for progress and cancel.

Returns:
    LineSamples.

Raises:
    ValueError: naming the option or count out of range, a surface without lines or with a density of 0 along all of them,
        or the first of edges that is none.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("count"));
}

}  // namespace dapple::python
