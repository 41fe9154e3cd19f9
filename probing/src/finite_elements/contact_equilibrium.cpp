// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_equilibrium.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <mutex>
#include <string>
#include <utility>

#include "finite_elements/contact_system.h"
#include "finite_elements/nested_factor.h"
#include "palpate/error.h"
#include "palpate/require.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kRestTolerance = 1e-10;  // unbalanced forces over those of supports
constexpr double kUnitTolerance = 1e-6;   // of the length of a direction
constexpr double kLeastForce = 1e-6;      // [E R^2] forces below it count as none
constexpr double kFirstDepth = 1e-3;      // [tip radii] the least with which a first step begins
constexpr double kPatchReach = 1.2;   // [tip radii] of the faces whose contact is solved exactly
constexpr double kPatchGrowth = 1.5;  // of the reach, when the tip touches beyond
constexpr double kGoodRate = 0.05;    // of residuals: below it even near fronts are kept,
constexpr double kPoorRate = 0.4;     // above it the whole matrix is factored anew
constexpr double kSteady = 0.1;  // [force] of residuals, where the set of contacts is nearly found
constexpr int kPatience = 8;     // iterations in which the residual must fall to half
constexpr std::size_t kKeptPlaces = 4;  // whose factors are kept

void check_equilibrium_options(const EquilibriumOptions& o) {
  require("EquilibriumOptions::tip_radius", o.tip_radius, above(0).finite(), "mm");
  require("EquilibriumOptions::friction", o.friction, at_least(0));
  require("EquilibriumOptions::stiffness", o.stiffness, above(0).finite());
  require("EquilibriumOptions::tolerance", o.tolerance, above(0).below(1));
  require("EquilibriumOptions::load_steps", o.load_steps, at_least(1));
  require("EquilibriumOptions::max_iterations", o.max_iterations, at_least(1));
  require("EquilibriumOptions::max_halvings", o.max_halvings, at_least(0));
}

void check_supports(const DeformableBody& body) {
  const Eigen::Index nodes = body.mesh.nodes.cols();
  for (const int node : body.supported) {
    if (node >= 0 && node < nodes) continue;
    throw InvalidInput("DeformableBody::supported has node " + std::to_string(node) +
                       "; there are " + std::to_string(nodes));
  }
  const auto supports = static_cast<Eigen::Index>(body.supported.size());
  if (body.support_moves.size() != 0 && body.support_moves.cols() != supports) {
    throw InvalidInput("DeformableBody::support_moves has " +
                       std::to_string(body.support_moves.cols()) +
                       " columns; it must have one for each of the " + std::to_string(supports) +
                       " supported nodes, or none");
  }
  if (!body.support_moves.allFinite())
    throw InvalidInput("DeformableBody::support_moves is not finite");
  // Parts that no element connects, each needs three supports that do not lie in a line.
  std::vector<int> part(static_cast<std::size_t>(nodes));
  for (std::size_t n = 0; n < part.size(); ++n) part[n] = static_cast<int>(n);
  const auto find = [&](int n) {
    while (part[static_cast<std::size_t>(n)] != n)
      n = part[static_cast<std::size_t>(n)] =
          part[static_cast<std::size_t>(part[static_cast<std::size_t>(n)])];
    return n;
  };
  for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e)
    for (const int node : body.mesh.elements.col(e))
      part[static_cast<std::size_t>(find(node))] = find(body.mesh.elements(0, e));
  std::vector<std::vector<int>> held(part.size());
  for (const int node : body.supported) held[static_cast<std::size_t>(find(node))].push_back(node);
  constexpr double kLine = 1e-6;  // sine of the angle below which three nodes are in a line
  for (std::size_t n = 0; n < part.size(); ++n) {
    if (find(static_cast<int>(n)) != static_cast<int>(n)) continue;
    const std::vector<int>& nodes_held = held[n];
    bool enough = false;
    for (std::size_t k = 2; k < nodes_held.size() && !enough; ++k) {
      const Vector3d a = body.mesh.nodes.col(nodes_held[1]) - body.mesh.nodes.col(nodes_held[0]);
      const Vector3d b = body.mesh.nodes.col(nodes_held[k]) - body.mesh.nodes.col(nodes_held[0]);
      enough = a.cross(b).norm() > kLine * a.norm() * b.norm();
    }
    if (enough) continue;
    throw InvalidInput("the part of the object with node " + std::to_string(n) + " has " +
                       std::to_string(nodes_held.size()) +
                       " supported nodes; it must have three or more that do not lie in a line");
  }
}

