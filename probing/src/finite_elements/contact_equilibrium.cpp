// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "finite_elements/contact_newton.h"
#include "finite_elements/contact_sensitivity.h"
#include "finite_elements/contact_system.h"
#include "finite_elements/deformable_body.h"
#include "finite_elements/near_tangent.h"
#include "finite_elements/rest_equilibrium.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kUnitTolerance = 1e-6;  // of the length of a direction
constexpr double kPatchReach = 1.2;      // [tip radii] of the faces whose contact is solved exactly
constexpr double kPatchGrowth = 1.5;     // of the reach, when the tip touches beyond
constexpr double kDetour = 1;            // [tip radii] by which the tip may stop early
constexpr double kStepRounding = 1e-12;  // of the change of a force or motion of the tip
constexpr double kSameEquilibrium = 10;  // [tolerances] of what is missing at one
constexpr int kGuessHalvings = 2;        // of the way between guesses, before they are given up

// Places whose factors are kept: those of two contacts for each thread.
std::size_t kept_places() {
  constexpr std::size_t kLeast = 4;
  return std::max<std::size_t>(kLeast, 2 * std::thread::hardware_concurrency());
}

void check_equilibrium_options(const EquilibriumOptions& o) {
  require("EquilibriumOptions::tip_radius", o.tip_radius, above(0).finite(), "mm");
  require("EquilibriumOptions::friction", o.friction, at_least(0));
  require("EquilibriumOptions::stiffness", o.stiffness, above(0).finite());
  require("EquilibriumOptions::tolerance", o.tolerance, above(0).below(1));
  require("EquilibriumOptions::load_steps", o.load_steps, at_least(1));
  require("EquilibriumOptions::max_iterations", o.max_iterations, at_least(1));
  require("EquilibriumOptions::max_halvings", o.max_halvings, at_least(0));
}

// Makes an equilibrium that was found the state of the result.
void adopt(ContactAttempt& attempted, ContactResult& result) {
  result.points = static_cast<int>(attempted.forces.contacts.size());
  result.slipping = attempted.forces.slipping;
  result.state.positions = std::move(attempted.positions);
  result.state.tip = attempted.tip;
  result.state.force = attempted.forces.tip;
  result.state.anchors = std::move(attempted.forces.anchors);
}

}  // namespace

const char* to_string(ContactStop stop) {
  switch (stop) {
    case ContactStop::converged:
      return "converged";
    case ContactStop::tip_slides:
      return "the tip slides";
    case ContactStop::contact_lost:
      return "the tip left the object";
    case ContactStop::elements_inverted:
      return "elements are inverted";
    case ContactStop::not_converged:
      return "Newton's method did not converge";
  }
  return "";
}

// The result of a series of forces at one place that the next one uses.
struct KnownEquilibrium {
  Vector3d force;  // [N]
  ContactGuess at;
};
struct ContactMemory {
  int node = 0;
  double reach = 0;                           // [mm] of the patch
  std::shared_ptr<const PlaceFactors> place;  // without factors at rest, if the patch has grown
  WorkingFactors working;
  std::vector<KnownEquilibrium> known;
};

struct ContactEquilibrium::Impl {
  DeformableBody body;
  EquilibriumOptions options;
  ContactSystem system;
  Eigen::Matrix3Xd rest;
  std::vector<BoundaryFace> faces;

  std::mutex mutex;
  std::deque<std::pair<int, std::shared_ptr<const PlaceFactors>>> places;  // newest first

  Impl(DeformableBody given, const EquilibriumOptions& o)
      : body((check_deformable_body(given), check_equilibrium_options(o), std::move(given))),
        options(o),
        system(body, options),
        rest(rest_equilibrium(body, system, options)) {
    for (const ContactFace& face : system.faces()) faces.push_back(face.face);
  }

