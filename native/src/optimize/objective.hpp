// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <dapple/energy.hpp>

#include "optimize/anchoring.hpp"
#include "optimize/chosen_sites.hpp"
#include "optimize/discs.hpp"
#include "optimize/mirror.hpp"

namespace dapple {

/// Whether a weight of the capacities is so small that sites are to form patches of a lattice.
[[nodiscard]] constexpr bool is_lattice(double capacity_weight) { return capacity_weight < 10.0; }

/// A set of sites to be spaced evenly: all of them, or those of one class.
struct Term {
  const Domain* domain;                    ///< with the density of the set
  std::vector<std::int32_t> members = {};  ///< of all sites; empty: every site
  double weight = 1.0;                     ///< of its normalized energy in the sum
  double repulsion_radius = 0.0;    ///< distance below which its repulsion acts, in local spacings
  double repulsion_weight = 0.0;    ///< kappa
  std::vector<double> radii = {};   ///< of each member's repulsion; empty: nothing repels yet
  std::vector<double> wanted = {};  ///< target capacity of each member's cell; empty: equal for all
  double site_capacity = 0.0;       ///< of a cell on average, where the domain is a part of a
                                    ///< surface and cells are cut off at its rim; 0: its own share

  /// The capacity of all cells, if there are so many sites.
  [[nodiscard]] double capacity(std::size_t sites) const {
    return site_capacity > 0.0 ? site_capacity * static_cast<double>(sites) : domain->capacity();
  }
  /// Of one of them, on average.
  [[nodiscard]] double mean_capacity(std::size_t sites) const {
    return capacity(sites) / static_cast<double>(std::max<std::size_t>(sites, 1));
  }
};

/// The minimized function: sum over the terms of weight * n / |S|_phi^2 * (E + E_rep), each over
/// its own sites and density, and the repulsion between discs.
struct Objective {
  double capacity_weight = 0.0;  ///< lambda
  double cvt_weight = 1.0;       ///< s, of E_cvt; see Restoration
  std::vector<Term> terms = {};  ///< the first holds every site
  std::vector<const Domain*> homes =
      {};  ///< per class: where its sites may be; empty: the first term's
  std::vector<std::int32_t> classes = {};  ///< per site; empty if there is one home
  std::vector<double> discs = {};          ///< radius of each site's disc; empty if none has one
  double discs_weight = 0.0;
  bool holds_discs = false;        ///< whether no step may make two discs overlap
  double strangers_weight = 1.0;   ///< of their repulsion, relative to that of neighbors
  Anchoring anchoring = {};        ///< what ties the sites to where they began
  std::vector<bool> locked = {};   ///< per site, whether it stays where it is; empty: none
  const Mirror* mirror = nullptr;  ///< keeps all sites symmetric; null: they need not be

  [[nodiscard]] const Domain& domain() const { return *terms[0].domain; }
  [[nodiscard]] double total_weight() const;
  /// Whether one set of sites is to form patches of a lattice.
  [[nodiscard]] bool forms_lattice() const {
    return terms.size() == 1 && is_lattice(capacity_weight) && cvt_weight >= 1.0;
  }
  /// Whether the model of a step has the second derivatives of E_cvt: where a lattice is wanted,
  /// and with several classes, which take many steps. While a frame is restored, nobody waits for
  /// either.
  [[nodiscard]] bool has_curved_cvt() const {
    return forms_lattice() || (terms.size() > 1 && cvt_weight >= 1.0);
  }
  /// To normalized units: n / |S|_phi^2, times the term's weight.
  [[nodiscard]] double scale(std::size_t term, std::size_t sites) const;

  /// The nearest points of each site's domain.
  /// \param hints faces near the points
  /// \param which sites the points are of; empty: of all, in order
  [[nodiscard]] Sites project(const Vectors& points, std::span<const std::int32_t> hints,
                              std::span<const std::int32_t> which = {},
                              const Context* context = nullptr) const;

  /// Move sites along the surface; the others keep their places exactly.
  /// \return the sites that moved
  std::vector<std::int32_t> move(const Vectors& moves, Sites& sites,
                                 const Context* context = nullptr) const;

  /// Remove the normal part of moves, moves of locked sites, and what is not symmetric.
  void restrict(Vectors& v, const Vectors& normals) const;
};

/// One term at given sites.
struct Part {
  Sites sites;  ///< of the term; empty if it has all
  Energy energy;
  std::vector<Stranger> strangers;
  Repulsion repulsion;
};

/// The sites, and everything that follows from where they are.
struct Evaluation {
  Sites sites;
  Vectors normals;
  std::vector<Part> parts;
  Repulsion discs;
  Vectors gradient;    ///< of the total, restricted
  double total = 0.0;  ///< sum of the weights times (e + lambda), and the repulsion

  [[nodiscard]] const RestrictedVoronoi& diagram() const { return parts[0].energy.diagram; }
};

[[nodiscard]] Evaluation evaluate(const Objective& objective, Sites sites, Context* context);

/// The same in the memory of `state`, whose contents are discarded.
void update(Evaluation& state, const Objective& objective, Sites sites, Context* context);

/// The normals where the sites are.
void update_normals(Evaluation& state, const Objective& objective);

/// The discs around the sites; they must not outlive the two.
[[nodiscard]] Discs discs_of(const Objective& objective, const Evaluation& state);

/// \throw SurfaceError naming the first site whose cell reaches so far that the energy is not
/// finite
void check_finite_energy(const Objective& objective, const Evaluation& state);

/// Local spacing at a term's mean capacity.
/// \param k the site's index in the term
[[nodiscard]] double local_spacing(const Objective& objective, const Evaluation& state,
                                   std::size_t term, std::size_t k);

/// The mean of the local spacings of two sites.
[[nodiscard]] double spacing_between(const Objective& objective, const Evaluation& state,
                                     std::size_t i, std::size_t j);

/// Adapt the radii of the repulsion to the local spacing. They stay fixed within an iteration, so
/// that the gradient is exact, and between iterations they only shrink, so that the repulsion never
/// rises.
void shrink_radii(Objective& objective, Evaluation& state);

/// Per site the energy of its cells and pairs, with capacities relative to their means.
[[nodiscard]] std::vector<double> energy_shares(const Objective& objective,
                                                const Evaluation& state);

/// The terms' normalized energies e = n E / |S|_phi^2 - lambda, averaged by their weights.
[[nodiscard]] double normalized_energy(const Objective& objective, const Evaluation& state);

/// See energy.hpp; of the cells of a term.
[[nodiscard]] double owned_share(const Objective& objective, const Evaluation& state,
                                 std::size_t term);

/// Of them the part n E_cvt / |S|_phi^2.
[[nodiscard]] double normalized_cvt(const Objective& objective, const Evaluation& state);

/// Standard deviation / mean of the capacities: the rest is lambda times its square.
[[nodiscard]] double capacity_variation(const Objective& objective, const Evaluation& state);

/// Tie the sites to anchors, with the present masses and neighbors, and add up again.
void anchor(Objective& objective, Evaluation& state, Vectors anchors, const Hold& hold);

/// If a disc needs more area than a cell of the union has, raise its target capacity and distribute
/// the rest among the others; add up again. Otherwise the cells around large discs would be crushed
/// for an evenness that cannot be reached.
void give_room(Objective& objective, Evaluation& state);

/// Add up again with another weight of E_cvt.
void weigh_cvt(Objective& objective, Evaluation& state, double weight);

}  // namespace dapple
