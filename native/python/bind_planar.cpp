// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/pybind11.h>

#include <dapple/energy.hpp>
#include <dapple/planar_sampler.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "keywords.hpp"
#include "pickling.hpp"

namespace dapple {

inline auto members(PlanarSamples& s) { return std::tie(s.positions, s.classes, s.report); }
inline void check_members(const PlanarSamples& s) {
  python::check_equal(s.classes.size(), s.positions.size());
}
inline auto members(Image& i) { return std::tie(i.rows, i.columns, i.values); }

}  // namespace dapple

namespace dapple::python {
namespace {

using DomainPtr = std::shared_ptr<FlatDomain>;

std::vector<Vec2> plane_points(const char* name, const py::object& value) {
  const DoubleArray array = doubles(name, value, 2);
  static_assert(sizeof(Vec2) == 2 * sizeof(double));
  const auto* first = reinterpret_cast<const Vec2*>(array.data());
  return {first, first + array.shape(0)};
}

/// The arguments from which a Plane was created.
struct PlaneMaker {
  double width = 0.0, height = 0.0;  // of a rectangle
  bool dense = false;
  Image density = {};              // density of the rectangle, if `dense`
  std::vector<Vec2> outline = {};  // of a polygon; empty for a rectangle
  std::vector<std::vector<Vec2>> holes = {};

  [[nodiscard]] Plane make() const {
    if (!outline.empty()) return Plane::polygon(outline, holes);
    return dense ? Plane::image(width, height, density) : Plane::rectangle(width, height);
  }
};

auto members(PlaneMaker& p) {
  return std::tie(p.width, p.height, p.dense, p.density, p.outline, p.holes);
}

class MadePlane : public Plane {
 public:
  explicit MadePlane(PlaneMaker maker) : Plane(maker.make()), maker_(std::move(maker)) {}
  [[nodiscard]] const PlaneMaker& maker() const { return maker_; }

