// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/energy.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple {

// The members of Moments that Python's diagram contains.
inline auto members(Moments& m) { return std::tie(m.area, m.capacity, m.mass); }
inline auto members(Energy& e) {
  return std::tie(e.total, e.cvt, e.capacity_term, e.normalized, e.gradient, e.diagram.cells);
}

}  // namespace dapple

namespace dapple::python {
namespace {

std::shared_ptr<Energy> energy_at(const Surface& surface, const py::object& positions,
                                  const py::object& faces, const py::kwargs& keywords) {
  const Keywords given(kEvaluateEnergy, keywords);
  const SampleOptions options = given.options();
  const ContextPtr context = given.context();
  const DoubleArray points = doubles("positions", positions, 3);
  const IntArray held = integers("faces", faces, 0);
  const auto p = as_points(points);
  const auto f = as_span(held);
  return run(context, [&](Context* watched) {
    auto result = std::make_shared<Energy>(
        evaluate_energy(surface, Sites{{p.begin(), p.end()}, {f.begin(), f.end()}},
                        options.optimizer.capacity_weight, options.cells, watched));
    watched->advance(1.0);
    return result;
  });
}

/// An array of one number of every cell.
template <typename Member>
auto cell_property(Member Moments::*member) {
  return [member](const Energy& energy) {
    std::vector<double> values;
    values.reserve(energy.diagram.cells.size());
    for (const Moments& cell : energy.diagram.cells) values.push_back(cell.*member);
    return give(std::move(values));
  };
}

}  // namespace

void bind_energy(py::module_& m) {
  py::class_<Energy, std::shared_ptr<Energy>> type(m, "Energy",
                                                   "The energy at given sites and its gradient.");
  def_pickle<Energy>(type, "Energy");
  type.def_readonly("total", &Energy::total, "cvt + capacity_weight * capacity_term.")
      .def_readonly("cvt", &Energy::cvt,
                    "Sum of the integrals of density^2 |x - site|^2 over the cells.")
      .def_readonly("capacity_term", &Energy::capacity_term, "Sum of the squared capacities.")
      .def_readonly("normalized", &Energy::normalized,
                    "n E / capacity^2 - capacity_weight; 0.16037 for perfect hexagons.")
      .def_property_readonly("capacities", cell_property(&Moments::capacity),
                             "(n,) float64: integral of the density over each cell.")
      .def_property_readonly("masses", cell_property(&Moments::mass),
                             "(n,) float64: integral of the squared density over each cell.")
      .def_property_readonly("areas", cell_property(&Moments::area),
                             "(n,) float64: area of each cell.")
      .def_property_readonly("gradient", array_property(&Energy::gradient),
                             "(n, 3) float64: dE/dx in space, not yet tangential.");

  def_verb(
      m, kEvaluateEnergy, &energy_at,
      R"(evaluate_energy(surface: Surface, positions: numpy.ndarray, faces: numpy.ndarray, *, {signature}, context: Context | None = None) -> Energy

Evaluate the energy and its gradient over the restricted Voronoi diagram.

E = sum of the integrals of density^2 |x - x_i|^2 + capacity_weight * sum of the squared capacities
(Chen et al. 2012, equation 6 and Theorem 2, with rho = density^2).

Args:
    surface: a Surface.
    positions: (n, 3) float64, on the surface.
    faces: (n,) int32, the faces that hold them.
    {options}
    context: a Context for progress and cancel.

Returns:
    Energy.

Raises:
    ValueError: naming the first position that is not finite, face out of range or cell that reaches
        so far that the energy is not finite.
    Cancelled: through the context.)",
      py::arg("surface"), py::arg("positions"), py::arg("faces"));
}

}  // namespace dapple::python
