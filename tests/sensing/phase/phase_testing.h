// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "phase/wrapped_phase.h"

/// What tests of the phase share.
namespace palpate::sensing {

/// [px] of waves along the rows, and their frequency [rad/px] and phase at row 0.
inline constexpr double kPeriod = 7.3;
inline constexpr double kCarrier = 2 * std::numbers::pi / kPeriod;
inline constexpr double kPhase = 0.4;

inline Plane variance_of(const Plane& wrapped, const Mask& mask) {
  Plane variance;
  phase_variance(wrapped, mask, variance);
  return variance;
}

inline Plane variance_of(const Plane& wrapped) {
  return variance_of(wrapped, Mask::Ones(wrapped.rows(), wrapped.cols()));
}

}  // namespace palpate::sensing
