// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/identify_solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "identify/held_forces.h"
#include "identify/mesh_study.h"
#include "identify/pair_selection.h"
#include "identify/parameter_estimation.h"
#include "identify/solid_law.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/core/work_steps.h"
#include "palpate/probing/probed_solid.h"

namespace palpate::haptics {
namespace {

constexpr double kSameRadius = 0.01;  // of the radius, by which two statements of it may differ
constexpr double kSamePlace = 0.2;    // [tip radii] across the normal, of a contact on the surface
constexpr double kNearStart = 0.2;    // of a displacement, at which the search begins
constexpr int kMostScalings = 20;
constexpr double kLargestScaling = 4;     // factor of moduli at once
constexpr double kEdge = 1.05;            // factor above a modulus without equilibria
constexpr std::size_t kScalingPairs = 8;  // that choose the common factor
constexpr double kMostUnanswered = 0.1;   // of the pairs may have no equilibrium at the start
constexpr int kMostRounds = 15;           // in which all pairs are predicted, for the progress

// The contacts that the tip can reach, and the ids of the others.
struct ReachedContacts {
  std::vector<bool> reached;
  std::vector<long long> left_out;
};

void check_radius(const probing::CheckedAcquisition& acquisition, double radius) {
  const std::optional<double> stated = acquisition.records().probe_radius;
  if (!stated || std::abs(*stated - radius) <= kSameRadius * radius) return;
  throw InvalidInput(fmt::format(
      "identify_solid(): the solid is touched by a ball with a tip_radius of {:.6g} mm, but the "
      "measurements were made with one of {:.6g} mm; correct one of them",
      radius, *stated));
}

ReachedContacts reached_contacts(const probing::CheckedAcquisition& acquisition,
                                 const probing::FiniteElementObject& object) {
  const double radius = object.options.contact.tip_radius;
  const probing::ProbedSolid solid(object.body, object.options);
  ReachedContacts result;
  for (const probing::Contact& contact : acquisition.contacts()) {
    const probing::ProbedPlace place = solid.place(contact.position);
    const Eigen::Vector3d way = place.position - contact.position;
    const Eigen::Vector3d inward = -contact.normal.normalized();
    const double across = (way - way.dot(inward) * inward).norm();
    if (way.norm() > radius || across > kSamePlace * radius) {
      throw InvalidInput(fmt::format(
          "identify_solid(): contact {} is {:.4g} mm from the probed surface of the solid ({:.4g} "
          "mm across the contact's normal). Check that the specimen file describes the measured "
          "object, in mm and in the frame of the measurements. Faces that a support holds, or that "
          "a camera at the origin sees at more than 70 degrees, are not probed",
          contact.id, way.norm(), across));
    }
    bool reached = true;
    try {
      (void)solid.equilibrium().touch(place.position, inward);
    } catch (const InvalidInput&) {  // the tip touches elsewhere, or cannot come there
      reached = false;
      result.left_out.push_back(contact.id);
    }
    result.reached.push_back(reached);
  }
  return result;
}

std::vector<Pair> scaled(std::vector<Pair> pairs, double factor) {
  for (Pair& pair : pairs) pair.force *= factor;
  return pairs;
}

// The common factor of all moduli at which displacements are about as large as measured. Forces
// over moduli alone determine displacements, so that one solid serves all factors.
double common_factor(const probing::FiniteElementObject& object,
                     std::span<const probing::Contact> contacts, const std::vector<Pair>& pairs,
                     const EquilibriumDone& done) {
  double factor = 1, too_soft = 0;  // at most `too_soft` there are no equilibria
  for (int k = 0; k < kMostScalings; ++k) {
    const auto found = solid_displacements(object, contacts, scaled(pairs, 1 / factor), done);
    std::vector<double> ratios;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (found[i]) ratios.push_back(found[i]->norm() / pairs[i].displacement.norm());
    if (ratios.size() < pairs.size()) {
      too_soft = std::max(too_soft, factor);
      factor *= kLargestScaling;
      continue;
    }
    const double ratio = median(ratios);
    const double next = std::max(factor * std::clamp(ratio, 1 / kLargestScaling, kLargestScaling),
                                 kEdge * too_soft);
    // At the edge of what has equilibria, the pairs with larger displacements decide.
    if (std::abs(next / factor - 1) < kNearStart) return factor;
    factor = next;
  }
  throw SolverError(fmt::format(
      "identify_solid(): no common factor of the moduli gives the measured displacements (last "
      "tried: {:.3g}); check the supports, the size and the units of the solid, and the forces",
      factor));
}

// The pairs that have an equilibrium.
std::vector<Pair> answered_pairs(const probing::FiniteElementObject& object,
                                 std::span<const probing::Contact> contacts,
                                 const std::vector<Pair>& pairs, const EquilibriumDone& done) {
  const auto found = solid_displacements(object, contacts, pairs, done);
  std::vector<bool> answered;
  for (const auto& displacement : found) answered.push_back(displacement.has_value());
  std::vector<Pair> result = marked_pairs(pairs, answered);
  const auto missing = pairs.size() - result.size();
  if (static_cast<double>(missing) <= kMostUnanswered * static_cast<double>(pairs.size()))
    return result;
  const Pair& first =
      pairs[static_cast<std::size_t>(std::ranges::find(answered, false) - answered.begin())];
  throw SolverError(fmt::format(
      "identify_solid(): the solid has no equilibrium under {} of {} forces, with moduli that fit "
      "the largest ones. The first is ({:.4g}, {:.4g}, {:.4g}) N at contact {}. Check these "
      "forces, or use a finer mesh",
      missing, pairs.size(), first.force.x(), first.force.y(), first.force.z(),
      contacts[first.contact].id));
}

ParameterEstimate pooled_friction(const std::vector<FrictionFit>& cones) {
  ParameterEstimate result{.name = "friction", .unit = "", .value = {}, .standard_error = {}};
  double weights = 0, sum = 0, squares = 0, count = 0;
  for (const FrictionFit& cone : cones) {
    if (cone.stop != FrictionStop::converged || !(cone.coefficient_error > 0)) continue;
    const double weight = 1 / (cone.coefficient_error * cone.coefficient_error);
    weights += weight;
    sum += weight * cone.coefficient;
    squares += weight * cone.coefficient * cone.coefficient;
    ++count;
  }
  if (count == 0) return result;
  const double mean = sum / weights;
  const double scatter = count > 1 ? (squares - sum * mean) / (count - 1) : 1;
  result.status = ParameterStatus::determined;
  result.value = mean;
  result.standard_error = std::sqrt(std::max(scatter, 1.0) / weights);
  return result;
}

std::vector<probing::KnownPress> normal_presses(const std::vector<Pair>& pairs,
                                                const std::vector<std::size_t>& among,
                                                std::span<const probing::Contact> contacts) {
  std::vector<probing::KnownPress> result;
  for (const std::size_t i : among) {
    if (pairs[i].settled != i) continue;
    const probing::Contact& contact = contacts[pairs[i].contact];
    result.push_back({contact.id, contact.position, -contact.normal.normalized(),
                      pairs[i].displacement, pairs[i].force});
  }
  std::ranges::stable_sort(result, std::greater{},
                           [](const probing::KnownPress& press) { return press.force.norm(); });
  return result;
}

bool is_determined(const ParameterEstimate& parameter) {
  return parameter.status == ParameterStatus::determined;
}

// The estimate. Parameters that the data do not determine stay at the start, and what is determined
// is estimated once more beside them; standard errors still allow for a change of them.
LawEstimate estimate_determined(ParametricLaw law, const std::vector<Pair>& pairs,
                                std::span<const probing::Contact> contacts,
                                const IdentifyOptions& options) {
  LawEstimate all = estimate(law, pairs, contacts, options);
  const Eigen::VectorXd start = law.starts[0];
  law.starts[0] = all.parameters;
  bool fixed = false;
  for (Eigen::Index k = 0; k < start.size(); ++k) {
    if (all.report.parameters[static_cast<std::size_t>(k)].status != ParameterStatus::undetermined)
      continue;
    law.lower[k] = law.upper[k] = law.starts[0][k] = start[k];
    fixed = true;
  }
  if (!fixed || all.report.verdict == Verdict::not_converged) return all;
  LawEstimate found = estimate(law, pairs, contacts, options);
  for (std::size_t k = 0; k < all.report.parameters.size(); ++k) {
    ParameterEstimate& parameter = all.report.parameters[k];
    if (parameter.value) parameter.value = found.parameters[static_cast<Eigen::Index>(k)];
  }
  found.report.parameters = std::move(all.report.parameters);
  found.report.correlations = std::move(all.report.correlations);
  return found;
}

// Adds the error of the mesh to standard errors. Returns the names of parameters that are no longer
// determined.
std::vector<std::string> add_mesh_errors(const Eigen::VectorXd& shift, Identification& report) {
  std::vector<std::string> result;
  for (Eigen::Index k = 0; k < shift.size(); ++k) {
    ParameterEstimate& parameter = report.parameters[static_cast<std::size_t>(k)];
    if (!parameter.standard_error) continue;
    const double error = std::hypot(*parameter.standard_error, shift[k]);
    if (error < kUndetermined) {
      parameter.standard_error = error;
      continue;
    }
    result.push_back(parameter.name);
    parameter.status = ParameterStatus::undetermined;
    parameter.value.reset();
    parameter.standard_error.reset();
    report.correlations.row(k).setConstant(std::numeric_limits<double>::quiet_NaN());
    report.correlations.col(k).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return result;
}

// Turns parameters of the law, corrected for the mesh, into moduli.
void state_values(const probing::DeformableBody& given, const Eigen::VectorXd& shift,
                  const Eigen::VectorXd& parameters, bool mesh_known, IdentifiedSolid& result) {
  const auto regions = std::ssize(given.materials);
  for (Eigen::Index k = 0; k < shift.size(); ++k) {
    ParameterEstimate& parameter = result.report.parameters[static_cast<std::size_t>(k)];
    result.mesh_errors.push_back(std::numeric_limits<double>::quiet_NaN());
    if (!parameter.value) continue;
    const double corrected = parameters[k] - shift[k];
    const probing::Hyperelastic& material =
        given.materials[static_cast<std::size_t>(k < regions ? k : 0)];
    const double unit =
        k < regions ? material.shear_modulus : material.bulk_modulus / material.shear_modulus;
    // The pre-stretch is the factor itself.
    parameter.value = k <= regions ? unit * std::exp(corrected) : corrected;
    const double by_law = k <= regions ? *parameter.value : 1;
    if (parameter.standard_error) *parameter.standard_error *= by_law;
    if (mesh_known) result.mesh_errors.back() = by_law * shift[k];
  }
}

}  // namespace

void visit(SolidOptions& options, FieldVisitor& visitor) {
  visitor.begin("SolidOptions");
  constexpr int kMost = 1'000'000;
  visitor.whole({"max_pairs",
                 "Of a solid: pairs of displacement and force that the estimate uses, spread over "
                 "contacts and forces. More are more exact and take longer"},
                options.max_pairs, at_least(1).at_most(kMost));
  visitor.whole({"mesh_pairs",
                 "Of a solid: pairs that are repeated on a mesh of half the size, to find the "
                 "error of the mesh; 0: none, and the mesh counts as exact"},
                options.mesh_pairs, at_least(0).at_most(kMost));
}

IdentifiedSolid identify_solid(const probing::CheckedAcquisition& acquisition,
                               const probing::FiniteElementObject& given, const SolidOptions& solid,
                               const IdentifyOptions& options) {
  check_identify_options(options);
  SolidOptions checked = solid;
  require_in_range(fields_of(checked));
  check_radius(acquisition, given.options.contact.tip_radius);
  const std::vector<FrictionFit> cones = friction_cones(acquisition, options);
  const ParameterEstimate friction = pooled_friction(cones);
  probing::FiniteElementObject object = given;
  if (friction.value) object.options.friction = *friction.value;
  const std::vector<probing::Contact>& contacts = acquisition.contacts();
  std::mutex mutex;
  std::optional<WorkSteps> steps;
  const EquilibriumDone done = [&] {
    const std::scoped_lock lock(mutex);
    steps->tell();
  };
  ParametricLaw law = solid_law(object, contacts, done);

  IdentifiedSolid result;
  const ReachedContacts reached = reached_contacts(acquisition, object);
  result.left_out = reached.left_out;
  std::vector<Pair> pairs = realigned_pairs(acquisition);
  expect_held(cones, pairs);
  pairs = spread_pairs(pairs, contacts, reached.reached, static_cast<std::size_t>(solid.max_pairs));
  if (pairs.empty()) {
    throw InvalidInput(
        "identify_solid(): no sample presses at a contact that the tip can reach on this solid");
  }
  steps.emplace(solid.progress, kMostRounds * static_cast<int>(pairs.size()));
  const std::vector<std::size_t> large = largest_pairs(pairs, contacts, kScalingPairs);
  result.presses = normal_presses(pairs, large, contacts);
  const double factor = common_factor(object, contacts, chosen_pairs(pairs, large), done);
  law.starts[0].head(std::ssize(object.body.materials)).setConstant(std::log(factor));
  const auto at = [&](const Eigen::VectorXd& parameters) {
    return probing::FiniteElementObject{with_parameters(object.body, parameters), object.options};
  };
  const std::size_t wanted = pairs.size();
  pairs = answered_pairs(at(law.starts[0]), contacts, pairs, done);
  result.unanswered = static_cast<int>(wanted - pairs.size());

  const auto mesh_pairs = static_cast<std::size_t>(solid.mesh_pairs);
  const double scatter =
      mesh_scatter(study_mesh(at(law.starts[0]), contacts, pairs, mesh_pairs, done), pairs);
  // Also of a drag, the whole displacement counts: its part of the error is as large.
  for (Pair& pair : pairs) pair.law_error = scatter * pair.displacement.norm();
  LawEstimate found = estimate_determined(law, pairs, contacts, options);

  // Moduli may differ by now from those of the first study.
  const MeshStudy study = study_mesh(at(found.parameters), contacts, pairs, mesh_pairs, done);
  std::vector<bool> free;
  for (Eigen::Index k = 0; k < law.scale.size(); ++k)
    free.push_back(is_determined(found.report.parameters[static_cast<std::size_t>(k)]));
  const Eigen::VectorXd shift =
      mesh_shift(study, pairs, found, free, std::ssize(object.body.materials));
  steps->end();
  result.mesh_limited = add_mesh_errors(shift, found.report);
  result.report = std::move(found.report);
  state_values(object.body, shift, found.parameters, !study.pairs.empty(), result);
  result.object = at(found.parameters - shift);
  result.report.parameters.push_back(friction);
  return result;
}

}  // namespace palpate::haptics