  std::shared_ptr<const PlaceFactors> place_factors(int node, double reach) {
    {
      const std::scoped_lock lock(mutex);
      for (std::size_t i = 0; i < places.size(); ++i) {
        // Not one of larger reach: results must not depend on what was computed before.
        if (places[i].first != node || places[i].second->reach != reach) continue;
        std::rotate(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(i),
                    places.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return places.front().second;
      }
    }
    const auto place =
        std::make_shared<PlaceFactors>(order_unknowns(system, rest, rest.col(node), reach));
    factor_place(system, *place, rest, place->rest);
    const std::scoped_lock lock(mutex);
    places.emplace_front(node, place);
    if (places.size() > kept_places()) places.pop_back();
    return place;
  }

  ContactMemory begin(int node) {
    ContactMemory memory;
    memory.node = node;
    memory.reach = kPatchReach * options.tip_radius;
    memory.place = place_factors(node, memory.reach);
    return memory;
  }
  // Newton's method continues with the factors at rest.
  void forget_working_factors(ContactMemory& memory) const {
    memory.working.valid = false;
    if (!memory.place->rest.fronts.empty()) return;
    factor_place(system, *memory.place, rest, memory.working.factors);
    memory.working.valid = true;
  }
  ContactResult apply_force(const ContactState& from, const Vector3d& force, ContactMemory& memory);
  ContactResult follow(const ContactState& from, ContactGoal goal, const Vector3d& target,
                       ContactMemory& memory);
  ContactAttempt leap(const ContactState& from, const Vector3d& force, ContactMemory& memory,
                      ContactResult& counts);
  ContactAttempt attempt(const ContactState& from, const ContactStep& step, ContactMemory& memory,
                         const ContactGuess* guess, ContactResult& counts);
};

// Takes one step, with a larger patch if the tip touches beyond the one of the memory.
ContactAttempt ContactEquilibrium::Impl::attempt(const ContactState& from, const ContactStep& step,
                                                 ContactMemory& memory, const ContactGuess* guess,
                                                 ContactResult& counts) {
  ContactGuess reached;
  for (;;) {
    ContactAttempt attempted = attempt_step(system, options, largest_modulus(body), *memory.place,
                                            from, step, memory.working, guess);
    counts.iterations += attempted.iterations;
    counts.factorisations += attempted.factorisations;
    if (!attempted.outgrown) return attempted;
    if (static_cast<Eigen::Index>(memory.place->problem.root.size()) == rest.cols())
      return attempted;
    memory.reach *= kPatchGrowth;
    memory.place = std::make_shared<PlaceFactors>(
        order_unknowns(system, rest, rest.col(memory.node), memory.reach));
    reached = {std::move(attempted.positions), attempted.tip};
    guess = &reached;
    factor_place(system, *memory.place, reached.positions, memory.working.factors);
    memory.working.valid = true;
    ++counts.factorisations;
  }
}

// The equilibrium under a force that is applied in one step. Newton's method begins at the nearest
// equilibrium known, and if need be, at some on the way from there, which are guesses only.
ContactAttempt ContactEquilibrium::Impl::leap(const ContactState& from, const Vector3d& force,
                                              ContactMemory& memory, ContactResult& counts) {
  Vector3d begin = from.force;
  const ContactGuess* guess = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const KnownEquilibrium& one : memory.known) {
    if (!((one.force - force).norm() < nearest)) continue;
    nearest = (one.force - force).norm();
    begin = one.force;
    guess = &one.at;
  }
  const double least = std::ldexp(1.0, -std::min(kGuessHalvings, options.max_halvings));
  double done = 0, part = 1;
  ContactGuess reached;
  for (;;) {
    const double next = done + part;
    const ContactStep step{ContactGoal::force,
                           next >= 1 ? force : Vector3d(begin + next * (force - begin)),
                           options.exact_tangent};
    ContactAttempt attempted = attempt(from, step, memory, guess, counts);
    if (attempted.stop != ContactStop::converged) {
      part /= 2;
      forget_working_factors(memory);
      if (part < least) return attempted;
      continue;
    }
    if (next >= 1) return attempted;
    done = next;
    reached = {std::move(attempted.positions), attempted.tip};
    guess = &reached;
  }
}

ContactResult ContactEquilibrium::Impl::apply_force(const ContactState& from, const Vector3d& force,
                                                    ContactMemory& memory) {
  const bool presses = !from.anchors.empty() || force.dot(from.inward) > 0;
  if (!presses || options.load_steps > 1) return follow(from, ContactGoal::force, force, memory);
  ContactResult result;
  result.state = from;
  ContactAttempt attempted = leap(from, force, memory, result);
  result.stop = attempted.stop;
  if (attempted.stop != ContactStop::converged) {
    // Several load steps have another contact, but may have an equilibrium.
    ContactResult path = follow(from, ContactGoal::force, force, memory);
    path.iterations += result.iterations;
    path.factorisations += result.factorisations;
    return path;
  }
  result.load_steps = 1;
  adopt(attempted, result);
  memory.known.push_back({force, {result.state.positions, result.state.tip}});
  return result;
}

