// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <dapple/errors.hpp>

#include "optimize/gauss_newton.hpp"
#include "sample/class_problem.hpp"
#include "shapes.hpp"

namespace dapple::test {
namespace {

constexpr int kEnough = 1000;  // conjugate gradient steps; the tolerance is reached earlier
constexpr double kDelta = 1.5;

/// Two classes on a bumpy body, with repulsion; some sites locked.
struct Fixture {
  Fixture() {
    surface = blob(3).surface();
    for (std::size_t c = 0; c < 2; ++c)
      problem.classes.push_back({std::make_shared<const SurfaceDomain>(surface), 40 + 20 * c, 0.0});
    problem.all = problem.classes[0].domain;
    objective = make_objective(problem, class_of_sites(problem), {});
    objective.locked.assign(100, false);
    for (std::size_t k = 0; k < 100; k += 9) objective.locked[k] = true;
    const Sites start = make_start(problem, Start::kRandom, 3, nullptr);
    for (Term& term : objective.terms)
      term.radii.assign(term.members.empty() ? 100 : term.members.size(), 0.3);
    state = evaluate(objective, start, nullptr);
  }

  Surface surface = blob(1).surface();
  ClassProblem problem;
  Objective objective;
  Evaluation state;
};

std::size_t site_of(const Term& term, std::int32_t cell) {
  return static_cast<std::size_t>(
      term.members.empty() ? cell : term.members[static_cast<std::size_t>(cell)]);
}

/// The derivatives of the capacities of a term's cells, a matrix with three columns per site.
Eigen::MatrixXd jacobian(const Term& term, const RestrictedVoronoi& diagram, std::size_t sites) {
  const auto cells = static_cast<std::int32_t>(diagram.cells.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(cells, static_cast<Eigen::Index>(3 * sites));
  for (std::int32_t i = 0; i < cells; ++i)
    for (const CellBoundary& side : diagram.boundary(static_cast<std::size_t>(i))) {
      const auto column = static_cast<Eigen::Index>(3 * site_of(term, i));
      result.block<1, 3>(i, column) += side.flux.transpose();
      result.block<1, 3>(side.neighbor, column) -= side.flux.transpose();
    }
  return result;
}

/// The model Hessian by its definition, as a matrix in space.
Eigen::MatrixXd dense(const Objective& objective, const Evaluation& state) {
  const auto size = static_cast<Eigen::Index>(3 * state.sites.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const Term& term = objective.terms[t];
    const Part& part = state.parts[t];
    const double scale = objective.scale(t, part.energy.diagram.cells.size());
    const Eigen::MatrixXd j = jacobian(term, part.energy.diagram, state.sites.size());
    result += 2.0 * objective.capacity_weight * scale * j.transpose() * j;
    for (std::size_t i = 0; i < part.energy.diagram.cells.size(); ++i)
      result.diagonal()
          .segment<3>(static_cast<Eigen::Index>(3 * site_of(term, static_cast<std::int32_t>(i))))
          .array() += 2.0 * kDelta * scale * part.energy.diagram.cells[i].mass;
    for (const ClosePair& pair : part.repulsion.pairs) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
      row.segment<3>(static_cast<Eigen::Index>(3 * site_of(term, pair.i))) = pair.direction;
      row.segment<3>(static_cast<Eigen::Index>(3 * site_of(term, pair.j))) = -pair.direction;
      result += scale * pair.stiffness * row * row.transpose();
    }
  }
  return result;
}

/// What anchors add to it.
Eigen::MatrixXd dense(const Hold& hold, double scale, const RestrictedVoronoi& diagram) {
  const auto size = static_cast<Eigen::Index>(3 * diagram.cells.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  const auto at = [](std::size_t k) { return static_cast<Eigen::Index>(3 * k); };
  for (std::size_t i = 0; i < diagram.cells.size(); ++i) {
    const double own = diagram.cells[i].mass;
    result.diagonal().segment<3>(at(i)).array() += 2.0 * scale * hold.stickiness * own;
    for (const CellBoundary& side : diagram.boundary(i)) {
      const auto j = static_cast<std::size_t>(side.neighbor);
      const double pair = scale * hold.smoothing * (own + diagram.cells[j].mass);
      result.diagonal().segment<3>(at(i)).array() += pair;
      result.block<3, 3>(at(i), at(j)).diagonal().array() -= pair;
    }
  }
  return result;
}

Eigen::VectorXd flat(const Vectors& v) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(3 * v.size()));
  for (std::size_t k = 0; k < v.size(); ++k)
    result.segment<3>(static_cast<Eigen::Index>(3 * k)) = v[k];
  return result;
}

Vectors stacked(const Eigen::VectorXd& v) {
  Vectors result;
  for (Eigen::Index k = 0; k < v.size(); k += 3) result.emplace_back(v.segment<3>(k));
  return result;
}

TEST(GaussNewton, SolvesItsDefinition) {
  const Fixture f;
  ASSERT_FALSE(f.state.parts[0].repulsion.pairs.empty());
  const Vectors x =
      GaussNewton(f.objective, f.state, kEnough).solve(f.state.gradient, {.delta = kDelta});
  Vectors found = stacked(dense(f.objective, f.state) * flat(x));
  f.objective.restrict(found, f.state.normals);
  const Eigen::VectorXd wanted = flat(f.state.gradient);
  EXPECT_LT((flat(found) - wanted).norm(), 0.03 * wanted.norm());
}

TEST(GaussNewton, SolvesItsDefinitionWithAnchors) {
  Fixture f;
  const Hold hold{.stickiness = 0.8, .smoothing = 2.0};
  Vectors anchors = f.state.sites.positions;
  for (std::size_t k = 0; k < anchors.size(); ++k) anchors[k].x() += 0.01 * double(k % 5);
  anchor(f.objective, f.state, anchors, hold);
  const Vectors x =
      GaussNewton(f.objective, f.state, kEnough).solve(f.state.gradient, {.delta = kDelta});
  const Eigen::MatrixXd model =
      dense(f.objective, f.state) + dense(hold, f.objective.scale(0, 100), f.state.diagram());
  Vectors found = stacked(model * flat(x));
  f.objective.restrict(found, f.state.normals);
  const Eigen::VectorXd wanted = flat(f.state.gradient);
  EXPECT_LT((flat(found) - wanted).norm(), 0.03 * wanted.norm());
}

/// What the boundaries of all terms subtract from the product of the Hessian with x.
Vectors boundaries_product(const Objective& objective, const Evaluation& state, const Vectors& x) {
  std::vector<TangentBasis> bases;
  TangentVectors v;
  for (std::size_t k = 0; k < x.size(); ++k) {
    bases.push_back(tangent_basis(state.normals[k]));
    v.push_back(to_tangent(bases[k], x[k], 1.0));
  }
  Vectors result(x.size(), Vec3::Zero());
  for (std::size_t t = 0; t < state.parts.size(); ++t) {
    const RestrictedVoronoi& diagram = state.parts[t].energy.diagram;
    BoundaryCurvature term;
    term.update(diagram, objective.terms[t].members, bases,
                objective.scale(t, diagram.cells.size()));
    for (std::size_t k = 0; k < term.cells(); ++k)
      result[term.site(k)] += to_space(bases[term.site(k)], term.product(v, k, 1.0), 1.0);
  }
  return result;
}

TEST(GaussNewton, SubtractsAShareOfTheBoundariesOfEachTerm) {
  const Fixture f;
  constexpr double kShare = 0.1;
  GaussNewton model(f.objective, f.state, kEnough);
  const Vectors x = model.solve(f.state.gradient, {kDelta, kShare});
  ASSERT_FALSE(model.is_indefinite());
  const Vectors less = boundaries_product(f.objective, f.state, x);
  Vectors found = stacked(dense(f.objective, f.state) * flat(x) - kShare * flat(less));
  f.objective.restrict(found, f.state.normals);
  const Eigen::VectorXd wanted = flat(f.state.gradient);
  EXPECT_LT((flat(found) - wanted).norm(), 0.03 * wanted.norm());
}

TEST(GaussNewton, KnowsNoBoundariesWhileAFrameIsRestored) {
  Fixture f;
  f.objective.cvt_weight = 0.3;
  EXPECT_FALSE(GaussNewton(f.objective, f.state, kEnough).has_boundaries());
}

TEST(GaussNewton, HoldsContactsApart) {
  const Fixture f;
  GaussNewton model(f.objective, f.state, kEnough);
  const Planes planes{f.state.normals, f.objective.locked};
  std::vector<Contact> contacts;
  const auto moves = [&] {
    Vectors b = f.state.gradient;
    if (!contacts.empty()) model.hold(contacts, b);
    Vectors x = model.solve(b, {.delta = kDelta});
    for (Vec3& v : x) v = -v;
    return x;
  };
  const Vectors free = moves();
  const auto pairs = [&](const auto& visit) {
    for (std::size_t i = 0; i < free.size(); ++i)
      for (const CellBoundary& side : f.state.diagram().boundary(i))
        if (const auto j = static_cast<std::size_t>(side.neighbor); j > i) visit(i, j, side.offset);
  };
  pairs([&](std::size_t i, std::size_t j, const Vec3& offset) {
    add_contact(planes, i, j, -offset, offset.norm(), 0.0, contacts);  // they touch already
  });
  std::erase_if(contacts, [&](const Contact& contact) { return !(contact.excess(free) > 0.0); });
  ASSERT_GT(contacts.size(), 10U);
  const Vectors held = moves();
  double before = 0.0, after = 0.0;
  for (const Contact& contact : contacts) {
    before += std::max(contact.excess(free), 0.0);
    after += std::max(contact.excess(held), 0.0);
  }
  EXPECT_LT(after, 0.6 * before) << "capacities push too";
}

TEST(GaussNewton, SubtractsAShareOfTheBoundariesForALattice) {
  Fixture f;
  f.objective.terms.resize(1);
  f.state.parts.resize(1);
  EXPECT_FALSE(GaussNewton(f.objective, f.state, kEnough).has_boundaries()) << "equal capacities";
  f.objective.capacity_weight = 1.0;
  GaussNewton model(f.objective, f.state, kEnough);
  ASSERT_TRUE(model.has_boundaries());
  const auto length = [&](double share) {
    const Vectors x = model.solve(f.state.gradient, {kDelta, share});
    return flat(x).norm();
  };
  const double none = length(0.0), some = length(0.1), more = length(0.2);
  EXPECT_FALSE(model.is_indefinite());
  EXPECT_LT(none, some);
  EXPECT_LT(some, more);
  (void)length(100.0);
  EXPECT_TRUE(model.is_indefinite());
}

TEST(GaussNewton, StaysInTheTangentPlanesAndLeavesLockedSites) {
  const Fixture f;
  const Vectors x =
      GaussNewton(f.objective, f.state, kEnough).solve(f.state.gradient, {.delta = kDelta});
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(x[k].dot(f.state.normals[k]), 0.0, 1e-12) << "site " << k;
    if (f.objective.locked[k]) {
      EXPECT_EQ(x[k], Vec3::Zero()) << "site " << k;
    }
  }
}

TEST(GaussNewton, DoesNotDependOnTheUnits) {
  const Fixture f;
  Fixture tiny;
  constexpr double kUnit = 1e-9;
  for (Part& part : tiny.state.parts)
    for (CellBoundary& side : part.energy.diagram.boundaries) side.flux *= kUnit;
  Objective strong = tiny.objective;
  strong.capacity_weight /= kUnit * kUnit;
  const Vectors a =
      GaussNewton(f.objective, f.state, kEnough).solve(f.state.gradient, {.delta = kDelta});
  const Vectors b =
      GaussNewton(strong, tiny.state, kEnough).solve(f.state.gradient, {.delta = kDelta});
  EXPECT_LT((flat(a) - flat(b)).norm(), 1e-4 * flat(a).norm());
}

TEST(GaussNewton, CanBeCancelled) {
  const Fixture f;
  Context context;
  GaussNewton model(f.objective, f.state, kEnough, &context);
  EXPECT_NO_THROW((void)model.solve(f.state.gradient, {.delta = kDelta}));
  context.cancel();
  EXPECT_THROW((void)model.solve(f.state.gradient, {.delta = kDelta}), Cancelled);
}

}  // namespace
}  // namespace dapple::test
