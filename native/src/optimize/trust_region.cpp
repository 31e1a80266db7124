// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimize/trust_region.hpp"

#include <algorithm>

#include "optimize/step_limit.hpp"

namespace dapple {
namespace {

// Factors by which delta changes.
constexpr double kTooLong = 2.5;  // if the step is longer than allowed
constexpr double kFar = 6.0;      // if the step exceeds the limit by more than kFarOff
constexpr double kFarOff = 4.0;   // ratio of the step to the limit above which kFar applies
constexpr double kFull = 0.4;     // after a full step
constexpr double kShortened = 2.0;
constexpr double kFailed = 4.0;
constexpr double kMost = 1e12;
// The boundaries' share: nothing at first, when cells are far from even, more after each full step,
// less after any other and where a step is too long.
constexpr double kMostShare = 0.9;  // all of it would leave some long waves without any curvature
constexpr double kTrusted = 0.5;    // with which steps are nearly Newton's
constexpr double kNearer = 0.5;     // part of the way there after a full step
constexpr double kLess = 0.7;
constexpr double kLeastShare = 0.3;  // of which nothing is left
constexpr int kSolves = 6;  // before the stored pairs are dropped because the step stays too long
constexpr int kSteps = 15;  // of conjugate gradients: steps are shortened and corrected anyway
constexpr int kExactSteps = 60;     // the long waves that a deformation causes take more iterations
constexpr int kPasses = 3;          // over the pairs that a step brings too close
constexpr double kMostHeld = 0.25;  // share of the sites that may be held back for that
constexpr double kRounding = 1e-12;  // relative rounding error of a shortened move
constexpr double kSlopeLeft = 0.5;   // share of its slope that a step keeps when it separates sites
constexpr double kFewTooFar = 0.05;  // share of all sites: if more go too far, classes cut none

/// Shortens moves that bring sites too close. It is skipped if many moves would be shortened, or if
/// there are several classes, whose repulsions may contradict that of the union; there it would
/// cost more than it gains.
Vectors keep_apart(const Objective& objective, const Evaluation& state, Vectors direction) {
  if (objective.terms.size() > 1) return direction;
  const Approaches approaches(state.diagram(), objective.terms[0].radii, direction,
                              state.parts[0].strangers);
  Vectors full = direction;
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::size_t shortened = approaches.shorten(direction);
    if (static_cast<double>(shortened) > kMostHeld * static_cast<double>(direction.size()))
      return full;
    if (shortened == 0) break;
  }
  return direction;
}

/// The repulsion radii of the cells as they are: those of the term never grow.
std::vector<double> radii_now(const Objective& objective, const Evaluation& state, std::size_t t) {
  const Term& term = objective.terms[t];
  if (term.repulsion_weight == 0.0 || term.domain->uniform()) return term.radii;
  std::vector<double> radii(term.radii.size());
  for_each_vector(radii.size(), [&](std::size_t k) {
    radii[k] = term.repulsion_radius * local_spacing(objective, state, t, k);
  });
  return radii;
}

/// Those of the values that belong to members; empty if there are no values.
template <typename Values>
Values select_values(const Values& values, const std::vector<std::int32_t>& members) {
  Values chosen;
  if (!values.empty())
    for (const std::int32_t k : members) chosen.push_back(values[static_cast<std::size_t>(k)]);
  return chosen;
}

/// Separates sites that are much nearer than others of their class or of all.
void separate_crowded(const Objective& objective, const Evaluation& state, Vectors& direction) {
  std::vector<Contact> all;
  for (std::size_t t = 0; t < objective.terms.size(); ++t) {
    const std::vector<std::int32_t>& members = objective.terms[t].members;
    const RestrictedVoronoi& diagram = state.parts[t].energy.diagram;
    const std::vector<double> radii = radii_now(objective, state, t);
    if (members.empty()) {
      all = crowded_contacts(diagram, radii, state.normals, objective.locked, direction,
                             state.parts[t].strangers);
      continue;
    }
    for (Contact contact :
         crowded_contacts(diagram, radii, select_values(state.normals, members),
                          select_values(objective.locked, members),
                          select_values(direction, members), state.parts[t].strangers)) {
      contact.i = static_cast<std::size_t>(members[contact.i]);
      contact.j = static_cast<std::size_t>(members[contact.j]);
      all.push_back(contact);
    }
  }
  separate(all, direction);
}

/// Few sites want to go much farther than all others, as those of rare classes do, whose cells are
/// large, and those beside a gap of the density. They must not shorten the moves of all. Where
/// classes and their union disagree, many moves that are too long are a sign of a bad model.
void cut_long(const Objective& objective, const Evaluation& state, double max_step,
              Vectors& direction) {
  std::vector<std::size_t> far;
  for (std::size_t k = 0; k < direction.size(); ++k)
    if (direction[k].norm() > longest_step(objective, state, max_step, k)) far.push_back(k);
  const double most = state.parts.size() > 1 ? kFewTooFar : 1.0;
  if (static_cast<double>(far.size()) > most * static_cast<double>(direction.size())) return;
  for (const std::size_t k : far)
    direction[k] *= longest_step(objective, state, max_step, k) / direction[k].norm();
}

}  // namespace

