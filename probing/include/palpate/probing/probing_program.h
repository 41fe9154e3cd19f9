// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>

#include "palpate/probing/acquisition.h"
#include "palpate/probing/prober.h"
#include "palpate/probing/slip_detection.h"

namespace palpate::probing {

/// One force to try at a contact.
struct TrialOrder {
  long long trial = 0;  ///< number of the trial in its campaign, from 0
  Contact contact = {};
  int level = 0;       ///< of the normal force
  int direction = -1;  ///< of the tangential force; -1 if there is none
  Eigen::Vector3d normal_force = Eigen::Vector3d::Zero();      ///< [N] into the object
  Eigen::Vector3d tangential_force = Eigen::Vector3d::Zero();  ///< [N]
  /// Parameters for judging slip.
  double microslip = SlipOptions{}.microslip, slip_threshold = SlipOptions{}.threshold;
};

enum class TrialOutcome { held, slipped, fell_off, no_contact, unsettled, timed_out };
/// "held", "slipped", ...
[[nodiscard]] const char* to_string(TrialOutcome outcome);

/// The result of one trial. A trial that held, slipped or fell off in the drag is a sample.
struct TrialResult {
  TrialOutcome outcome = TrialOutcome::timed_out;
  /// [mm] as measured: at the touch, under the normal force (`a`), under the whole force (`b`), and
  /// again under the normal force (`a_again`). NaN if the trial did not come so far.
  Eigen::Vector3d touch = Eigen::Vector3d::Zero();
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector3d a_again = Eigen::Vector3d::Zero();
  double slip_statistic = 0;  ///< T^2 of `judge_slip`; NaN without one
  double seconds = 0;
  /// `ProbeReport::creep` of the drag; [N mm] `ProbeReport::work` of the drag and of the release.
  /// NaN if the trial did not come so far, or the arm does not measure it.
  double creep = std::numeric_limits<double>::quiet_NaN();
  double work_dragging = std::numeric_limits<double>::quiet_NaN();
  double work_releasing = std::numeric_limits<double>::quiet_NaN();
  /// `ProbeReport::reason` of the action that failed; stores keep it as an event.
  std::string reason = {};
  /// `ProbeReport::range_map` of the sample, which keeps it, and `no_range_map`, an event of
  /// stores.
  std::string range_map = {}, no_range_map = {};
};

/// The states of the program at a contact (thesis 4.3, 4.4.2).
enum class ProgramStage { travel, touch, press, drag, release, lift, finished };

struct ProgramState {
  ProgramStage stage = ProgramStage::finished;
  TrialOrder order = {};
  TrialResult result = {};
};

struct ProgramOptions {
  double clearance = 20;          ///< [mm] above the surface while travelling; > 0
  double travel_limit = 60;       ///< [s] > 0
  double touch_limit = 20;        ///< [s] > 0
  double settle_limit = 8;        ///< [s] that the tip may take to rest; > 0
  double lift_limit = 20;         ///< [s] > 0
  double position_noise = 0.022;  ///< [mm] standard deviation of a measured coordinate; > 0
  double force_noise = 0.01;      ///< [N] of a component of an applied force; > 0
};

/// A state and what the arm is to do in it; nothing if the trial is finished.
struct ProgramStep {
  ProgramState state;
  std::optional<ProbeAction> action;
};

/// Begins a trial.
[[nodiscard]] ProgramStep begin_trial(const TrialOrder& order, const ProgramOptions& options);

/// Goes on after an action was performed. A pure function. An action that took longer than its
/// limit counts as timed out, whatever the arm says of it; every trial ends with a lift.
[[nodiscard]] ProgramStep advance(const ProgramState& state, const ProbeReport& report,
                                  const ProgramOptions& options);

/// Performs one trial. \throws whatever the arm throws.
[[nodiscard]] TrialResult run_trial(Prober& arm, const TrialOrder& order,
                                    const ProgramOptions& options);

/// The trial as `judge_slip` takes it.
[[nodiscard]] SlipTrial slip_trial(const TrialOrder& order, const TrialResult& result);

/// The sample that a trial is; none if it did not come to its drag. Its group is the contact's
/// `id * 1000 + level`, its id the trial's number.
[[nodiscard]] std::optional<Sample> sample_of(const TrialOrder& order, const TrialResult& result,
                                              double time);

}  // namespace palpate::probing
