// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/identify_solid.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <utility>

#include "identify/held_forces.h"
#include "identify/pair_selection.h"
#include "identify/parameter_estimation.h"
#include "identify/solid_law.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/core/work_steps.h"
#include "palpate/geometry/median.h"
#include "palpate/probing/probed_solid.h"

namespace palpate::haptics {
namespace {

constexpr double kSameRadius = 0.01;  // of the radius, by which two statements of it may differ
constexpr double kNearStart = 0.2;    // of a displacement, at which the search begins
constexpr int kMostScalings = 12;
constexpr double kStiffer = 4;            // factor, where the moduli given have no equilibrium
constexpr std::size_t kScalingPairs = 8;  // that choose the common factor
constexpr int kMostRounds = 15;           // in which all pairs are predicted, for the progress

// The contacts that the tip can reach, and the ids of the others.
struct ReachedContacts {
  std::vector<bool> reached;
  std::vector<long long> left_out;
};

ReachedContacts reached_contacts(const probing::CheckedAcquisition& acquisition,
                                 const probing::FiniteElementObject& object) {
  const double radius = object.options.contact.tip_radius;
  if (const auto stated = acquisition.records().probe_radius;
      stated && std::abs(*stated - radius) > kSameRadius * radius) {
    throw InvalidInput(fmt::format(
        "identify_solid(): the solid is touched by a ball with a tip_radius of {:.6g} mm, but the "
        "measurements were made with one of {:.6g} mm; correct one of them",
        radius, *stated));
  }
  const probing::ProbedSolid solid(object.body, object.options);
  ReachedContacts result;
  for (const probing::Contact& contact : acquisition.contacts()) {
    const probing::ProbedPlace place = solid.place(contact.position);
    const double distance = (place.position - contact.position).norm();
    if (distance > radius) {
      throw InvalidInput(fmt::format(
          "identify_solid(): contact {} is {:.4g} mm from the surface of the solid; the solid must "
          "be that of the measurements, in their frame and in mm",
          contact.id, distance));
    }
    bool reached = true;
    try {
      (void)solid.equilibrium().touch(place.position, -contact.normal.normalized());
    } catch (const InvalidInput&) {  // the tip touches elsewhere, or cannot come there
      reached = false;
      result.left_out.push_back(contact.id);
    }
    result.reached.push_back(reached);
  }
  return result;
}

std::vector<Pair> chosen(const std::vector<Pair>& pairs, const std::vector<std::size_t>& indices) {
  std::vector<Pair> result;
  for (const std::size_t i : indices) result.push_back(pairs[i]);
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
  double factor = 1;
  for (int k = 0; k < kMostScalings; ++k) {
    const std::vector<Eigen::Vector3d> found =
        solid_displacements(object, contacts, scaled(pairs, 1 / factor), done);
    if (found.empty()) {
      factor *= kStiffer;
      continue;
    }
    std::vector<double> ratios;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      ratios.push_back(found[i].norm() / pairs[i].displacement.norm());
    const double ratio = geometry::median(ratios);
    if (std::abs(ratio - 1) < kNearStart) return factor;
    factor *= std::clamp(ratio, 1 / kStiffer, kStiffer);
  }
  throw SolverError(fmt::format(
      "identify_solid(): no common factor of the moduli given, up to {:.3g}, gives displacements "
      "as "
      "large as those measured; are the supports, the size and the units of the solid right?",
      factor));
}

// What a mesh of half the size changes in some of the pairs.
struct MeshStudy {
  std::vector<std::size_t> pairs;           // indices
  std::vector<Eigen::Vector3d> difference;  // [mm] finer minus given
};

MeshStudy study_mesh(const probing::FiniteElementObject& object,
                     std::span<const probing::Contact> contacts, const std::vector<Pair>& pairs,
                     int count, const EquilibriumDone& done) {
  MeshStudy result;
  if (count == 0) return result;
  result.pairs = largest_pairs(pairs, contacts, static_cast<std::size_t>(count));
  const std::vector<Pair> repeated = chosen(pairs, result.pairs);
  const std::vector<Eigen::Vector3d> given = solid_displacements(object, contacts, repeated, done);
  const std::vector<Eigen::Vector3d> finer =
      solid_displacements({refined(object.body), object.options}, contacts, repeated, done);
  if (given.empty() || finer.empty()) return {};
  for (std::size_t k = 0; k < repeated.size(); ++k)
    result.difference.push_back(finer[k] - given[k]);
  return result;
}

// By how much parameters come out too large since displacements are those of the given mesh.
Eigen::VectorXd mesh_shift(const MeshStudy& study, const LawEstimate& found) {
  const Eigen::Index count = found.parameters.size();
  // In units of the scales, which are one; what the pairs do not determine stays as it is.
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(count, count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const std::size_t i = study.pairs[k];
    const Eigen::MatrixXd rows = found.weights.whiten[i] * found.predictions[i].by_parameters;
    matrix += rows.transpose() * rows;
    right += rows.transpose() * (found.weights.whiten[i] * study.difference[k]);
  }
  return matrix.llt().solve(right);
}

// Of a displacement, the deviation of each component that no common factor explains.
double mesh_scatter(const MeshStudy& study, const std::vector<Pair>& pairs) {
  double products = 0, squares = 0, sum = 0;
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const Eigen::Vector3d& whole = pairs[study.pairs[k]].displacement;
    products += study.difference[k].dot(whole) / whole.squaredNorm();
    squares += study.difference[k].squaredNorm() / whole.squaredNorm();
    sum += 1;
  }
  if (sum == 0) return 0;
  const double common = products / sum;
  return std::sqrt(std::max(squares / sum - common * common, 0.0) / 3);
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

// Turns parameters of the law into moduli, corrected for the mesh.
void state_values(const probing::DeformableBody& given, const Eigen::VectorXd& shift,
                  bool mesh_known, IdentifiedSolid& result) {
  const auto regions = std::ssize(given.materials);
  for (Eigen::Index k = 0; k < shift.size(); ++k) {
    ParameterEstimate& parameter = result.report.parameters[static_cast<std::size_t>(k)];
    double factor = 1;  // unit of the parameter over that of the law's
    if (parameter.value) {
      const double corrected = *parameter.value - shift[k];
      const probing::Hyperelastic& material =
          given.materials[static_cast<std::size_t>(k < regions ? k : 0)];
      if (k < regions) {
        parameter.value = factor = material.shear_modulus * std::exp(corrected);
      } else if (k == regions) {
        parameter.value = factor =
            material.bulk_modulus / material.shear_modulus * std::exp(corrected);
      } else {
        parameter.value = corrected;
      }
    }
    if (parameter.standard_error)
      parameter.standard_error = factor * std::hypot(*parameter.standard_error, shift[k]);
    result.mesh_errors.push_back(mesh_known && parameter.standard_error
                                     ? factor * shift[k]
                                     : std::numeric_limits<double>::quiet_NaN());
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
                 "Of a solid: pairs that are repeated on a mesh of half the size, to correct for "
                 "the error of the mesh; 0: none, and the mesh counts as exact"},
                options.mesh_pairs, at_least(0).at_most(kMost));
}

IdentifiedSolid identify_solid(const probing::CheckedAcquisition& acquisition,
                               const probing::FiniteElementObject& object,
                               const SolidOptions& solid, const IdentifyOptions& options) {
  check_identify_options(options);
  SolidOptions checked = solid;
  require_in_range(fields_of(checked));
  const ReachedContacts reached = reached_contacts(acquisition, object);
  const std::vector<FrictionFit> cones = friction_cones(acquisition, options);
  std::vector<Pair> pairs = realigned_pairs(acquisition);
  expect_held(cones, pairs);
  pairs = spread_pairs(pairs, reached.reached, static_cast<std::size_t>(solid.max_pairs));
  if (pairs.empty()) {
    throw InvalidInput(
        "identify_solid(): no sample presses at a contact that the tip can reach on this solid");
  }
  const std::vector<probing::Contact>& contacts = acquisition.contacts();
  std::mutex mutex;
  WorkSteps steps(solid.progress, kMostRounds * static_cast<int>(pairs.size()));
  const EquilibriumDone done = [&] {
    const std::scoped_lock lock(mutex);
    steps.tell();
  };
  const std::vector<std::size_t> large = largest_pairs(pairs, contacts, kScalingPairs);
  const double factor = common_factor(object, contacts, chosen(pairs, large), done);

  ParametricLaw law = solid_law(object, contacts, done);
  law.starts[0].head(std::ssize(object.body.materials)).setConstant(std::log(factor));
  const probing::FiniteElementObject start{with_parameters(object.body, law.starts[0]),
                                           object.options};
  const MeshStudy study = study_mesh(start, contacts, pairs, solid.mesh_pairs, done);
  const double scatter = mesh_scatter(study, pairs);
  for (Pair& pair : pairs) pair.law_error = scatter * pair.displacement.norm();

  LawEstimate found = estimate(law, pairs, contacts, options);
  steps.end();
  const Eigen::VectorXd shift = mesh_shift(study, found);
  IdentifiedSolid result;
  result.report = std::move(found.report);
  result.left_out = reached.left_out;
  result.presses = normal_presses(pairs, large, contacts);
  state_values(object.body, shift, !study.pairs.empty(), result);
  Eigen::VectorXd parameters = law.starts[0];
  for (Eigen::Index k = 0; k < shift.size(); ++k)
    if (result.report.parameters[static_cast<std::size_t>(k)].value)
      parameters[k] = found.parameters[k] - shift[k];
  result.object = {with_parameters(object.body, parameters), object.options};
  result.report.parameters.push_back(pooled_friction(cones));
  if (const auto friction = result.report.parameters.back().value)
    result.object.options.friction = *friction;
  return result;
}

}  // namespace palpate::haptics
