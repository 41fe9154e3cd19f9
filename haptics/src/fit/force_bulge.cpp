// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/force_bulge.h"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {
namespace {

constexpr int kStepsToPair = 16;  // at which the field is evaluated

}  // namespace

double force_bulge(const ForceField& field, const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                   const Eigen::Ref<const Eigen::Matrix3Xd>& forces) {
  const double measured = forces.colwise().squaredNorm().maxCoeff();
  double most = measured;
  for (const auto& displacement : displacements.colwise()) {
    for (int step = 1; step <= kStepsToPair; ++step) {
      const double share = static_cast<double>(step) / kStepsToPair;
      most = std::max(most, force(field, share * displacement).squaredNorm());
    }
  }
  return std::sqrt(most / measured);
}

}  // namespace palpate::haptics
