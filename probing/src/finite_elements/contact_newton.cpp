// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/contact_newton.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "finite_elements/krylov_solve.h"
#include "finite_elements/near_tangent.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kLeastForce = 1e-6;  // [E R^2] forces below it count as none
constexpr double kFirstDepth = 1e-3;  // [tip radii] the least with which a first step begins
constexpr double kSteady = 0.1;  // [force] of residuals, where the set of contacts is nearly found
constexpr int kPatience = 8;     // iterations in which the residual must fall to half
// Residuals of contact jump when points come in, so that only large growth shortens a step.
constexpr int kFreeIterations = 6;
constexpr double kFreeGrowth = 30, kLaterGrowth = 3;
constexpr double kLeastPart = 1.0 / 128;  // of a step, before it is given up

constexpr int kMostProducts = 12;   // of the tangent with a vector, for one step
constexpr int kManyProducts = 4;    // products of a step, beyond which the matrix is factored again
constexpr double kGoodRate = 0.05;  // of residuals: below it old factors alone give the step
constexpr double kFirstTolerance = 0.3;  // of a step, over the residual, while contacts change,
constexpr double kLaterTolerance = 0.1;  // and once they are nearly found

Eigen::Matrix3Xd surface_points(const ContactFace& face, const Eigen::Matrix3Xd& positions) {
  Eigen::Matrix<double, 3, 6> nodes;
  for (int k = 0; k < 6; ++k) nodes.col(k) = positions.col(face.face.nodes[k]);
  return nodes * face.rule->shapes;
}

// Norm of what is out of balance [N].
double residual(const SystemForces& forces, const ContactStep& step) {
  const bool force = step.goal == ContactGoal::force;
  return std::hypot(forces.nodes.norm(), force ? (forces.tip - step.target).norm() : 0.0);
}

// The start of Newton's method. A tip that nothing holds is pressed in by the depth of Hertz' law,
// so that the first system has a solution.
ContactAttempt first_guess(const ContactSystem& system, double radius, double modulus,
                           const ContactState& start, const ContactStep& step) {
  ContactAttempt guess;
  guess.positions = start.positions;
  guess.tip = step.goal == ContactGoal::position ? step.target : start.tip;
  guess.forces = system.forces(guess.positions, guess.tip, &start);
  if (step.goal == ContactGoal::position) return guess;
  const double force = step.target.norm();
  double depth = std::clamp(std::cbrt(9 * force * force / (16 * modulus * modulus * radius)),
                            kFirstDepth * radius, radius / 4);
  while (guess.forces.contacts.empty() && depth < radius) {
    guess.tip = start.tip + depth * start.inward;
    guess.forces = system.forces(guess.positions, guess.tip, &start);
    depth *= 2;
  }
  return guess;
}

// The largest part of a step that does not invert elements, lose the contact or let residuals grow.
struct ShortenedStep {
  ContactAttempt next;
  double norm = 0;  // [N] of its residual
  double part = 0;
  bool accepted = false;
};

ShortenedStep shorten(const ContactSystem& system, double radius, const ContactState& start,
                      const ContactStep& goal, const ContactAttempt& now,
                      const Eigen::VectorXd& whole, double largest_norm) {
  const Eigen::Map<const Eigen::Matrix3Xd> step(whole.data(), 3, now.positions.cols());
  const Vector3d tip_step = whole.tail<3>();
  const double longest =
      std::sqrt(std::max(step.colwise().squaredNorm().maxCoeff(), tip_step.squaredNorm()));
  ShortenedStep shortened;
  for (shortened.part = std::min(1.0, radius / longest); shortened.part > kLeastPart;
       shortened.part /= 2) {
    ContactAttempt& next = shortened.next;
    next.positions = now.positions + shortened.part * step;
    next.tip = now.tip + shortened.part * tip_step;
    next.forces = system.forces(next.positions, next.tip, &start);
    shortened.norm = residual(next.forces, goal);
    shortened.accepted = next.forces.valid && std::isfinite(shortened.norm) &&
                         shortened.norm <= largest_norm &&
                         (goal.goal == ContactGoal::position || !next.forces.contacts.empty());
    if (shortened.accepted) break;
  }
  return shortened;
}

}  // namespace

bool touches_beyond(const ContactSystem& system, const PlaceFactors& place,
                    const SystemForces& forces) {
  return std::ranges::any_of(forces.contacts, [&](const FaceContact& contact) {
    const auto& nodes = system.faces()[static_cast<std::size_t>(contact.face)].face.nodes;
    return std::ranges::any_of(nodes, [&](int node) {
      const auto n = static_cast<std::size_t>(node);
      return place.root_index[n] < 0 && !system.fixed()[n];
    });
  });
}

