// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/solid_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <utility>

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
// Bulk moduli that `Hyperelastic` allows, over the shear modulus.
constexpr double kLeastBulk = 0.5, kMostBulk = 1e4;
// Equilibria and their derivatives are known to about a thousandth: a search never rests more
// exactly.
constexpr double kRestingChange = 5e-3, kRestingError = 0.1;
constexpr double kMostSoftening = 1e4;  // factor of shear moduli over those given

double bulk_ratio(const probing::Hyperelastic& material) {
  return material.bulk_modulus / material.shear_modulus;
}

ContactState touched(const ProbedSolid& solid, const probing::Contact& contact) {
  return solid.equilibrium().touch(solid.place(contact.position).position,
                                   -contact.normal.normalized());
}

// Pairs [begin, end) of one contact, the smaller forces first.
struct OneContact {
  std::size_t contact = 0;
  std::vector<std::size_t> pairs;
};

std::vector<OneContact> by_contacts(std::span<const Pair> pairs) {
  std::vector<OneContact> result;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (result.empty() || result.back().contact != pairs[i].contact)
      result.push_back({pairs[i].contact, {}});
    result.back().pairs.push_back(i);
  }
  for (OneContact& one : result)
    std::ranges::stable_sort(one.pairs, {},
                             [&](std::size_t i) { return pairs[i].force.squaredNorm(); });
  return result;
}

// The solids that differ by a step of one parameter.
struct ChangedSolids {
  std::unique_ptr<ProbedSolid> less, more;
};

// Calls `found(pair, series, result)` for each equilibrium. Returns whether all have one.
template <typename Found>
bool each_equilibrium(const ProbedSolid& solid, std::span<const probing::Contact> contacts,
                      std::span<const Pair> pairs, const EquilibriumDone& done,
                      const Found& found) {
  const std::vector<OneContact> groups = by_contacts(pairs);
  std::atomic<bool> refused = false;
  parallel_for(groups.size(), [&](std::size_t g) {
    try {
      ContactSeries series(solid.equilibrium(), touched(solid, contacts[groups[g].contact]));
      for (const std::size_t i : groups[g].pairs) {
        if (refused) return;
        const ContactResult result = series.apply_force(pairs[i].force);
        refused = refused || result.stop != ContactStop::converged;
        if (!refused) found(i, series, result);
        done();
      }
    } catch (const SolverError&) {
      refused = true;
    }
  });
  return !refused;
}

Predictions predict_solid(const probing::FiniteElementObject& object,
                          std::span<const probing::Contact> contacts,
                          const Eigen::VectorXd& parameters, std::span<const Pair> pairs,
                          const EquilibriumDone& done) {
  const auto changed_by = [&](Eigen::Index k, double change) {
    Eigen::VectorXd changed = parameters;
    if (k >= 0) changed[k] += change;
    return std::make_unique<ProbedSolid>(with_parameters(object.body, changed), object.options);
  };
  const std::unique_ptr<ProbedSolid> solid = changed_by(-1, 0);
  std::vector<ChangedSolids> changed;
  for (Eigen::Index k = 0; k < parameters.size(); ++k)
    changed.push_back({changed_by(k, -kDifference), changed_by(k, kDifference)});
  Predictions result(pairs.size());
  const bool all = each_equilibrium(
      *solid, contacts, pairs, done,
      [&](std::size_t i, ContactSeries& series, const ContactResult& found) {
        std::vector<probing::SolidChange> changes;
        for (const ChangedSolids& each : changed)
          changes.push_back({&each.less->equilibrium(), &each.more->equilibrium(),
                             touched(*each.less, contacts[pairs[i].contact]),
                             touched(*each.more, contacts[pairs[i].contact]), 2 * kDifference});
        const probing::TipSensitivity sensitivity = series.sensitivity(found.state, changes);
        result[i] = {found.state.tip - series.from().tip, sensitivity.compliance,
                     sensitivity.by_changes};
      });
  if (!all) result.clear();
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
    const double ratio =
        std::clamp(bulk_ratio(material) * std::exp(parameters[regions]), kLeastBulk, kMostBulk);
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
        materials.size(), kMaxParameters - 3));
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
  law.lower.setConstant(count, -std::log(kMostSoftening));
  law.upper.setConstant(count, std::log(kMostSoftening));
  const auto regions = std::ssize(materials);
  const auto [least, most] = std::ranges::minmax(materials, {}, bulk_ratio);
  law.lower[regions] = std::log(kLeastBulk / bulk_ratio(least)) + kDifference;
  law.upper[regions] = std::log(kMostBulk / bulk_ratio(most)) - kDifference;
  law.starts = {Eigen::VectorXd::Zero(count)};
  law.resting_change = kRestingChange;
  law.resting_error = kRestingError;
  if (has_moves(object.body)) {
    law.names.emplace_back("pre-stretch");
    law.units.emplace_back();
    law.lower[regions + 1] = -1;
    law.upper[regions + 1] = kMostSoftening;
    law.starts[0][regions + 1] = 1;
  }
  law.predict = [&object, contacts, done = std::move(done)](const Eigen::VectorXd& parameters,
                                                            std::span<const Pair> pairs,
                                                            const Predictions& /*last*/) {
    try {
      return predict_solid(object, contacts, parameters, pairs, done);
    } catch (const SolverError&) {  // no equilibrium after supports have moved
      return Predictions{};
    }
  };
  return law;
}

std::vector<Eigen::Vector3d> solid_displacements(const probing::FiniteElementObject& object,
                                                 std::span<const probing::Contact> contacts,
                                                 std::span<const Pair> pairs,
                                                 const EquilibriumDone& done) {
  std::vector<Eigen::Vector3d> result(pairs.size());
  const ProbedSolid solid(object.body, object.options);
  const bool all =
      each_equilibrium(solid, contacts, pairs, done,
                       [&](std::size_t i, ContactSeries& series, const ContactResult& found) {
                         result[i] = found.state.tip - series.from().tip;
                       });
  if (!all) result.clear();
  return result;
}

}  // namespace palpate::haptics
