// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

namespace palpate::pictures {

/// Draws the forces of a played trajectory over time as a PNG of 1200 x 700 px: the three
/// components and the norm, over a background that shows whether the tool is free, sticks or slips.
/// Works without a display.
/// \param times N [s], not decreasing.
/// \param forces 3 x N [N]; NaN interrupts the line.
/// \param states N: 0 free, 1 stick, 2 slip; each lasts from its time to the next one.
/// \throws InvalidInput if sizes differ, there are fewer than two times, a time is not finite or
/// earlier than the one before, a state is unknown, or no force is finite.
/// \throws OutputError if the picture cannot be written.
void draw_forces(const std::filesystem::path& png, const Eigen::Ref<const Eigen::VectorXd>& times,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                 const Eigen::Ref<const Eigen::VectorXi>& states, const std::string& title);

}  // namespace palpate::pictures
