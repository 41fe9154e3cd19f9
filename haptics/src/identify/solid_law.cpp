// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/solid_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "identify/pair_selection.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/probing/probed_solid.h"

namespace palpate::haptics {
namespace {

using probing::ContactResult;
using probing::ContactSeries;
using probing::ContactState;
using probing::ContactStop;
using probing::ProbedSolid;

constexpr double kDifference = 1e-3;  // of a parameter, by which its derivative is taken
// Equilibria and their derivatives are known to about a thousandth: a search never rests more
// exactly.
constexpr double kRestingChange = 5e-3, kRestingError = 0.1;
constexpr double kMostFactor = 1e4;  // of shear moduli and moves over those given

double bulk_ratio(const probing::Hyperelastic& material) {
  return material.bulk_modulus / material.shear_modulus;
}

ContactState touched(const ProbedSolid& solid, const probing::Contact& contact) {
  return solid.equilibrium().touch(solid.place(contact.position).position,
                                   -contact.normal.normalized());
}

// The solids that differ by a step of one parameter.
struct ChangedSolids {
  std::unique_ptr<ProbedSolid> less, more;
};

// Calls `found(pair, series, state, changes)` for each pair that has an equilibrium.
template <typename Found>
void each_equilibrium(const ProbedSolid& solid, const std::vector<ChangedSolids>& changed,
                      std::span<const probing::Contact> contacts, std::span<const Pair> pairs,
                      const EquilibriumDone& done, const Found& found) {
  const std::vector<ContactPairs> groups = by_contact(pairs);
  parallel_for(groups.size(), [&](std::size_t g) {
    const probing::Contact& contact = contacts[groups[g].contact];
    std::optional<ContactSeries> series;
    std::vector<probing::SolidChange> changes;
    try {
      series.emplace(solid.equilibrium(), touched(solid, contact));
      for (const ChangedSolids& each : changed)
        changes.push_back({&each.less->equilibrium(), &each.more->equilibrium(),
                           touched(*each.less, contact), touched(*each.more, contact),
                           2 * kDifference});
    } catch (const InvalidInput&) {  // the tip cannot reach the contact on such a solid
      return;
    }
    // The smaller forces first: each equilibrium is sought from those before.
    std::vector<std::size_t> order = groups[g].pairs;
    std::ranges::stable_sort(order, {},
                             [&](std::size_t i) { return pairs[i].force.squaredNorm(); });
    for (const std::size_t i : order) {
      try {
        const ContactResult result = series->apply_force(pairs[i].force);
        if (result.stop == ContactStop::converged) found(i, *series, result.state, changes);
      } catch (const SolverError&) {  // there is none, or it is not stable
      }
      done();
    }
  });
}

Predictions predict_solid(const probing::FiniteElementObject& object,
                          std::span<const probing::Contact> contacts,
                          const Eigen::VectorXd& parameters, std::span<const Pair> pairs,
                          const EquilibriumDone& done) {
  const auto changed_by = [&](Eigen::Index k, double change) {
    Eigen::VectorXd changed = parameters;
    changed[k] += change;
    return std::make_unique<ProbedSolid>(with_parameters(object.body, changed), object.options);
  };
  const ProbedSolid solid(with_parameters(object.body, parameters), object.options);
  std::vector<ChangedSolids> changed;
  for (Eigen::Index k = 0; k < parameters.size(); ++k)
    changed.push_back({changed_by(k, -kDifference), changed_by(k, kDifference)});
  Predictions result(pairs.size());
  std::atomic<std::size_t> answered = 0;
  each_equilibrium(
      solid, changed, contacts, pairs, done,
      [&](std::size_t i, ContactSeries& series, const ContactState& state,
          const std::vector<probing::SolidChange>& changes) {
        const probing::TipSensitivity sensitivity = series.sensitivity(state, changes);
        result[i] = {state.tip - series.from().tip, sensitivity.compliance, sensitivity.by_changes};
        ++answered;
      });
  if (answered < pairs.size()) result.clear();
  return result;
}

}  // namespace

bool has_moves(const probing::DeformableBody& body) { return body.support_moves.size() != 0; }

Eigen::Index solid_parameters(const probing::DeformableBody& body) {
  return std::ssize(body.materials) + (has_moves(body) ? 2 : 1);
}

probing::DeformableBody with_parameters(probing::DeformableBody body,
                                        const Eigen::VectorXd& parameters) {
  const auto regions = std::ssize(body.materials);
  for (std::size_t r = 0; r < body.materials.size(); ++r) {
    probing::Hyperelastic& material = body.materials[r];
    const double ratio = std::clamp(bulk_ratio(material) * std::exp(parameters[regions]),
                                    probing::kLeastBulkRatio, probing::kMostBulkRatio);
    material.shear_modulus *= std::exp(parameters[static_cast<Eigen::Index>(r)]);
    material.bulk_modulus = ratio * material.shear_modulus;
  }
  if (has_moves(body)) body.support_moves *= parameters[regions + 1];
  return body;
}

ParametricLaw solid_law(const probing::FiniteElementObject& object,
                        std::span<const probing::Contact> contacts, EquilibriumDone done) {
  const std::vector<probing::Hyperelastic>& materials = object.body.materials;
  const Eigen::Index count = solid_parameters(object.body);
  if (count >= kMaxParameters) {
    throw InvalidInput(fmt::format(
        "identify_solid(): the solid has {} regions; moduli of at most {} regions can be estimated",
        materials.size(), kMaxParameters - 1 - (count - std::ssize(materials))));
  }
  ParametricLaw law;
  for (std::size_t r = 0; r < materials.size(); ++r) {
    law.names.push_back(materials.size() == 1 ? std::string("shear modulus")
                                              : fmt::format("shear modulus of region {}", r));
    law.units.emplace_back("N/mm^2");
  }
  law.names.emplace_back("bulk over shear modulus");
  law.units.emplace_back();
  law.scale.setOnes(count);
  law.lower.setConstant(count, -std::log(kMostFactor));
  law.upper.setConstant(count, std::log(kMostFactor));
  const auto regions = std::ssize(materials);
  // Derivatives are taken within the range that a material may have.
  const auto [least, most] = std::ranges::minmax(materials, {}, bulk_ratio);
  law.lower[regions] = std::log(probing::kLeastBulkRatio / bulk_ratio(least)) + kDifference;
  law.upper[regions] = std::log(probing::kMostBulkRatio / bulk_ratio(most)) - kDifference;
  law.starts = {Eigen::VectorXd::Zero(count)};
  law.inexact = true;
  law.resting_change = kRestingChange;
  law.resting_error = kRestingError;
  if (has_moves(object.body)) {
    law.names.emplace_back("pre-stretch");
    law.units.emplace_back();
    law.lower[regions + 1] = -kMostFactor;
    law.upper[regions + 1] = kMostFactor;
    law.starts[0][regions + 1] = 1;
  }
  law.predict = [&object, contacts, done = std::move(done)](const Eigen::VectorXd& parameters,
                                                            std::span<const Pair> pairs,
                                                            const Predictions& /*last*/) {
    try {
      return predict_solid(object, contacts, parameters, pairs, done);
    } catch (const SolverError&) {  // no equilibrium after supports have moved
      return Predictions{};
    } catch (const InvalidInput&) {  // supports have moved the surface out of sight
      return Predictions{};
    }
  };
  return law;
}

std::vector<std::optional<Eigen::Vector3d>> solid_displacements(
    const probing::FiniteElementObject& object, std::span<const probing::Contact> contacts,
    std::span<const Pair> pairs, const EquilibriumDone& done) {
  std::vector<std::optional<Eigen::Vector3d>> result(pairs.size());
  const ProbedSolid solid(object.body, object.options);
  each_equilibrium(
      solid, {}, contacts, pairs, done,
      [&](std::size_t i, const ContactSeries& series, const ContactState& state,
          const std::vector<probing::SolidChange>&) { result[i] = state.tip - series.from().tip; });
  return result;
}

}  // namespace palpate::haptics