bool TrustRegion::follows_model() const {
  return trust_.delta <= least_delta_ && trust_.boundaries >= kTrusted;
}

void TrustRegion::trust_boundaries_less() {
  trust_.boundaries = trust_.boundaries > kLeastShare ? kLess * trust_.boundaries : 0.0;
}

// A larger delta shortens the model's own step, but not the contribution of stored pairs with
// little curvature.
Vectors TrustRegion::step(const Objective& objective, const Evaluation& state,
                          LbfgsHistory& history, const Context* context) {
  model_.update(objective, state, exact_ ? kExactSteps : kSteps, context);
  const auto restrict = [&](Vectors& v) { objective.restrict(v, state.normals); };
  if (!model_.has_boundaries()) trust_.boundaries = 0.0;
  const double first_delta = trust_.delta;
  for (int solves = 1;; ++solves) {
    const auto solve = [&](const Vectors& v) { return model_.solve(v, trust_); };
    Vectors direction = history.direction(state.gradient, restrict, solve);
    if (!is_careful() || state.parts.size() > 1) cut_long(objective, state, max_step_, direction);
    const double excess = step_excess(objective, state, max_step_, direction);
    const bool descends = dot(direction, state.gradient) < 0.0;
    const bool overshoots = trust_.boundaries > 0.0 && model_.is_indefinite();
    if ((excess <= 1.0 + kRounding && descends && !overshoots) || trust_.delta > kMost) {
      if (objective.holds_discs) hold_discs(objective, state, direction);
      // Others would be pressed against sites that stay.
      if (is_careful() || !objective.locked.empty())
        direction = keep_apart(objective, state, std::move(direction));
      if (separates_) {
        // In a groove sites are near others that no short move leads away from.
        Vectors apart = direction;
        separate_crowded(objective, state, apart);
        if (dot(apart, state.gradient) <= kSlopeLeft * dot(direction, state.gradient))
          direction.swap(apart);
      }
      if (objective.holds_discs)
        keep_discs_apart(discs_of(objective, state), objective.locked, direction);
      if (objective.mirror) restrict(direction);
      return direction;
    }
    if (trust_.boundaries > 0.0) {
      trust_boundaries_less();
      continue;
    }
    trust_.delta *= excess > kFarOff ? kFar : kTooLong;
    if ((descends && solves < kSolves) || history.empty()) continue;
    history.forget();
    trust_.delta = first_delta;
  }
}

/// Most moves that discs stop lead nowhere unless the model knows of them: what a disc loses by
/// being stopped, others beside it may do instead.
void TrustRegion::hold_discs(const Objective& objective, const Evaluation& state,
                             Vectors& direction) {
  const std::vector<Contact> contacts =
      discs_brought_together(discs_of(objective, state), objective.locked, direction);
  if (contacts.empty()) return;
  Vectors b = state.gradient;
  model_.hold(contacts, b);
  Vectors held = model_.solve(b, trust_);
  for (Vec3& v : held) v = -v;
  objective.restrict(held, state.normals);
  cut_long(objective, state, max_step_, held);
  if (step_excess(objective, state, max_step_, held) <= 1.0 + kRounding) direction.swap(held);
}

void TrustRegion::update_radius(bool found, double shortened) {
  double& delta = trust_.delta;
  failed_ = !found;
  if (!found)
    delta *= kFailed;
  else if (shortened < 1.0)
    delta *= kShortened;
  else
    delta = std::max(least_delta_, kFull * delta);
  delta = std::min(delta, kMost);
  separates_ = found && shortened == 1.0;
  if (separates_)
    trust_.boundaries += kNearer * (kMostShare - trust_.boundaries);
  else
    trust_boundaries_less();
}

double TrustRegion::promised(const Objective& objective, const Evaluation& state,
                             const Context* context) {
  model_.update(objective, state, kSteps, context);
  return 0.5 * dot(model_.solve(state.gradient, {.delta = least_delta_}), state.gradient);
}

}  // namespace dapple