void check_deformable_body(const DeformableBody& body) {
  check_finite_element_mesh(body.mesh);
  for (const Hyperelastic& material : body.materials) check_hyperelastic(material);
  for (std::size_t e = 0; e < body.mesh.regions.size(); ++e) {
    if (static_cast<std::size_t>(body.mesh.regions[e]) < body.materials.size()) continue;
    throw InvalidInput("element " + std::to_string(e) + " is in region " +
                       std::to_string(body.mesh.regions[e]) + "; there are materials for " +
                       std::to_string(body.materials.size()) + " regions");
  }
  check_supports(body);
  for (const RigidBlock& block : body.obstacles) {
    for (int axis = 0; axis < 3; ++axis) {
      const double side = block.high[axis] - block.low[axis];
      require("RigidBlock::high - low", side, above(0).finite(), "mm");
      require("RigidBlock::rounding", block.rounding, above(0).at_most(side / 2), "mm");
    }
  }
}

// Speeds up Newton's method with an old matrix by what its last steps have shown (Anderson 1965).
class StepHistory {
 public:
  // A better step than `step`, the one that the old matrix proposes.
  Eigen::VectorXd improved(const Eigen::VectorXd& step) {
    constexpr std::size_t kDepth = 5;
    if (taken_.size() > changes_.size()) changes_.push_back(step - last_);
    if (changes_.size() > kDepth) {
      changes_.pop_front();
      taken_.pop_front();
    }
    last_ = step;
    const auto n = static_cast<Eigen::Index>(changes_.size());
    if (n == 0) return step;
    Eigen::MatrixXd gram(n, n);
    Eigen::VectorXd right(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::VectorXd& change = changes_[static_cast<std::size_t>(i)];
      right[i] = change.dot(step);
      for (Eigen::Index j = 0; j <= i; ++j)
        gram(i, j) = gram(j, i) = change.dot(changes_[static_cast<std::size_t>(j)]);
    }
    // Nearly dependent changes tell nothing more.
    constexpr double kDependent = 1e-12;  // of the largest diagonal entry
    gram.diagonal().array() += kDependent * gram.diagonal().maxCoeff();
    const Eigen::VectorXd share = gram.ldlt().solve(right);
    if (!share.allFinite()) return step;
    Eigen::VectorXd result = step;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      result -= share[i] * (taken_[k] + changes_[k]);
    }
    return result;
  }
  void took(const Eigen::VectorXd& step) { taken_.push_back(step); }
  void clear() {
    taken_.clear();
    changes_.clear();
  }

 private:
  std::deque<Eigen::VectorXd> taken_, changes_;
  Eigen::VectorXd last_;
};

Eigen::Matrix3Xd surface_points(const ContactFace& face, const Eigen::Matrix3Xd& positions) {
  Eigen::Matrix<double, 3, 6> nodes;
  for (int k = 0; k < 6; ++k) nodes.col(k) = positions.col(face.face.nodes[k]);
  return nodes * face.rule->shapes;
}

}  // namespace

// The matrix about a place of the surface: which unknowns are near, and factors at rest.
struct PlaceFactors {
  double reach = 0;  // [mm]
  NestedProblem problem;
  FrontTree tree;
  NestedFactors rest;
  std::vector<int> root_index;  // of each node; -1 elsewhere
};

enum class ContactGoal { force, position };

