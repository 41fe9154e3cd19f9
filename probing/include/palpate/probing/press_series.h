// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// Options for finding presses in a recording, and for correcting its forces first.
struct SeriesOptions {
  double touch_force = 0.1;    ///< [N] the tip touches while the force is above this; > 0
  double highest_speed = 0.5;  ///< [mm/s] slower than this is quasi-static; > 0
  double speed_window = 0.1;   ///< [s] in which the speed is measured; > 0
  double sample_length = 0.2;  ///< [mm] farthest motion of the tip in one sample; > 0
  double sample_time = 0.1;    ///< [s] shortest duration of a sample; >= 0
  /// [mm] a tip that is further away than this, under the same force, has slid; > 0
  double slide_length = 1;
  bool tare = true;  ///< subtract the median force between the last release and the touch
  /// [s] without contact at the beginning; a shorter time between two presses keeps the earlier
  /// median; > 0
  double tare_time = 0.2;
  /// [s] by which forces are recorded later than positions; finite
  double force_delay = 0;
  /// [N] limit of the sensor, of each component, before any correction; > 0
  double saturation = std::numeric_limits<double>::infinity();
};

/// Positions of the tip and its forces on the object over time.
struct TipSeries {
  std::vector<double> time;          ///< [s] ascending
  Eigen::Matrix3Xd tip;              ///< [mm] 3 x N positions
  Eigen::Matrix3Xd force;            ///< [N] 3 x N forces on the object, as recorded
  std::vector<bool> saturated = {};  ///< N, or empty: the sensor was at its limit
};

/// A quasi-static piece of a press.
struct HeldPress {
  double time = 0;                                  ///< [s] mean
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< [mm] mean position
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] mean force on the object
};

/// From one touch to the next release.
struct SeriesPress {
  std::size_t begin = 0;  ///< first moment of the series in contact
  double time = 0;        ///< [s] as the force passed touch_force
  /// [mm] Place of the surface: the tip as the force passed touch_force, moved back by `depth`.
  Eigen::Vector3d touch = Eigen::Vector3d::Zero();
  double depth = 0;  ///< [mm] at touch_force, extrapolated; 0 if the press does not show it
  double depth_deviation = std::numeric_limits<double>::quiet_NaN();  ///< [mm] of `depth`
  Eigen::Vector3d tare = Eigen::Vector3d::Zero();                     ///< [N] that was subtracted
  std::vector<HeldPress> held;  ///< in the order of time; until the tip slid, if it did
  bool slid = false;            ///< the tip slid along the surface before the release
  std::optional<HeldPress> slip = std::nullopt;  ///< the last hold, with the force of the slide
};

struct SeriesPresses {
  std::vector<SeriesPress> presses;
  std::size_t saturated = 0;  ///< moments left out because the sensor was at its limit
  std::size_t unpaired = 0;   ///< moments left out because the delay leaves them without a force
  std::size_t fast = 0;       ///< moments in contact that were too fast
  std::size_t brief = 0;      ///< slow pieces that were shorter than sample_time
};

/// Finds the presses of a recording, and in each of them the pieces in which the tip was slower
/// than `highest_speed`. A press begins where the force, less its median before, exceeds
/// `touch_force`, and ends where it falls below half of it. The place where the force passed
/// `touch_force` is extrapolated to zero force by the beginning of the press. A tip that holds is
/// at one place under one force; what follows a slide is left out.
/// \throws InvalidInput if an option is outside its range, if times do not ascend or numbers are
/// not finite, or if the tip is in contact from the beginning.
[[nodiscard]] SeriesPresses find_presses(const TipSeries& series,
                                         const SeriesOptions& options = {});

}  // namespace palpate::probing