ContactResult ContactEquilibrium::Impl::follow(const ContactState& from, ContactGoal goal,
                                               const Vector3d& target, ContactMemory& memory) {
  ContactResult result;
  result.state = from;
  if (goal == ContactGoal::force && from.anchors.empty() && !(target.dot(from.inward) > 0)) {
    // Nothing holds a tip that does not press.
    result.stop = target.isZero(0) ? ContactStop::converged : ContactStop::contact_lost;
    return result;
  }
  const Vector3d begin = goal == ContactGoal::force ? from.force : from.tip;
  double done = 0;
  const double whole = 1.0 / options.load_steps;
  double step = whole;
  const double least = std::ldexp(whole, -options.max_halvings);
  while (done < 1 - kStepRounding) {
    const double next = std::min(1.0, done + step);
    const ContactStep goal_now{goal, next >= 1 ? target : Vector3d(begin + next * (target - begin)),
                               options.exact_tangent};
    ContactAttempt attempted = attempt(result.state, goal_now, memory, nullptr, result);
    if (attempted.outgrown) return result;
    result.stop = attempted.stop;
    if (attempted.stop != ContactStop::converged) {
      step /= 2;
      if (step < least) return result;
      continue;
    }
    ++result.load_steps;
    adopt(attempted, result);
    done = next;
  }
  result.stop = ContactStop::converged;
  return result;
}

ContactEquilibrium::ContactEquilibrium(DeformableBody body, const EquilibriumOptions& options)
    : impl_(std::make_unique<Impl>(std::move(body), options)) {}
ContactEquilibrium::~ContactEquilibrium() = default;
ContactEquilibrium::ContactEquilibrium(ContactEquilibrium&&) noexcept = default;
ContactEquilibrium& ContactEquilibrium::operator=(ContactEquilibrium&&) noexcept = default;

const DeformableBody& ContactEquilibrium::body() const { return impl_->body; }
const Eigen::Matrix3Xd& ContactEquilibrium::rest() const { return impl_->rest; }
const std::vector<BoundaryFace>& ContactEquilibrium::faces() const { return impl_->faces; }

ContactState ContactEquilibrium::touch(const Vector3d& place, const Vector3d& inward) const {
  require("ContactEquilibrium::touch(): place", place.sum(), finite(), "mm");
  require("ContactEquilibrium::touch(): inward has length", inward.norm(),
          at_least(1 - kUnitTolerance).at_most(1 + kUnitTolerance));
  const double radius = impl_->options.tip_radius;
  ContactState state;
  state.positions = impl_->rest;
  state.inward = inward.normalized();
  // The centre stops where the first point of the surface is as far away as the radius.
  double latest = std::numeric_limits<double>::infinity();
  double nearest = std::numeric_limits<double>::infinity();
  for (const ContactFace& face : impl_->system.faces()) {
    Eigen::Matrix<double, 3, 6> nodes;
    for (int k = 0; k < 6; ++k) {
      nodes.col(k) = impl_->rest.col(face.face.nodes[k]) - place;
      if (nodes.col(k).norm() >= nearest) continue;
      nearest = nodes.col(k).norm();
      state.place = face.face.nodes[k];
    }
    const auto meet = [&](const Vector3d& point) {
      const double along = point.dot(state.inward);
      const double across = (point - along * state.inward).squaredNorm();
      if (across >= radius * radius) return;
      latest = std::min(latest, along - std::sqrt(radius * radius - across));
    };
    for (int k = 0; k < 6; ++k) meet(nodes.col(k));
    for (Eigen::Index p = 0; p < face.weights.size(); ++p) meet(nodes * face.rule->shapes.col(p));
  }
  if (!std::isfinite(latest)) {
    throw InvalidInput("the tip passes the object on its way to the contact; choose a place on it");
  }
  if (latest < -radius * (1 + kDetour)) {
    throw InvalidInput(
        "the tip would be inside the object before it reaches the contact (it touches " +
        std::to_string(-latest - radius) +
        " mm earlier); choose a contact that the ball can reach, or a smaller tip_radius");
  }
  state.tip = place + latest * state.inward;
  for (const RigidBlock& block : impl_->body.obstacles) {
    const Vector3d closest = state.tip.cwiseMax(block.low).cwiseMin(block.high);
    if ((closest - state.tip).norm() < radius) {
      throw InvalidInput("the tip is inside an obstacle when it touches the contact; move it");
    }
  }
  return state;
}