// Newton's method in one load step.
struct ContactAttempt {
  Eigen::Matrix3Xd positions;
  Vector3d tip;
  SystemForces forces;
  ContactStop stop = ContactStop::not_converged;
  bool outgrown = false;  // the tip touched a face outside the patch
};

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
  double modulus = 0;  // [N/mm^2] the largest Young's modulus

  std::mutex mutex;
  std::deque<std::pair<int, std::shared_ptr<const PlaceFactors>>> places;  // newest first

  Impl(DeformableBody given, const EquilibriumOptions& o)
      : body((check_deformable_body(given), check_equilibrium_options(o), std::move(given))),
        options(o),
        system(body, options) {
    for (const ContactFace& face : system.faces()) faces.push_back(face.face);
    for (const Hyperelastic& material : body.materials)
      modulus = std::max(modulus, young_modulus(material));
    relax();
  }

  std::shared_ptr<PlaceFactors> make_place(const Vector3d& centre, double reach) const {
    auto place = std::make_shared<PlaceFactors>();
    place->reach = reach;
    place->problem = {rest, body.mesh.elements, system.fixed(), {}, {}};
    const auto count = static_cast<std::size_t>(rest.cols());
    std::vector<bool> patch(count, false), near(count, false);
    if (reach > 0) {
      for (const ContactFace& face : system.faces()) {
        const Eigen::Matrix3Xd points = surface_points(face, rest);
        if ((points.colwise() - centre).colwise().squaredNorm().minCoeff() > reach * reach)
          continue;
        for (const int node : face.face.nodes) patch[static_cast<std::size_t>(node)] = true;
      }
    }
    for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
      const auto element = body.mesh.elements.col(e);
      const bool beside = std::any_of(element.begin(), element.end(), [&](int node) {
        return patch[static_cast<std::size_t>(node)];
      });
      if (!beside) continue;
      for (const int node : element) near[static_cast<std::size_t>(node)] = true;
    }
    place->root_index.assign(count, -1);
    for (std::size_t n = 0; n < count; ++n) {
      if (system.fixed()[n]) continue;
      const int node = static_cast<int>(n);
      if (patch[n]) {
        place->root_index[n] = static_cast<int>(place->problem.root.size());
        place->problem.root.push_back(node);
      } else if (near[n]) {
        place->problem.near.push_back(node);
      }
    }
    place->tree = nested_dissection(place->problem);
    return place;
  }

  void factor(const PlaceFactors& place, const Eigen::Matrix3Xd& positions, int first,
              NestedFactors& factors, const NestedFactors* below) const {
    factor_fronts(
        place.tree, first, place.problem, [&](int e) { return system.tangent(positions, e); },
        factors, below);
  }

  std::shared_ptr<const PlaceFactors> place_factors(const ContactState& state, double at_least) {
    {
      const std::scoped_lock lock(mutex);
      for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i].first != state.place || places[i].second->reach < at_least) continue;
        std::rotate(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(i),
                    places.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        return places.front().second;
      }
    }
    const auto place = make_place(rest.col(state.place), at_least);
    factor(*place, rest, 0, place->rest, nullptr);
    const std::scoped_lock lock(mutex);
    places.emplace_front(state.place, place);
    if (places.size() > kKeptPlaces) places.pop_back();
    return place;
  }

  void relax();
  ContactAttempt attempt(const ContactState& start, ContactGoal goal, const Vector3d& target,
                         const PlaceFactors& place, bool exact, ContactResult& counts) const;
  ContactResult follow(const ContactState& from, ContactGoal goal, const Vector3d& target);
  double residual(const SystemForces& f, ContactGoal goal, const Vector3d& target) const {
    return std::hypot(f.nodes.norm(), goal == ContactGoal::force ? (f.tip - target).norm() : 0.0);
  }
};

// Moves supports, and finds the equilibrium without the tip.
void ContactEquilibrium::Impl::relax() {
  rest = body.mesh.nodes;
  const bool moves = body.support_moves.size() != 0;
  if (!moves && body.obstacles.empty()) return;
  const auto place = make_place(Vector3d::Zero(), 0);
  const Vector3d nowhere = Vector3d::Zero();
  NestedFactors factors;
  double done = 0, step = 1;
  const double least = std::ldexp(1.0, -options.max_halvings);
  while (done < 1) {
    const double next = std::min(1.0, done + step);
    Eigen::Matrix3Xd positions = rest;
    if (moves) {
      // The linear answer to the motion of the supports comes first, so that no element beside a
      // support is inverted by it.
      Eigen::VectorXd motion = Eigen::VectorXd::Zero(rest.size());
      for (std::size_t k = 0; k < body.supported.size(); ++k)
        motion.segment<3>(3 * body.supported[k]) =
            (next - done) * body.support_moves.col(static_cast<Eigen::Index>(k));
      Eigen::VectorXd load = Eigen::VectorXd::Zero(rest.size());
      for (int e = 0; e < body.mesh.elements.cols(); ++e) {
        const auto element = body.mesh.elements.col(e);
        if (std::none_of(element.begin(), element.end(),
                         [&](int n) { return system.fixed()[static_cast<std::size_t>(n)]; }))
          continue;
        const ElementMatrix tangent = system.tangent(rest, e);
        for (int a = 0; a < 10; ++a)
          for (int b = 0; b < 10; ++b)
            load.segment<3>(3 * element[a]) -=
                tangent.block<3, 3>(3 * a, 3 * b) * motion.segment<3>(3 * element[b]);
      }
      factor(*place, rest, 0, factors, nullptr);
      substitute_forward(place->tree, factors, factors, load);
      substitute_backward(place->tree, factors, factors, load);
      for (Eigen::Index n = 0; n < rest.cols(); ++n)
        positions.col(n) += system.fixed()[static_cast<std::size_t>(n)] ? motion.segment<3>(3 * n)
                                                                        : load.segment<3>(3 * n);
    }
    bool converged = false;
    SystemForces forces = system.forces(positions, nowhere, nullptr);
    // Rounding leaves forces where nothing moved.
    const double floor = modulus * options.tip_radius * options.tip_radius;
    for (int i = 0; i < options.max_iterations && forces.valid; ++i) {
      converged = forces.nodes.norm() <= kRestTolerance * std::max(forces.reaction, floor);
      if (converged) break;
      factor(*place, positions, 0, factors, nullptr);
      Eigen::VectorXd change = -forces.nodes;
      substitute_forward(place->tree, factors, factors, change);
      substitute_backward(place->tree, factors, factors, change);
      positions += Eigen::Map<const Eigen::Matrix3Xd>(change.data(), 3, rest.cols());
      forces = system.forces(positions, nowhere, nullptr);
    }
    if (converged) {
      rest = positions;
      done = next;
    } else if (step /= 2; step < least) {
      throw SolverError("the object has no equilibrium after its supports have moved by " +
                        std::to_string(100 * next) +
                        " % of their ways; move them less, or refine the mesh beside them");
    }
  }
}

