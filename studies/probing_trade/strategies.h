// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

#include "objects.h"
#include "palpate/probing/acquisition.h"

namespace palpate::bench {

/// The measurements of a strategy with the quasi-static arm.
struct Measured {
  probing::Acquisition acquisition;
  int samples = 0, slipped = 0;
  double hours = 0;
  double stated = std::numeric_limits<double>::quiet_NaN();  ///< [N] the error that it states
};

/// The programme of the thesis: five levels, eight directions, bisection to 0.4 N.
[[nodiscard]] Measured measure_thesis(const PreparedObject& object, unsigned seed);

/// Five geometric levels with four drags each, at 0.9 of friction cones that are known for nothing.
[[nodiscard]] Measured measure_static(const PreparedObject& object, unsigned seed);

/// The same levels and directions where the cones must be found: the strategy `pooled`.
[[nodiscard]] Measured measure_searching(const PreparedObject& object, unsigned seed);

/// `adaptive` until either limit; 0: none.
struct AdaptiveLimits {
  int samples = 0;
  double hours = 0;
};
[[nodiscard]] Measured measure_adaptive(const PreparedObject& object, unsigned seed,
                                        const AdaptiveLimits& limits);

/// Chosen forces of the plan's contacts, one trial each.
struct ChosenForce {
  std::size_t contact = 0;                          ///< index in the plan
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  int level = 0;  ///< the same for forces of a contact with the same part along its normal
};
[[nodiscard]] Measured measure_chosen(const PreparedObject& object, unsigned seed,
                                      const std::vector<ChosenForce>& chosen);

}  // namespace palpate::bench
