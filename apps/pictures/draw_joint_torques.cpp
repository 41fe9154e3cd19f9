// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_joint_torques.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr double kHeldMarkSize = 9, kCorrectedMarkSize = 5;  ///< px

void check_joint_torques(const JointTorques& joint) {
  refuse_unless(joint.angles.size() > 0, "angles", "is empty: there is nothing to draw");
  check_count(joint.torques.size(), joint.angles.size(), "torques");
  check_count(joint.directions.size(), joint.angles.size(), "directions");
  check_count(joint.gravity.size(), joint.angles.size(), "gravity");
  for (Eigen::Index i = 0; i < joint.angles.size(); ++i) {
    const std::string place = "pose " + std::to_string(i);
    require([&] { return "angles: " + place; }, joint.angles(i), finite(), "degrees");
    require([&] { return "torques: " + place; }, joint.torques(i), finite(), "N mm");
    require([&] { return "gravity: " + place; }, joint.gravity(i), finite(), "N mm");
    refuse_unless(std::abs(joint.directions(i)) == 1, "directions",
                  place + " is " + std::to_string(joint.directions(i)) + ": 1 or -1 is needed");
  }
  require("friction", joint.friction, finite(), "N mm");
}

/// The torques after motion in one direction; NaN for the others.
Eigen::VectorXd torques_after(const JointTorques& joint, int direction) {
  Eigen::VectorXd torques = joint.torques;
  for (Eigen::Index i = 0; i < torques.size(); ++i)
    if (joint.directions(i) != direction) torques(i) = std::nan("");
  return torques;
}

}  // namespace

void draw_joint_torques(const std::filesystem::path& png, const JointTorques& joint,
                        const std::string& title) {
  check_joint_torques(joint);
  const Eigen::VectorXd corrected =
      joint.torques - joint.friction * joint.directions.cast<double>();
  const double rms =
      std::sqrt((corrected - joint.gravity).squaredNorm() / static_cast<double>(corrected.size()));
  Canvas canvas(kChartPictureHeight, title,
                "friction " + format_value(joint.friction, 0.1) + " N mm; fit to " +
                    format_value(rms, 0.01) + " N mm RMS");
  const double width = Canvas::kWidth - 2 * kChartMargin;
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2}, width,
             {{"after moving up", kBlue, Mark::dot},
              {"after moving down", kVermilion, Mark::dot},
              {"without friction", kGrey, Mark::dot},
              {"fitted gravity", kBlack}});
  Axis angle{kEmptySpan, "angle of the joint (degrees)"}, torque{kEmptySpan, "torque (N mm)"};
  angle.span.include(joint.angles);
  angle.span.pad();
  torque.span.include(joint.torques);
  torque.span.include(corrected);
  torque.span.include(joint.gravity);
  torque.span.pad();
  Chart chart(canvas,
              {kChartMargin, kChartMargin, width, canvas.top() - kLegendHeight - kChartMargin},
              angle, torque);
  chart.add_axes();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(joint.angles.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index a, Eigen::Index b) { return joint.angles(a) < joint.angles(b); });
  const Eigen::VectorXd angles = joint.angles(order), gravity = joint.gravity(order);
  chart.add_line(angles, gravity, kBlack, 3);
  chart.add_markers(joint.angles, torques_after(joint, 1), kBlue, kHeldMarkSize);
  chart.add_markers(joint.angles, torques_after(joint, -1), kVermilion, kHeldMarkSize);
  chart.add_markers(joint.angles, corrected, kGrey, kCorrectedMarkSize);
  canvas.write(png);
}

}  // namespace palpate::pictures
