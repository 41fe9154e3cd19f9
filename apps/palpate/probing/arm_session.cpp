// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/arm_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "palpate/core/error.h"
#include "palpate/pictures/draw_force_errors.h"
#include "palpate/pictures/draw_joint_torques.h"
#include "palpate/pictures/draw_touch.h"
#include "probing/probe_arm.h"

namespace palpate::apps {
namespace {

/// The poses at which a joint alone was moved, the first in the middle of its range.
std::optional<pictures::JointTorques> torques_of(const ArmSession& session, int joint) {
  std::vector<const probing::HeldPose*> poses;
  for (const probing::HeldPose& pose : session.poses) {
    if (pose.direction[joint] == 0) continue;
    // The first sweep is the one of Figure 4.6; others have the first joint turned aside.
    constexpr double kSamePose = 0.01;  // [rad]
    if (joint > 0 && !poses.empty() &&
        std::abs(pose.joints[0] - poses.front()->joints[0]) > kSamePose)
      break;
    poses.push_back(&pose);
  }
  if (poses.empty()) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(poses.size());
  pictures::JointTorques torques{Eigen::VectorXd(count), Eigen::VectorXd(count),
                                 Eigen::VectorXi(count), Eigen::VectorXd(count),
                                 session.gravity.friction[joint]};
  for (Eigen::Index i = 0; i < count; ++i) {
    const probing::HeldPose& pose = *poses[static_cast<std::size_t>(i)];
    torques.angles(i) = pose.joints[joint] * 180 / std::numbers::pi;
    torques.torques(i) = pose.torque[joint];
    torques.directions(i) = pose.direction[joint];
    torques.gravity(i) = probing::gravity_torque(session.gravity, pose.joints)[joint];
  }
  return torques;
}

/// Returns true if `fit` uses the measurement under this force: the normal force of each sample,
/// and the whole force of one that held. If a tip slipped, the force where it rests is not used.
bool is_of_a_sample(const probing::AppliedForce& force, const probing::TrialRecord& trial) {
  if (!force.reference.allFinite() || !probing::sample_of(trial.order, trial.result, 0))
    return false;
  return force.kind == probing::ProbeActionKind::press ||
         (force.kind == probing::ProbeActionKind::drag &&
          trial.result.outcome == probing::TrialOutcome::held);
}

/// Returns the forces applied in the samples of the first trials. A record may end before these
/// trials do: the resumed part of a campaign is not recorded.
std::vector<probing::AppliedForce> applied_forces(CampaignArm& arm,
                                                  const probing::CampaignOptions& options,
                                                  const std::vector<probing::TrialRecord>& trials) {
  constexpr std::size_t kMostTrials = 300;  // replaying this number takes seconds
  const probing::ArmProber& prober = *arm.prober();
  if (!prober.arm().description().measures_reference) return {};
  std::vector<probing::AppliedForce> forces;
  try {
    for (std::size_t i = 0; i < std::min(kMostTrials, trials.size()); ++i) {
      const std::size_t before = prober.applied_forces().size();
      static_cast<void>(probing::run_trial(arm, trials[i].order, options.program));
      for (std::size_t k = before; k < prober.applied_forces().size(); ++k) {
        const probing::AppliedForce& force = prober.applied_forces()[k];
        if (is_of_a_sample(force, trials[i])) forces.push_back(force);
      }
    }
  } catch (const probing::ArmStopped&) {
    // the end of the record
  }
  return forces;
}

/// The errors along an axis of the base, which the reference force shows.
pictures::ForceErrors errors_along(const std::vector<probing::AppliedForce>& forces, int axis) {
  const auto count = static_cast<Eigen::Index>(forces.size());
  pictures::ForceErrors errors{Eigen::VectorXd(count), Eigen::VectorXd(count),
                               Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const probing::AppliedForce& force = forces[static_cast<std::size_t>(i)];
    errors.commanded(i) = force.commanded[axis];
    errors.fully_compensated(i) = force.reference[axis] - force.commanded[axis];
    errors.gravity_only(i) = errors.fully_compensated(i) - force.internal[axis];
  }
  return errors;
}

std::string mean_and_deviation(const Eigen::VectorXd& errors) {
  const double mean = errors.mean();
  return fmt::format("{:.4f} ± {:.4f} N", mean, std::sqrt((errors.array() - mean).square().mean()));
}

void add_force_errors(ReportPage& page, const fs::path& folder,
                      const std::vector<probing::AppliedForce>& forces) {
  if (forces.empty()) return;
  std::vector<std::vector<std::string>> rows;
  for (const int axis : {0, 1, 2}) {
    const pictures::ForceErrors errors = errors_along(forces, axis);
    rows.push_back({fmt::format("{}", "XYZ"[axis]), mean_and_deviation(errors.gravity_only),
                    mean_and_deviation(errors.fully_compensated)});
  }
  pictures::draw_force_errors(folder / "force-errors.png", errors_along(forces, 0),
                              "Error of the force along X of the arm");
  page.add_picture("force-errors.png",
                   "Forces on the object at rest, as a sensor of its own measured them, less those "
                   "that were commanded (thesis, Figure 4.7): the forces of samples that 'fit' "
                   "uses, that is normal forces, and whole forces that held. With gravity "
                   "compensated alone, the internal forces that were added would have been "
                   "missing.");
  page.add_paragraph(fmt::format(
      "Errors of {} forces of samples along the axes of the arm (thesis, Table 4.1): mean "
      "and standard deviation.",
      forces.size()));
  page.add_table({"axis", "gravity compensated", "internal forces too"}, rows);
}

}  // namespace

ArmSession read_session(const fs::path& record, const probing::Campaign& campaign,
                        const probing::CampaignOptions& options,
                        const std::vector<probing::TrialRecord>& trials, long long contact) {
  const std::string source = record.string();
  const auto trial = std::find_if(trials.begin(), trials.end(), [&](const auto& t) {
    return t.order.contact.id == contact && t.result.touch.allFinite();
  });
  if (trial == trials.end()) {
    throw InvalidInput(fmt::format(
        "{}: no trial of the campaign touched contact {}, which the model has", source, contact));
  }
  ArmCall replay;
  replay.replay = record;
  const std::string description = describe_arm(replay);
  const std::unique_ptr<CampaignArm> arm =
      make_campaign_arm(description, source, campaign.plan(), {}, {});
  try {
    arm->start();
    const probing::TrialResult again = probing::run_trial(*arm, trial->order, options.program);
    if (again.touch != trial->result.touch) {
      throw InvalidInput(fmt::format(
          "{}: trial {} touched elsewhere than in the store; the record is of another campaign",
          source, trial->order.trial));
    }
  } catch (const probing::ArmStopped& stopped) {
    throw InvalidInput(
        fmt::format("{}: is not the record of this campaign: {}", source, stopped.what()));
  }
  const probing::ArmProber& prober = *arm->prober();
  return {.poses = prober.held_poses(),
          .gravity = prober.gravity().value(),
          .touched = trial->order,
          .touch = prober.approach().value(),
          .forces = applied_forces(*arm, options, trials)};
}

void add_arm(ReportPage& page, const fs::path& folder, const ArmSession& session) {
  page.add_heading("Arm");
  const auto count = static_cast<Eigen::Index>(session.touch.samples.size());
  pictures::Touch touch{Eigen::VectorXd(count), Eigen::VectorXd(count), session.touch.found.time};
  for (Eigen::Index i = 0; i < count; ++i) {
    const probing::ApproachSample& sample = session.touch.samples[static_cast<std::size_t>(i)];
    touch.times(i) = sample.time;
    touch.positions(i) = sample.position - session.touch.found.position;
  }
  const std::string title = fmt::format("Touch of contact {} in trial {}",
                                        session.touched.contact.id, session.touched.trial);
  pictures::draw_touch(folder / "touch.png", touch, title);
  page.add_picture("touch.png",
                   title +
                       ": the object is found where a spring must begin to act so that the "
                       "motion is explained best (thesis, Figure 4.3).");
  for (const int joint : {0, 1, 2}) {
    const std::optional<pictures::JointTorques> torques = torques_of(session, joint);
    if (!torques) continue;
    const std::string file = fmt::format("gravity-{}.png", joint);
    const std::string name = fmt::format("Torque that holds joint {}", joint);
    pictures::draw_joint_torques(folder / file, *torques, name);
    page.add_picture(file, name +
                               " at rest, after upward and after downward motion, and the "
                               "gravity that was fitted (thesis, Figure 4.6).");
  }
  add_force_errors(page, folder, session.forces);
}

}  // namespace palpate::apps