PlaceFactors order_unknowns(const ContactSystem& system, const Eigen::Matrix3Xd& rest,
                            const Vector3d& centre, double reach) {
  PlaceFactors place;
  place.reach = reach;
  place.problem = {rest, system.elements(), system.fixed(), {}};
  const auto count = static_cast<std::size_t>(rest.cols());
  std::vector<bool> touched(count, false);
  if (reach > 0) {
    for (const ContactFace& face : system.faces()) {
      const Eigen::Matrix3Xd points = surface_points(face, rest);
      if ((points.colwise() - centre).colwise().squaredNorm().minCoeff() > reach * reach) continue;
      for (const int node : face.face.nodes) touched[static_cast<std::size_t>(node)] = true;
    }
  }
  place.root_index.assign(count, -1);
  for (std::size_t n = 0; n < count; ++n) {
    if (system.fixed()[n] || !touched[n]) continue;
    place.root_index[n] = static_cast<int>(place.problem.root.size());
    place.problem.root.push_back(static_cast<int>(n));
  }
  place.tree = nested_dissection(place.problem);
  return place;
}

void factor_place(const ContactSystem& system, const PlaceFactors& place,
                  const Eigen::Matrix3Xd& positions, NestedFactors& factors) {
  const auto tangent = [&](int element) { return system.tangent(positions, element); };
  factor_fronts(place.tree, place.problem, tangent, factors);
}

ContactAttempt attempt_step(const ContactSystem& system, const EquilibriumOptions& options,
                            double modulus, const PlaceFactors& place, const ContactState& start,
                            const ContactStep& step, WorkingFactors& working,
                            const ContactGuess* guess) {
  const double radius = options.tip_radius;
  const double floor = kLeastForce * modulus * radius * radius;
  ContactAttempt now;
  if (guess) {
    now.positions = guess->positions;
    now.tip = guess->tip;
    now.forces = system.forces(now.positions, now.tip, &start);
  } else {
    now = first_guess(system, radius, modulus, start, step);
  }
  double norm = residual(now.forces, step), rate = 1;
  double best = norm;
  int best_at = 0, products = 0;
  for (int i = 0; i < options.max_iterations; ++i) {
    if (!now.forces.valid) {
      now.stop = ContactStop::elements_inverted;
      return now;
    }
    const double scale = std::max(floor, step.goal == ContactGoal::force
                                             ? std::max(step.target.norm(), start.force.norm())
                                             : now.forces.tip.norm());
    if (norm <= options.tolerance * scale) {
      now.stop = ContactStop::converged;
      return now;
    }
    now.outgrown = touches_beyond(system, place, now.forces);
    if (now.outgrown) return now;
    ++now.iterations;

    if (step.exact || products > kManyProducts) {
      factor_place(system, place, now.positions, working.factors);
      working.valid = true;
      ++now.factorisations;
    }
    const NestedFactors& factors = working.valid ? working.factors : place.rest;
    const NearTangent tangent(system, place, factors, now.forces, step.goal);
    const Eigen::VectorXd missing = missing_forces(now.forces, step);
    Eigen::VectorXd whole;
    if (rate < kGoodRate && products <= 1) {
      whole = tangent.solve(missing);
      products = 0;
    } else {
      // While many points come into contact and leave it, an exact step is not worth its time.
      const bool steady = norm < kSteady * scale;
      KrylovResult linear = krylov_solve(
          [&](const Eigen::VectorXd& motion) {
            return tangent_product(system, radius, start, step,
                                   {now.positions, now.tip, now.forces}, motion);
          },
          [&](const Eigen::VectorXd& forces) { return tangent.solve(forces); }, missing,
          {.tolerance = steady ? kLaterTolerance : kFirstTolerance, .max_products = kMostProducts});
      whole = std::move(linear.solution);
      products = linear.products;
    }
    if (!whole.allFinite()) return now;

    const double growth = i < kFreeIterations ? kFreeGrowth : kLaterGrowth;
    ShortenedStep taken = shorten(system, radius, start, step, now, whole, growth * norm);
    if (!taken.accepted && products > 0) {
      // The true tangent may be singular, where few points are in contact and slip.
      whole = tangent.solve(missing);
      taken = shorten(system, radius, start, step, now, whole, growth * norm);
    }
    if (!taken.accepted) {
      const SystemForces& failed = taken.next.forces;
      now.stop = !failed.valid             ? ContactStop::elements_inverted
                 : failed.contacts.empty() ? ContactStop::contact_lost
                                           : ContactStop::not_converged;
      return now;
    }
    rate = taken.norm / norm;
    if (taken.norm < best / 2) {
      best = taken.norm;
      best_at = i;
    }
    if (i - best_at > kPatience) break;
    norm = taken.norm;
    now.positions = std::move(taken.next.positions);
    now.tip = taken.next.tip;
    now.forces = std::move(taken.next.forces);
  }
  if (!now.forces.contacts.empty() &&
      now.forces.slipping == static_cast<int>(now.forces.contacts.size()))
    now.stop = ContactStop::tip_slides;
  return now;
}

}  // namespace palpate::probing
