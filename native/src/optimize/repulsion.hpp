// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/restricted_voronoi.hpp>
#include <optional>

#include "base/vectors.hpp"
#include "optimize/contacts.hpp"
#include "optimize/strangers.hpp"

namespace dapple {

/// Two sites nearer than they should be.
struct ClosePair {
  std::int32_t i, j;
  double overlap;    ///< 1 - distance / r_ij
  double energy;     ///< energy of the pair
  double stiffness;  ///< of the Gauss-Newton part along `direction`
  Vec3 direction;    ///< unit, from j to i
};

/// The repulsion: E_rep = weight * sum over pairs of (1 - |x_i - x_j| / r_ij)^2 for pairs nearer
/// than r_ij. It ensures a smallest distance, which capacities alone do not.
struct Repulsion {
  double energy = 0.0;
  Vectors gradient;
  std::vector<ClosePair> pairs;
};

/// A pair and the forces on its two sites.
struct Push {
  ClosePair pair;
  Vec3 force;
};

/// None if the two are not near enough to repel each other.
/// \param d from j to i
[[nodiscard]] std::optional<Push> push_between(std::size_t i, std::size_t j, const Vec3& d,
                                               double radius, double weight);

void add(Repulsion& repulsion, const Push& push);

/// The repulsion between sites with adjacent cells, in the memory of `repulsion`.
/// \param radii  r_i per site; r_ij is the mean of the two; empty for no repulsion
/// \param weight kappa (|S|_phi / n)^2
/// \param strangers pairs that repel each other though their cells do not touch
void update_repulsion(Repulsion& repulsion, const RestrictedVoronoi& diagram,
                      const std::vector<double>& radii, double weight,
                      std::span<const Stranger> strangers = {}, double stronger = 1.0);

/// Pairs of touching sites that moves bring nearer than r_ij and than they are: neither the
/// repulsion's gradient nor its stiffness knows of pairs farther apart so far.
class Approaches {
 public:
  /// The pairs that the moves, or shorter ones, may bring so near. All arguments must outlive this.
  Approaches(const RestrictedVoronoi& diagram, const std::vector<double>& radii,
             const Vectors& moves, std::span<const Stranger> strangers = {});

  /// Halve the moves of such pairs.
  /// \param moves those given first, or after calls of this
  /// \return how many sites that were
  std::size_t shorten(Vectors& moves) const;

 private:
  struct Candidate {
    std::size_t site, boundary;
  };
  [[nodiscard]] double least(std::size_t i, std::size_t j, double distance) const;
  [[nodiscard]] bool is_too_near(std::size_t i, std::size_t j, const Vec3& d,
                                 const Vectors& moves) const;

  const RestrictedVoronoi& diagram_;
  const std::vector<double>& radii_;
  std::span<const Stranger> strangers_;
  std::vector<std::vector<Candidate>> candidates_;  // per chunk of sites
};

/// Pairs of touching sites to be kept apart by kLeast r_ij: those that moves leave nearer, and
/// those around them. None if many are that near, as in white noise. \param normals of the surface,
/// per site \param locked per site, whether it stays; empty: none
[[nodiscard]] std::vector<Contact> crowded_contacts(const RestrictedVoronoi& diagram,
                                                    const std::vector<double>& radii,
                                                    const Vectors& normals,
                                                    const std::vector<bool>& locked,
                                                    const Vectors& moves,
                                                    std::span<const Stranger> strangers = {});

/// The closest of the pairs; null if there is none.
[[nodiscard]] const ClosePair* worst_pair(const Repulsion& repulsion);

/// How much it overlaps; 0 if there is none.
[[nodiscard]] double worst_overlap(const Repulsion& repulsion);

}  // namespace dapple
