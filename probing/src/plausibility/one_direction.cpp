// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plausibility/presses.h"

namespace palpate::probing {

std::vector<long long> probed_in_one_direction(const CheckedAcquisition& acquisition) {
  std::vector<long long> ids;
  for (const ProbedContact& probed : probed_contacts(acquisition)) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Press& press : probed.presses)
      if (!press.sample->slipped) sum += press.sample->force;
    const Eigen::Vector3d direction = sum.normalized();
    const bool one = std::ranges::all_of(probed.presses, [&](const Press& press) {
      if (press.sample->slipped) return true;
      const double along = press.sample->force.dot(direction);
      return (press.sample->force - along * direction).norm() <= kOneDirection * along;
    });
    if (one) ids.push_back(probed.contact->id);
  }
  return ids;
}

}  // namespace palpate::probing
