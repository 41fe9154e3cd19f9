// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "felt_loop.h"
#include "palpate/haptics/blended_field.h"

namespace palpate::view {

/// The values of a tick that the window shows.
struct ForceReading {
  double total = 0;                                    ///< [N] of the model
  double normal = 0;                                   ///< [N] along the axis of the friction cone
  double tangential = 0;                               ///< [N] across it
  double friction = 0;                                 ///< coefficient
  std::optional<double> deviation = {};                ///< [N] that the model states
  Eigen::Vector3d inwards = Eigen::Vector3d::UnitZ();  ///< unit: axis of the friction cone
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm] of the contact
  geometry::SurfacePoint at;                               ///< the contact
  geometry::ContactWeights weights;                        ///< of the fields that blend there
};

/// Zero except for the state's own numbers while the tool is free.
[[nodiscard]] ForceReading read_force(const haptics::BlendedField& field, const FeltTick& tick);

/// The result of trial presses of an object.
struct PressTrial {
  /// [mm] up to which the force grows at three of four contacts that are tried: if it falls, the
  /// model is far from the measurements.
  double depth = 0;
  double force = 0;  ///< [N] that one of four does not exceed there, a round number
};
/// Tries up to 24 contacts. \param deepest [mm] > 0
[[nodiscard]] PressTrial try_presses(const haptics::Playback& playback, const haptics::Model& model,
                                     double deepest);

/// The next of 1, 2, 5, 10, ... that is not below a value > 0.
[[nodiscard]] double round_up(double value);

}  // namespace palpate::view