ContactResult ContactEquilibrium::apply_force(const ContactState& from,
                                              const Vector3d& force) const {
  require("ContactEquilibrium::apply_force(): force", force.sum(), finite(), "N");
  ContactMemory memory = impl_->begin(from.place);
  return impl_->apply_force(from, force, memory);
}

ContactResult ContactEquilibrium::move_tip(const ContactState& from, const Vector3d& tip) const {
  require("ContactEquilibrium::move_tip(): tip", tip.sum(), finite(), "mm");
  ContactMemory memory = impl_->begin(from.place);
  return impl_->follow(from, ContactGoal::position, tip, memory);
}

struct ContactSeries::Impl {
  ContactEquilibrium::Impl& solid;
  ContactState from;
  ContactMemory memory;
};

ContactSeries::ContactSeries(const ContactEquilibrium& solid, ContactState from)
    : impl_(new Impl{*solid.impl_, std::move(from), {}}) {
  impl_->memory = impl_->solid.begin(impl_->from.place);
}
ContactSeries::~ContactSeries() = default;
ContactSeries::ContactSeries(ContactSeries&&) noexcept = default;
ContactSeries& ContactSeries::operator=(ContactSeries&&) noexcept = default;

const ContactState& ContactSeries::from() const { return impl_->from; }

ContactResult ContactSeries::apply_force(const Vector3d& force) {
  require("ContactSeries::apply_force(): force", force.sum(), finite(), "N");
  return impl_->solid.apply_force(impl_->from, force, impl_->memory);
}

TipSensitivity ContactSeries::sensitivity(const ContactState& at,
                                          std::span<const SolidChange> changes) {
  const ContactEquilibrium::Impl& solid = impl_->solid;
  const ContactState& from = impl_->from;
  const Eigen::Index nodes = at.positions.size();
  const ContactStep step{ContactGoal::force, at.force, false};
  // An equilibrium that was found in several steps is one only with the anchors that it has.
  const SystemForces in_one_step = solid.system.forces(at.positions, at.tip, &from);
  const bool one_step =
      in_one_step.valid && missing_forces(in_one_step, step).norm() <=
                               kSameEquilibrium * solid.options.tolerance * at.force.norm();
  const auto start = [&](const ContactState& first) {
    ContactState result = one_step ? first : at;
    if (!one_step) {
      result.positions += first.positions - from.positions;
      result.tip += first.tip - from.tip;
    }
    return result;
  };
  // The unbalanced forces if rest and first touch are those of a changed solid, all else equal.
  const auto missing = [&](const ContactEquilibrium& changed, const ContactState& first) {
    if (first.positions.size() != nodes)
      throw InvalidInput("ContactSeries::sensitivity(): a changed solid has other nodes");
    const ContactState begin = start(first);
    const SystemForces forces = changed.impl_->system.forces(
        at.positions + first.positions - from.positions, at.tip + first.tip - from.tip, &begin);
    if (!forces.valid)
      throw SolverError("a changed solid has inverted elements; change it by less");
    return missing_forces(forces, step);
  };
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(nodes + 3, 3 + std::ssize(changes));
  forces.bottomLeftCorner<3, 3>().setIdentity();
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const SolidChange& change = changes[k];
    forces.col(3 + static_cast<Eigen::Index>(k)) =
        (missing(*change.more, change.from_more) - missing(*change.less, change.from_less)) /
        change.step;
  }
  const Eigen::MatrixXd motions = answers_to(solid.system, solid.options, *impl_->memory.place,
                                             impl_->memory.working, start(from), at, forces)
                                      .bottomRows<3>();
  return {motions.leftCols<3>(), motions.rightCols(std::ssize(changes))};
}

std::vector<int> ContactEquilibrium::touched_nodes(const ContactState& state) const {
  std::set<int> nodes;
  for (const ContactAnchor& anchor : state.anchors) {
    // The last face whose first point is not behind the anchor's.
    const auto& all = impl_->system.faces();
    const auto after = std::ranges::upper_bound(all, anchor.point, {}, &ContactFace::first_point);
    const BoundaryFace& face = std::prev(after)->face;
    nodes.insert(face.nodes.begin(), face.nodes.end());
  }
  return {nodes.begin(), nodes.end()};
}

double ContactEquilibrium::elastic_energy(const Eigen::Matrix3Xd& positions) const {
  return impl_->system.elastic_energy(positions);
}

}  // namespace palpate::probing
