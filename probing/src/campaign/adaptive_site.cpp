// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "campaign/adaptive_site.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "campaign/tangential_force.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

/// Tangential forces below this many standard deviations of the force are not tried.
constexpr double kLeastTangential = 2;

/// Further trials at a contact: directions in the tangent plane, and fractions of the largest
/// force.
constexpr int kFineDirections = 12;
constexpr std::array kParts = {1.0, 0.55};
constexpr int kQueriesPerContact = 20;
constexpr double kQueryLow = 0.1;     // [N] least force of a query
constexpr double kQueryInside = 0.9;  // of the friction cone

}  // namespace

int AdaptiveSetting::base_size() const {
  return kBaseLevels * std::max(plan.options.directions, 1);
}

double AdaptiveSetting::most_tangential(double normal) const {
  const double most = plan.options.max_force;
  return std::sqrt(std::max(most * most - normal * normal, 0.0));
}

double AdaptiveSetting::least_tangential() const {
  return kLeastTangential * options.program.force_noise;
}

Vector3d AdaptiveSite::pressing() const { return -contact.normal.normalized(); }

Vector3d AdaptiveSite::tangent(double angle) const {
  const Eigen::Matrix3d frame = tangent_frame(contact);
  return std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1);
}

bool AdaptiveSite::is_known() const { return base_done && !given_up && surrogate.has_value(); }

TrialOrder order_at(const AdaptiveSite& site, const AdaptiveSetting& setting, int level,
                    int direction, const Vector3d& tangential) {
  return {.contact = site.contact,
          .level = level,
          .direction = direction,
          .normal_force = setting.levels[static_cast<std::size_t>(level)] * site.pressing(),
          .tangential_force = tangential};
}

void learn(AdaptiveSite& site, const AdaptiveSetting& setting) {
  std::vector<ForcePair> pairs = site.drags;
  for (std::size_t l = 0; l < site.presses.size(); ++l) {
    if (site.presses[l] > 0) pairs.push_back(site.pressed[l]);
  }
  if (pairs.empty()) return;
  const ProgramOptions& program = setting.options.program;
  site.surrogate.emplace(pairs, SurrogateOptions{.position_noise = program.position_noise,
                                                 .force_noise = program.force_noise});
}

void place_queries(AdaptiveSite& site, const AdaptiveSetting& setting) {
  site.queries.clear();
  const Vector3d axis = site.cone.axis;
  // Define the axes by the tangent, so that the result does not depend on the frame.
  const Vector3d x = (site.tangent(0) - site.tangent(0).dot(axis) * axis).normalized();
  const Vector3d y = axis.cross(x);
  for (int i = 0; i < kQueriesPerContact; ++i) {
    const double part = (i + 0.5) / kQueriesPerContact;
    const double golden = std::fmod(i * std::numbers::phi, 1);
    const double ratio = kQueryInside * site.cone.coefficient * std::sqrt(golden);
    const double angle = 2 * std::numbers::pi * std::fmod(i * std::numbers::sqrt2, 1);
    const double size = kQueryLow + (setting.plan.options.max_force - kQueryLow) * part;
    site.queries.push_back(
        size * (axis + ratio * (std::cos(angle) * x + std::sin(angle) * y)).normalized());
  }
}

void assess(AdaptiveSite& site, const AdaptiveSetting& setting) {
  site.gain = 0;
  site.best.reset();
  if (!site.surrogate || site.given_up) return;
  if (site.queries.empty()) place_queries(site, setting);
  site.variance = site.surrogate->error_variance(site.queries);
  const LeftOutPairs pairs = site.surrogate->left_out();
  site.unexplained = pairs.found - std::max(pairs.expected, pairs.found_without_energy);
  if (site.trials >= kMostOfBase * setting.base_size()) return;
  std::vector<TrialOrder> orders;
  std::vector<Vector3d> forces;
  std::vector<double> holds;
  for (int l = 0; l < kBaseLevels; ++l) {
    const double normal = setting.levels[static_cast<std::size_t>(l)];
    for (int k = 0; k < kFineDirections; ++k) {
      const Vector3d along = site.tangent(2 * std::numbers::pi * k / kFineDirections);
      const double most = surely_held(site, setting, normal, along);
      for (std::size_t p = 0; p < kParts.size(); ++p) {
        if (kParts[p] * most < setting.least_tangential()) continue;
        const int number =
            setting.plan.options.directions + kFineDirections * static_cast<int>(p) + k;
        orders.push_back(order_at(site, setting, l, number, kParts[p] * most * along));
        forces.push_back(orders.back().normal_force + orders.back().tangential_force);
        holds.push_back(p == 0 ? 1 - kHolding : 1);
      }
    }
  }
  const std::vector<double> gains = site.surrogate->reductions(site.queries, forces);
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (holds[i] * gains[i] > site.gain) {
      site.gain = holds[i] * gains[i];
      site.best = orders[i];
    }
  }
}

}  // namespace palpate::probing
