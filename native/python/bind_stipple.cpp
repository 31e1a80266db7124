// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <dapple/stipple.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(Stipples& s) { return std::tie(s.positions, s.classes, s.radius, s.report); }
inline void check_members(const Stipples& s) {
  python::check_equal(s.classes.size(), s.positions.size());
}

}  // namespace dapple

namespace dapple::python {
namespace {

std::vector<Image> inks_of(const py::object& value) {
  const DoubleArray array = doubles_of_shape("inks", value, 3, "(inks, rows, columns)");
  const auto rows = static_cast<std::size_t>(array.shape(1));
  const auto columns = static_cast<std::size_t>(array.shape(2));
  std::vector<Image> inks;
  for (py::ssize_t c = 0; c < array.shape(0); ++c) {
    const double* first = array.data() + static_cast<std::size_t>(c) * rows * columns;
    inks.push_back({rows, columns, {first, first + rows * columns}});
  }
  return inks;
}

py::array to_array(std::span<const Image> images) {
  std::vector<double> values;
  for (const Image& image : images)
    values.insert(values.end(), image.values.begin(), image.values.end());
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(images.size()),
                                          static_cast<py::ssize_t>(images[0].rows),
                                          static_cast<py::ssize_t>(images[0].columns)};
  return give(std::move(values)).attr("reshape")(shape);
}

py::array separate_channels(const py::object& channels) {
  const std::vector<Image> images = inks_of(channels);
  if (images.size() != 3)
    throw ArgumentError("channels holds " + std::to_string(images.size()) +
                        ": red, green and blue are needed");
  return to_array(run([&] { return separate_inks({images[0], images[1], images[2]}); }));
}

py::array mix_seven(const py::object& value) {
  const std::vector<Image> images = inks_of(value);
  if (images.size() != kInks)
    throw ArgumentError("inks holds " + std::to_string(images.size()) + ": 7 are needed");
  std::array<Image, kInks> inks;
  std::copy(images.begin(), images.end(), inks.begin());
  return to_array(run([&] { return mix_inks(inks); }));
}

std::vector<std::size_t> counts_of(const py::sequence& counts) {
  std::vector<std::size_t> result;
  for (const py::object& one : items_of(counts)) {
    const std::string name = "counts[" + std::to_string(result.size()) + "]";
    const py::object number = whole_number(one);
    if (!number)
      throw ArgumentError(name + " is " + py::repr(one).cast<std::string>() +
                          ": a whole number is needed");
    result.push_back(bounded(name, number, 0, kMostSamples));
  }
  return result;
}

std::shared_ptr<Stipples> stipple_inks(const py::object& inks, Count count,
                                       const py::kwargs& keywords) {
  const Keywords given(kStippleInks, keywords, {"counts", "context"});
  StippleOptions options = given.options();
  if (const py::object counts = given.other("counts"); !counts.is_none())
    options.counts = counts_of(py::sequence(counts));
  const ContextPtr context = given.context();
  const std::vector<Image> images = inks_of(inks);
  return run(context, [&](Context* watched) {
    return std::make_shared<Stipples>(stipple_inks(images, count, options, watched));
  });
}

py::array positions_of(const py::object& self) {
  const std::vector<Vec2>& points = self.cast<const Stipples&>().positions;
  return view(self, points.empty() ? nullptr : points[0].data(),
              {static_cast<py::ssize_t>(points.size()), 2});
}

}  // namespace

void bind_stipple(py::module_& m) {
  py::class_<Stipples, std::shared_ptr<Stipples>> type(
      m, "Stipples", "Dots that render a picture; see stipple_inks().");
  def_pickle<Stipples>(type, "Stipples");
  type.def("__len__", [](const Stipples& s) { return s.positions.size(); })
      .def_property_readonly(
          "positions", &positions_of,
          "(n, 2) float64, a read-only view: x and y in pixels; pixel [row, column] is [column, "
          "column + 1] x [row, row + 1].")
      .def_property_readonly("classes", array_property(&Stipples::classes),
                             "(n,) int32: which ink each dot is of.")
      .def_readonly("radius", &Stipples::radius, "Of each dot, in pixels.")
      .def_readonly("report", &Stipples::report, "A Report.");

  m.def("separate_inks", &separate_channels, py::arg("channels"),
        R"(How much of each pixel each of seven inks covers: 1 - the sum is paper.

With c = 1 - red, m = 1 - green, y = 1 - blue: black takes what all three have in common, then blue (c and m), green
(c and y) or red (m and y) what the two others have in common, then cyan, magenta or yellow what is left of one.

Args:
    channels: (3, rows, columns) float64 in [0, 1]: red, green, blue.

Returns:
    (7, rows, columns) float64 in [0, 1]: red, green, blue, cyan, magenta, yellow, black.

Raises:
    ValueError: naming the first value that is not in [0, 1].)");

  m.def("mix_inks", &mix_seven, py::arg("inks"),
        R"(The color that coverages mix to side by side: the inverse of separate_inks().

Args:
    inks: (7, rows, columns) float64.

Returns:
    (3, rows, columns) float64: red, green, blue.)");

  def_verb(
      m, kStippleInks, &stipple_inks,
      R"(stipple_inks(inks: numpy.ndarray, count: int, *, {signature}, counts: Sequence[int] = [], context: Context | None = None) -> Stipples

Exactly count dots that render the coverages of one or several inks.

Error diffusion, then the planar optimization on a density that is constant on each pixel (Chen et al. 2012, sections
5.1 and 5.2). dapple.stipple() does this for a picture.

Args:
    inks: (inks, rows, columns) float64 >= 0: how much of each pixel each ink covers.
    count: number of dots, 1..100000000.
    {options}
    counts: of each ink, with the sum count; empty: in proportion to the inks' sums, by largest remainders.
    context: a Context for progress and cancel.

Returns:
    Stipples.

Raises:
    ValueError: an option out of range, the first value that is negative or not finite, a picture without any ink.
    Cancelled: through the context.)",
      py::arg("inks"), py::arg("count"));
}

}  // namespace dapple::python
