// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/prober.h"

namespace palpate::probing {

/// Touches of one contact.
struct ContactTouches {
  Contact contact = {};
  /// [N] into the object, of a trial at this contact: the arm comes along it.
  Eigen::Vector3d normal_force = Eigen::Vector3d::Zero();
  std::vector<double> heights = {};  ///< [mm] of the touches above the planned place
};

/// The contacts by which to see whether an object has moved: the one that was touched most often,
/// then the farthest from those before among all that were touched at least half as often.
/// \param most contacts at most.
[[nodiscard]] std::vector<ContactTouches> reference_touches(std::span<const TrialRecord> trials,
                                                            int most);

/// Reference touches count their trials from this number on.
inline constexpr long long kFirstTouchTrial = 2'000'000'000;

/// Touches the same contacts again, each of them `times` times, without pressing. Touches that
/// found nothing are left out.
/// \throws whatever the arm throws.
[[nodiscard]] std::vector<ContactTouches> touch_again(Prober& arm,
                                                      std::span<const ContactTouches> before,
                                                      int times, const ProgramOptions& options);

/// Motion of an object along the normal of a contact.
struct ObjectShift {
  long long contact = 0;
  int touches = 0;  ///< now
  /// [mm] outwards, from the mean of the touches before to that of those now; NaN without touches
  double shift = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();  ///< [mm] its standard deviation
};

/// One for each contact. The deviation of a touch is that of all touches from the mean of their
/// contact, but not less than `ProgramOptions::position_noise`.
/// \throws InvalidInput unless `before` and `now` are of the same contacts.
[[nodiscard]] std::vector<ObjectShift> object_shift(std::span<const ContactTouches> before,
                                                    std::span<const ContactTouches> now,
                                                    const ProgramOptions& options = {});

/// Returns true if a shift is certainly larger than `limit` [mm], by four standard deviations, or
/// if nothing was touched any more.
[[nodiscard]] bool has_moved(const ObjectShift& shift, double limit);

}  // namespace palpate::probing
