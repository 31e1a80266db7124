// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <dapple/projector.hpp>
#include <dapple/remesh.hpp>
#include <span>
#include <vector>

#include "remesh/dual.hpp"

namespace dapple {

/// Where a mesh and the surface that it is made from are too far apart.
struct FarPlaces {
  std::vector<Violation> places;  ///< of the surface, farthest first
  double largest = 0.0;           ///< distance of all places that were looked at
};

/// How far a mesh and the surface that it is made from are apart.
struct MeshDistances {
  std::vector<double> of_vertices;  ///< the largest of the places nearest to each or beside it
  double largest = 0.0;
};

/// Compares vertices, middles of edges and middles of faces of each of both with the other.
class DistanceCheck {
 public:
  /// \throw Cancelled
  DistanceCheck(const Surface& surface, const FeatureLines& lines, const Context* context);

  /// \throw Cancelled
  [[nodiscard]] FarPlaces far_places(const Dual& dual, const Sites& sites, double limit,
                                     const Context* context) const;

  /// \throw Cancelled
  [[nodiscard]] MeshDistances distances(const RemeshResult& mesh, const Context* context) const;

 private:
  void add_old(const Projector& mesh, double limit, const Context* context, FarPlaces& result,
               std::vector<double>& distances) const;
  void add_new(const Dual& dual, const Sites& sites, double limit, const Context* context,
               FarPlaces& result, std::vector<double>& distances) const;

  Projector projector_;
  std::vector<Place> old_;  // on lines first, so that equals are there
};

}  // namespace dapple
