// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "force_reading.h"
#include "scene_renderer.h"
#include "tool_motion.h"

namespace palpate::view {

/// The scales at which the tool and its force are drawn.
struct ToolScale {
  double diagonal = 1;          ///< [mm] of the object
  double radius = 1;            ///< [mm] of the ball
  double length_of_newton = 1;  ///< [mm]
};

/// The tool where it touches: ball, arrow of the force on the user, and friction cone, whose rim
/// the arrow's end stays within while the contact holds.
[[nodiscard]] std::vector<Solid> touching_tool(const FeltTick& tick, const ForceReading& reading,
                                               const ToolScale& scale);
/// The tool where it would touch.
[[nodiscard]] std::vector<Solid> hovering_tool(const PickedPlace& place, const ToolScale& scale);
/// The tool in the air.
[[nodiscard]] std::vector<Solid> free_tool(const Eigen::Vector3d& tool, const ToolScale& scale);

/// The colour of a state (theme.h).
[[nodiscard]] unsigned color_of(haptics::ContactState state);

}  // namespace palpate::view
