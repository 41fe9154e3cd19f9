// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/rate_dependence.h"

#include <cmath>
#include <vector>

#include "palpate/core/quantile.h"

namespace palpate::probing {
namespace {

// The work of a force that grows evenly is half of force times motion. An error of the force in
// both directions changes the loss by twice error times motion, thus the share by 4 error / force.
constexpr double kLeastForceOverNoise = 40;
constexpr double kLeastWayOverNoise = 10;

bool stands_out(const TrialRecord& record, const ProgramOptions& options) {
  const TrialResult& result = record.result;
  return result.outcome == TrialOutcome::held && record.order.direction >= 0 &&
         record.order.tangential_force.norm() >= kLeastForceOverNoise * options.force_noise &&
         (result.b - result.a).norm() >= kLeastWayOverNoise * options.position_noise;
}

}  // namespace

RateDependence rate_dependence(std::span<const TrialRecord> trials, const ProgramOptions& options) {
  std::vector<double> lost, creep;
  for (const TrialRecord& record : trials) {
    if (!stands_out(record, options)) continue;
    const TrialResult& result = record.result;
    const double share = 1 + result.work_releasing / result.work_dragging;
    if (result.work_dragging > 0 && std::isfinite(share)) lost.push_back(share);
    if (std::isfinite(result.creep)) creep.push_back(result.creep);
  }
  RateDependence found{.loops = static_cast<int>(lost.size()),
                       .creeps = static_cast<int>(creep.size())};
  if (!lost.empty()) found.energy_lost = median(lost);
  if (!creep.empty()) found.creep = median(creep);
  return found;
}

}  // namespace palpate::probing
