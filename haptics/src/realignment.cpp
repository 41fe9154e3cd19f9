// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/realignment.h"

#include <map>
#include <vector>

namespace palpate::haptics {
namespace {

using Group = std::vector<const probing::Sample*>;

std::map<long long, Group> group_samples(long long contact,
                                         std::span<const probing::Sample> samples) {
  std::map<long long, Group> groups;
  for (const probing::Sample& sample : samples) {
    if (sample.contact == contact) groups[sample.group].push_back(&sample);
  }
  return groups;
}

Eigen::Index count_pairs(const std::map<long long, Group>& groups) {
  Eigen::Index pairs = 0;
  for (const auto& [id, group] : groups) {
    ++pairs;
    for (const probing::Sample* sample : group) pairs += sample->slipped ? 0 : 1;
  }
  return pairs;
}

}  // namespace

ForceSamples realign(const probing::Contact& contact, std::span<const probing::Sample> samples) {
  const std::map<long long, Group> groups = group_samples(contact.id, samples);
  const Eigen::Vector3d normal = contact.normal.normalized();
  ForceSamples result;
  result.displacements.resize(3, count_pairs(groups));
  result.forces.resize(3, result.displacements.cols());
  Eigen::Index pair = 0;
  for (const auto& [id, group] : groups) {
    Eigen::Vector3d mean_a = Eigen::Vector3d::Zero();
    double mean_normal_force = 0;
    for (const probing::Sample* sample : group) {
      mean_a += sample->a / static_cast<double>(group.size());
      mean_normal_force += sample->force.dot(normal) / static_cast<double>(group.size());
    }
    result.displacements.col(pair) = mean_a - contact.position;
    result.forces.col(pair++) = mean_normal_force * normal;
    for (const probing::Sample* sample : group) {
      if (sample->slipped) continue;
      result.displacements.col(pair) = sample->b - sample->a + mean_a - contact.position;
      result.forces.col(pair++) = sample->force;
    }
  }
  return result;
}

}  // namespace palpate::haptics
