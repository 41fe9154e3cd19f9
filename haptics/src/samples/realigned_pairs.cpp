// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/realigned_pairs.h"

#include <algorithm>
#include <map>
#include <span>

#include "palpate/core/quantile.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {
namespace {

/// Number and scatter of the positions of a group that stand for its normal force.
struct Scatter {
  int repeats = 0;
  double variance = 0;  ///< [mm^2]
};

Scatter scatter_of(const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& mean) {
  std::vector<double> distances;
  distances.reserve(positions.size());
  for (const Eigen::Vector3d& a : positions) distances.push_back((a - mean).norm());
  const double farthest = kOutlierRatio * median(distances);
  Scatter scatter;
  for (const double distance : distances) {
    if (distance > farthest) continue;
    ++scatter.repeats;
    scatter.variance += distance * distance;
  }
  scatter.variance = scatter.repeats > 1 ? scatter.variance / (scatter.repeats - 1) : 0;
  return scatter;
}

}  // namespace

std::vector<Pair> realigned_pairs(const probing::CheckedAcquisition& acquisition) {
  std::vector<Pair> pairs;
  for (std::size_t c = 0; c < acquisition.contacts().size(); ++c) {
    const probing::Contact& contact = acquisition.contacts()[c];
    const std::span<const probing::Sample> samples = acquisition.samples_of(c);
    std::map<long long, std::vector<Eigen::Vector3d>> settled_positions;
    std::map<long long, Eigen::Index> held;
    for (const probing::Sample& sample : samples) {
      settled_positions[sample.group].push_back(sample.a);
      held[sample.group] += sample.slipped || !has_tangential_stage(sample) ? 0 : 1;
    }
    const ForceSamples realigned = realign(contact, samples);
    Eigen::Index column = 0;
    for (const auto& [group, positions] : settled_positions) {
      const std::size_t settled = pairs.size();
      const Scatter scatter =
          scatter_of(positions, contact.position + realigned.displacements.col(column));
      for (Eigen::Index i = 0; i <= held[group]; ++i, ++column) {
        pairs.push_back({.contact = c,
                         .settled = settled,
                         .repeats = std::max(scatter.repeats, 1),
                         .scatter = scatter.variance,
                         .displacement = realigned.displacements.col(column),
                         .force = realigned.forces.col(column)});
      }
    }
  }
  return pairs;
}

}  // namespace palpate::haptics