 private:
  PlaneMaker maker_;
};

std::shared_ptr<MadePlane> made(PlaneMaker&& maker) {
  return run([&] { return std::make_shared<MadePlane>(std::move(maker)); });
}

std::shared_ptr<MadePlane> make_plane(double width, double height, const py::object& density) {
  PlaneMaker maker{.width = width, .height = height};
  maker.dense = !density.is_none();
  if (maker.dense) maker.density = image_of("density", density);
  return made(std::move(maker));
}

std::shared_ptr<MadePlane> make_polygon(const py::object& outline, const py::sequence& holes) {
  PlaneMaker maker{.outline = plane_points("outline", outline)};
  if (maker.outline.empty()) throw ArgumentError("outline has 0 points: 3 or more are needed");
  for (const py::object& hole : items_of(holes)) {
    const std::string name = "holes[" + std::to_string(maker.holes.size()) + "]";
    maker.holes.push_back(plane_points(name.c_str(), hole));
  }
  return made(std::move(maker));
}

std::shared_ptr<Torus> make_torus(const py::object& density) {
  if (density.is_none()) return std::make_shared<Torus>();
  const Image image = image_of("density", density);
  return run([&] { return std::make_shared<Torus>(image); });
}

std::shared_ptr<PlanarSamples> sample_domain(const FlatDomain& domain, Count count,
                                             const py::kwargs& keywords) {
  const Keywords given(kSample, keywords);
  const SampleOptions options = given.options();
  const ContextPtr context = given.context();
  return run(context, [&](Context* watched) {
    return std::make_shared<PlanarSamples>(sample(domain, count, options, watched));
  });
}

std::shared_ptr<Energy> energy_of(const FlatDomain& domain, const py::object& positions,
                                  const py::kwargs& keywords) {
  const std::vector<Vec2> points = plane_points("positions", positions);
  const SampleOptions options = Keywords(kEvaluateEnergy, keywords, {}).options();
  return run(nullptr, [&](Context* watched) {
    return std::make_shared<Energy>(evaluate_energy(*domain.with_cells(options.cells),
                                                    domain.sites(points),
                                                    options.optimizer.capacity_weight, watched));
  });
}

py::array positions_of(const py::object& self) {
  const std::vector<Vec2>& points = self.cast<const PlanarSamples&>().positions;
  return view(self, points.empty() ? nullptr : points[0].data(),
              {static_cast<py::ssize_t>(points.size()), 2});
}

void bind_domains(py::module_& m) {
  py::class_<FlatDomain, DomainPtr>(m, "FlatDomain", "A Plane or a Torus.")
      .def_property_readonly("area", &FlatDomain::area, "In squared units of the coordinates.")
      .def_property_readonly("capacity", &FlatDomain::capacity, "Integral of the density.")
      .def(
          "spacing", [](const FlatDomain& d, Count count) { return d.spacing(count); },
          py::arg("count"),
          "Distance between neighbors if count points were packed hexagonally: "
          "sqrt(2 area / (sqrt(3) count)).");

  py::class_<MadePlane, FlatDomain, std::shared_ptr<MadePlane>> plane(m, "Plane",
                                                                      R"(A piece of the plane.

Plane(width, height) is the rectangle [0, width] x [0, height]; see also Plane.polygon.

Args:
    width, height: finite, > 0.
    density: (rows, columns) float64 >= 0, or None for 1 everywhere: an image over the rectangle, its row 0 at y = 0. The
        values hold at the centers of the pixels; between them the density is linear on triangles, beyond them constant.

Raises:
    ValueError: naming the argument out of range, or the first value that is not finite or negative.)");
  def_pickle<MadePlane>(
      plane, "Plane", [](const MadePlane& p) { return packed(p.maker()); },
      [](const py::object& state) {
        PlaneMaker maker;
        unpack(state, maker);
        return std::move(*made(std::move(maker)));
      });
  plane
      .def(py::init(&make_plane), py::arg("width"), py::arg("height"),
           py::arg("density") = py::none())
      .def_static("polygon", &make_polygon, py::arg("outline"), py::arg("holes") = py::tuple(),
                  R"(A polygon with holes, of density 1.

Args:
    outline: (k, 2) float64, the corners in order, either way round.
    holes: a sequence of such arrays, inside the outline and apart from each other.

Returns:
    Plane.

Raises:
    ValueError: naming the first point that is not finite or repeats another, the edge that crosses or touches another,
        the ring of fewer than 3 points, the hole that is not inside.)")
      .def_property_readonly(
          "surface", [](const MadePlane& d) { return std::make_shared<Surface>(d.surface()); },
          "The same domain as a flat Surface, z = 0.");

  py::class_<Torus, FlatDomain, std::shared_ptr<Torus>> torus(
      m, "Torus",
      R"(The unit square, its opposite sides joined.

Args:
    density: (rows, columns) float64 >= 0, or None for 1 everywhere: an image over the square that goes on periodically,
        its row 0 at y = 0. The values hold at the centers of the pixels; between them the density is linear on triangles.

Raises:
    ValueError: naming the first value that is not finite or negative.)");
  def_pickle<Torus>(
      torus, "Torus",
      [](const Torus& t) {
        return py::make_tuple(t.density() ? packed(*t.density()) : py::object(py::none()));
      },
      [](const py::object& state) {
        const auto items = state.cast<py::tuple>();
        if (items.size() != 1) throw ArgumentError("it has another number of members");
        if (py::object(items[0]).is_none()) return Torus();
        Image image;
        unpack(py::object(items[0]), image);
        return run([&] { return Torus(image); });
      });
  torus.def(py::init(&make_torus), py::arg("density") = py::none());
}

void bind_planar_verbs(py::module_& m) {
  py::class_<PlanarSamples, std::shared_ptr<PlanarSamples>> type(m, "PlanarSamples",
                                                                 "Samples of a Plane or a Torus.");
  def_pickle<PlanarSamples>(type, "PlanarSamples");
  type.def("__len__", [](const PlanarSamples& s) { return s.positions.size(); })
      .def_property_readonly("positions", &positions_of,
                             "(n, 2) float64, a read-only view; on a Torus in [0, 1).")
      .def_property_readonly("classes", array_property(&PlanarSamples::classes), "(n,) int32.")
      .def_readonly("report", &PlanarSamples::report, "A Report.");

  def_verb(
      m, kSample, &sample_domain,
      R"(sample(domain: FlatDomain, count: int, *, {signature}, context: Context | None = None) -> PlanarSamples

Exactly count samples of a Plane or Torus, evenly spaced, unpatterned, following its density.

As sample() does on a Surface, in the plane or on the torus (Chen et al. 2012, Algorithm 1);
sample(..., **dapple.PAPER) is the paper's own way.

Args:
    domain: a Plane or a Torus.
    count: number of samples, 0..100000000.
    {options}
    context: a Context to watch and cancel it by.

Returns:
    PlanarSamples, with a report.

Raises:
    ValueError: an option out of range.
    Cancelled: through the context.)",
      py::arg("domain"), py::arg("count"));

  def_verb(
      m, kEvaluateEnergy, &energy_of,
      R"(evaluate_energy(domain: FlatDomain, positions: numpy.ndarray, *, {signature}) -> Energy

The energy at given sites of a Plane or Torus, and its gradient.

Args:
    domain: a Plane or a Torus.
    positions: (n, 2) float64, in the domain; on a Torus any, standing for their places in the square.
    {options}

Returns:
    Energy; its gradient has z = 0.

Raises:
    ValueError: naming the first position that is not finite or outside.)",
      py::arg("domain"), py::arg("positions"));
}

}  // namespace

void bind_planar(py::module_& m) {
  bind_domains(m);
  bind_planar_verbs(m);
}

}  // namespace dapple::python