ContactAttempt ContactEquilibrium::Impl::attempt(const ContactState& start, ContactGoal goal,
                                                 const Vector3d& target, const PlaceFactors& place,
                                                 bool exact, ContactResult& counts) const {
  ContactAttempt now;
  now.positions = start.positions;
  now.tip = goal == ContactGoal::position ? target : start.tip;
  const double radius = options.tip_radius;
  now.forces = system.forces(now.positions, now.tip, &start);
  if (goal == ContactGoal::force && now.forces.contacts.empty()) {
    // Nothing holds the tip yet: press it in by what Hertz would expect, so that the first system
    // has a solution.
    const double force = target.norm();
    double depth = std::clamp(std::cbrt(9 * force * force / (16 * modulus * modulus * radius)),
                              kFirstDepth * radius, radius / 4);
    const double deepest = radius;
    while (now.forces.contacts.empty() && depth < deepest) {
      now.tip = start.tip + depth * start.inward;
      now.forces = system.forces(now.positions, now.tip, &start);
      depth *= 2;
    }
  }
  const double floor = kLeastForce * modulus * radius * radius;
  NestedFactors near_factors, far;
  const NestedFactors *below = &place.rest, *near = below;
  int last_near = 0;
  StepHistory history;
  double norm = residual(now.forces, goal, target), rate = 1;
  double best = norm;
  int poor = 0, best_at = 0;
  for (int i = 0; i < options.max_iterations; ++i) {
    if (!now.forces.valid) {
      now.stop = ContactStop::elements_inverted;
      return now;
    }
    const double scale = goal == ContactGoal::force ? std::max(target.norm(), start.force.norm())
                                                    : now.forces.tip.norm();
    if (norm <= options.tolerance * std::max(scale, floor)) {
      now.stop = ContactStop::converged;
      return now;
    }
    for (const FaceContact& contact : now.forces.contacts) {
      for (const int node : faces[static_cast<std::size_t>(contact.face)].nodes)
        if (place.root_index[static_cast<std::size_t>(node)] < 0 &&
            !system.fixed()[static_cast<std::size_t>(node)])
          now.outgrown = true;
    }
    if (now.outgrown) return now;
    ++counts.iterations;

    // While many points come into contact and leave it, residuals tell little about the matrix.
    const bool steady = norm < kSteady * std::max(scale, floor);
    poor = rate > kPoorRate ? poor + 1 : 0;
    if (exact || poor >= 3) {
      factor(place, now.positions, 0, far, nullptr);
      below = &far;
      near = below;
      last_near = i;
      poor = 0;
      ++counts.factorisations;
      history.clear();
    } else if (i > 0 && rate > kGoodRate && (i != last_near + 1 || !steady)) {
      factor(place, now.positions, place.tree.near_front(), near_factors, below);
      near = &near_factors;
      last_near = i;
    }

    // The root with the contact; the tip's three unknowns are its border.
    const auto root_nodes = static_cast<Eigen::Index>(place.problem.root.size());
    const Eigen::Index unknowns = 3 * root_nodes + (goal == ContactGoal::force ? 3 : 0);
    Eigen::MatrixXd root = Eigen::MatrixXd::Zero(unknowns, unknowns);
    root.topLeftCorner(3 * root_nodes, 3 * root_nodes) =
        near->fronts[static_cast<std::size_t>(place.tree.root_front())].update;
    for (const FaceContact& contact : now.forces.contacts) {
      const ContactFace& face = system.faces()[static_cast<std::size_t>(contact.face)];
      const auto shape = face.rule->shapes.col(contact.point);
      for (int a = 0; a < 6; ++a) {
        const int row = place.root_index[static_cast<std::size_t>(face.face.nodes[a])];
        if (row < 0) continue;
        for (int b = 0; b < 6; ++b) {
          const int column = place.root_index[static_cast<std::size_t>(face.face.nodes[b])];
          if (column >= 0)
            root.block<3, 3>(3 * row, 3 * column) -= shape[a] * shape[b] * contact.tangent;
        }
        if (goal == ContactGoal::force) {
          root.block<3, 3>(3 * row, 3 * root_nodes) += shape[a] * contact.tangent;
          root.block<3, 3>(3 * root_nodes, 3 * row) += shape[a] * contact.tangent;
        }
      }
      if (goal == ContactGoal::force) root.bottomRightCorner<3, 3>() -= contact.tangent;
    }
    Eigen::VectorXd change = -now.forces.nodes;
    substitute_forward(place.tree, *near, *below, change);
    Eigen::VectorXd right(unknowns);
    for (Eigen::Index k = 0; k < root_nodes; ++k)
      right.segment<3>(3 * k) =
          change.segment<3>(3 * place.problem.root[static_cast<std::size_t>(k)]);
    if (goal == ContactGoal::force) right.tail<3>() = target - now.forces.tip;
    const Eigen::VectorXd solved = root.partialPivLu().solve(right);
    if (!solved.allFinite()) return now;
    for (Eigen::Index k = 0; k < root_nodes; ++k)
      change.segment<3>(3 * place.problem.root[static_cast<std::size_t>(k)]) =
          solved.segment<3>(3 * k);
    substitute_backward(place.tree, *near, *below, change);
    Eigen::VectorXd whole(change.size() + 3);
    whole << change, (goal == ContactGoal::force ? Vector3d(solved.tail<3>()) : Vector3d::Zero());
    if (steady) whole = history.improved(whole);
    const Eigen::Map<const Eigen::Matrix3Xd> step(whole.data(), 3, rest.cols());
    const Vector3d tip_step = whole.tail<3>();

    // Residuals of contact jump when points come in, so that only large growth shortens a step.
    constexpr int kFreeIterations = 6;
    constexpr double kFreeGrowth = 30, kLaterGrowth = 3;
    const double growth = i < kFreeIterations ? kFreeGrowth : kLaterGrowth;
    const double longest =
        std::sqrt(std::max(step.colwise().squaredNorm().maxCoeff(), tip_step.squaredNorm()));
    double part = std::min(1.0, radius / longest);
    constexpr double kLeastPart = 1.0 / 128;
    ContactAttempt next;
    double next_norm = 0;
    bool accepted = false;
    for (; part > kLeastPart; part /= 2) {
      next.positions = now.positions + part * step;
      next.tip = now.tip + part * tip_step;
      next.forces = system.forces(next.positions, next.tip, &start);
      next_norm = residual(next.forces, goal, target);
      accepted = next.forces.valid && std::isfinite(next_norm) && next_norm <= growth * norm &&
                 (goal == ContactGoal::position || !next.forces.contacts.empty());
      if (accepted) break;
    }
    if (!accepted) {
      now.stop = !next.forces.valid             ? ContactStop::elements_inverted
                 : next.forces.contacts.empty() ? ContactStop::contact_lost
                                                : ContactStop::not_converged;
      return now;
    }
    if (steady) history.took(part * whole);
    rate = next_norm / norm;
    if (next_norm < best / 2) {
      best = next_norm;
      best_at = i;
    }
    if (i - best_at > kPatience) break;
    norm = next_norm;
    now = std::move(next);
  }
  if (!now.forces.contacts.empty() &&
      now.forces.slipping == static_cast<int>(now.forces.contacts.size()))
    now.stop = ContactStop::tip_slides;
  return now;
}

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
  auto place = place_factors(from, reach);
  double done = 0;
  const double whole = 1.0 / options.load_steps;
  double step = whole;
  const double least = std::ldexp(whole, -options.max_halvings);
  bool exact = options.exact_tangent;
  constexpr double kRounding = 1e-12;  // of the way
  while (done < 1 - kRounding) {
    const double next = std::min(1.0, done + step);
    const Vector3d goal_now = next >= 1 ? target : Vector3d(begin + next * (target - begin));
    ContactAttempt attempted = attempt(result.state, goal, goal_now, *place, exact, result);
    if (attempted.outgrown) {
      if (static_cast<Eigen::Index>(place->problem.root.size()) == rest.cols()) return result;
      reach *= kPatchGrowth;
      place = place_factors(from, reach);
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
  constexpr double kDetour = 1;  // [tip radii] by which the tip may stop early
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
