// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/symmetric_samples.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(SymmetricSamples& s) { return std::tie(s.samples, s.mirror, s.mirror_error); }
inline void check_members(const SymmetricSamples& s) {
  python::check_equal(s.mirror.size(), s.samples.size());
}

}  // namespace dapple

namespace dapple::python {
namespace {

/// Three numbers of an argument; the default if it is None or not given.
Vec3 three_numbers(const char* name, const py::object& given, const Vec3& otherwise) {
  if (given.is_none()) return otherwise;
  const DoubleArray array = doubles(name, given, 0);
  if (array.shape(0) != 3)
    throw ArgumentError(std::string(name) + " has the shape " + shape_text(array) +
                        ": (3,) is needed");
  return {array.at(0), array.at(1), array.at(2)};
}

std::shared_ptr<SymmetricSamples> sample_in_pairs(const Surface& surface, Count count,
                                                  const py::kwargs& keywords) {
  const Keywords given(kSampleSymmetric, keywords, {"normal", "point", "context"});
  SymmetryOptions options = given.options();
  options.normal = three_numbers("normal", given.other("normal"), options.normal);
  options.point = three_numbers("point", given.other("point"), options.point);
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<SymmetricSamples>(sample_symmetric(surface, count, options, watched));
  });
}

}  // namespace

void bind_symmetry(py::module_& m) {
  py::class_<SymmetricSamples, std::shared_ptr<SymmetricSamples>> type(
      m, "SymmetricSamples",
      "n samples in pairs of mirror images; arrays are read-only views. See sample_symmetric().");
  def_pickle<SymmetricSamples>(type, "SymmetricSamples");
  type.def("__len__", [](const SymmetricSamples& s) { return s.samples.size(); })
      .def_property_readonly(
          "samples",
          [](const py::object& self) {
            (void)self.cast<const SymmetricSamples&>();  // refuses one without its constructor
            const auto whole = self.cast<std::shared_ptr<SymmetricSamples>>();
            return std::shared_ptr<Samples>(whole, &whole->samples);
          },
          "The Samples: pair after pair, the one on the normal's side first, then those on the "
          "plane.")
      .def_property_readonly(
          "mirror", array_property(&SymmetricSamples::mirror),
          "(n,) int32: the index of each sample's mirror image; its own on the plane.")
      .def_readonly("mirror_error", &SymmetricSamples::mirror_error,
                    "The largest distance of a sample from the mirror image of its partner: "
                    "rounding where the surface is symmetric.");

  def_verb(
      m, kSampleSymmetric, &sample_in_pairs,
      R"(sample_symmetric(surface: Surface, count: int, *, {signature}, normal: numpy.ndarray = (1, 0, 0), point: numpy.ndarray = (0, 0, 0), context: Context | None = None) -> SymmetricSamples

Exactly count samples of a symmetric surface, evenly spaced and unpatterned, in pairs of mirror images across a plane.

Samples are first placed as by sample(). Those near the plane move onto it, the others of one side are mirrored, and the
energy of all is minimized once more among symmetric configurations. As many are on the plane as a strip of half a spacing
holds, so that it is as even and unpatterned as other places; an odd count needs a surface that crosses the plane. The
faces need not be symmetric. Where the surface is not, the image of a sample is the surface's nearest point. Where the
density is not, its mean over a place and its image counts, also in the report.

Args:
    surface: the Surface.
    count: number of samples.
    {options}
    normal: (3,) float64: normal of the plane of symmetry, of any length.
    point: (3,) float64: a point of the plane.
    context: a Context for progress and cancel.

Returns:
    SymmetricSamples.

Raises:
    ValueError: naming the option out of range, a normal of length 0, the first vertex with density whose mirror image is
        too far from the surface, or an odd count on a surface that does not cross the plane.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("count"));
}

}  // namespace dapple::python
