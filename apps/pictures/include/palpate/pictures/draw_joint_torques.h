// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace palpate::pictures {

/// The torques that held a joint at rest, and the gravity that was fitted to them.
struct JointTorques {
  Eigen::VectorXd angles;      ///< [degrees] N
  Eigen::VectorXd torques;     ///< [N mm] N
  Eigen::VectorXi directions;  ///< N: 1 if the joint came upwards, -1 downwards
  Eigen::VectorXd gravity;     ///< [N mm] N: fitted, at the same poses
  double friction = 0;         ///< [N mm] fitted; half of the difference of the directions
};

/// Draws the compensation of gravity as Figure 4.6 of the thesis: torques against angles, those
/// after upward and after downward motion, the same without friction, and the fitted line. PNG of
/// 1200 x 700 px. Works without a display.
/// \throws InvalidInput naming what is empty, of another size, or not finite.
/// \throws OutputError if the picture cannot be written.
void draw_joint_torques(const std::filesystem::path& png, const JointTorques& joint,
                        const std::string& title);

}  // namespace palpate::pictures
