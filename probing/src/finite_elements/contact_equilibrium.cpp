// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "finite_elements/contact_newton.h"
#include "finite_elements/contact_system.h"
#include "finite_elements/deformable_body.h"
#include "finite_elements/rest_equilibrium.h"
#include "palpate/error.h"
#include "palpate/require.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kUnitTolerance = 1e-6;  // of the length of a direction
constexpr double kPatchReach = 1.2;      // [tip radii] of the faces whose contact is solved exactly
constexpr double kPatchGrowth = 1.5;     // of the reach, when the tip touches beyond
constexpr double kDetour = 1;            // [tip radii] by which the tip may stop early
constexpr double kRounding = 1e-12;      // of the way of a force or of the tip

// Places whose factors are kept: for each thread one, and the same with a larger patch.
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
    factor_place(system, *place, rest, 0, place->rest, nullptr);
    const std::scoped_lock lock(mutex);
    places.emplace_front(node, place);
    if (places.size() > kept_places()) places.pop_back();
    return place;
  }

  ContactResult follow(const ContactState& from, ContactGoal goal, const Vector3d& target);
};

ContactResult ContactEquilibrium::Impl::follow(const ContactState& from, ContactGoal goal,
                                               const Vector3d& target) {
  ContactResult result;
  result.state = from;
  if (goal == ContactGoal::force && from.anchors.empty() && !(target.dot(from.inward) > 0)) {
    // Nothing holds a tip that does not press.
    result.stop = target.isZero(0) ? ContactStop::converged : ContactStop::contact_lost;
    return result;
  }
  const Vector3d begin = goal == ContactGoal::force ? from.force : from.tip;
  double reach = kPatchReach * options.tip_radius;
  auto place = place_factors(from.place, reach);
  double done = 0;
  const double whole = 1.0 / options.load_steps;
  double step = whole;
  const double least = std::ldexp(whole, -options.max_halvings);
  const double modulus = largest_modulus(body);
  bool exact = options.exact_tangent;
  while (done < 1 - kRounding) {
    const double next = std::min(1.0, done + step);
    const ContactStep goal_now{goal, next >= 1 ? target : Vector3d(begin + next * (target - begin)),
                               exact};
    ContactAttempt attempted =
        attempt_step(system, options, modulus, *place, result.state, goal_now);
    result.iterations += attempted.iterations;
    result.factorisations += attempted.factorisations;
    if (attempted.outgrown) {
      if (static_cast<Eigen::Index>(place->problem.root.size()) == rest.cols()) return result;
      reach *= kPatchGrowth;
      place = place_factors(from.place, reach);
      continue;
    }
    result.stop = attempted.stop;
    if (attempted.stop != ContactStop::converged) {
      exact = exact || step < whole;
      step /= 2;
      if (step < least) return result;
      continue;
    }
    ++result.load_steps;
    result.points = static_cast<int>(attempted.forces.contacts.size());
    result.slipping = attempted.forces.slipping;
    result.state.positions = std::move(attempted.positions);
    result.state.tip = attempted.tip;
    result.state.force = attempted.forces.tip;
    result.state.anchors = std::move(attempted.forces.anchors);
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
  return impl_->follow(from, ContactGoal::force, force);
}

ContactResult ContactEquilibrium::move_tip(const ContactState& from, const Vector3d& tip) const {
  require("ContactEquilibrium::move_tip(): tip", tip.sum(), finite(), "mm");
  return impl_->follow(from, ContactGoal::position, tip);
}

double ContactEquilibrium::elastic_energy(const Eigen::Matrix3Xd& positions) const {
  return impl_->system.elastic_energy(positions);
}

}  // namespace palpate::probing
