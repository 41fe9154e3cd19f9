// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/arm_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "commands/probe_arm.h"
#include "palpate/error.h"
#include "palpate/pictures/draw_joint_torques.h"
#include "palpate/pictures/draw_touch.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

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
          .touch = prober.approach().value()};
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
}

}  // namespace palpate::apps
