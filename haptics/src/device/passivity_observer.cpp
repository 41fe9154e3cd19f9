// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/passivity_observer.h"

#include <algorithm>

namespace palpate::haptics {

void PassivityObserver::observe(const Eigen::Vector3d& device,
                                const Eigen::Vector3d& force) noexcept {
  if (!device.allFinite() || !force.allFinite()) return;
  if (any_) given_.now += force_.dot(device - device_);
  given_.largest = std::max(given_.largest, given_.now);
  const bool ends = !force_.isZero(0) && force.isZero(0);
  if (ends) {
    ++given_.touches;
    if (given_.now > 0) ++given_.giving;
    given_.in_touches += std::max(given_.now, 0.0);
    given_.now = 0;
  }
  any_ = true;
  device_ = device;
  force_ = force;
}

}  // namespace palpate::haptics
