// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "tool_solids.h"

#include "theme.h"

namespace palpate::view {
namespace {

using haptics::ContactState;

constexpr double kShortestCone = 0.002;  // diagonals: a shorter one is not drawn
constexpr double kHaloSize = 1.7;        // radii of the ball
constexpr double kHoverHeight = 1.6;     // radii of the ball
constexpr float kConeOpacity = 0.2F, kGhostOpacity = 0.4F;

}  // namespace

unsigned color_of(ContactState state) {
  switch (state) {
    case ContactState::free:
      return kFree;
    case ContactState::stick:
      return kStick;
    case ContactState::slip:
      break;
  }
  return kSlip;
}

std::vector<Solid> touching_tool(const FeltTick& tick, const ForceReading& reading,
                                 const ToolScale& scale) {
  const Eigen::Vector3d round = Eigen::Vector3d::Constant(scale.radius);
  const Eigen::Vector3d outwards = -reading.inwards;
  std::vector<Solid> solids{
      {Shape::ball, tick.tool + scale.radius * outwards, outwards, round, color(kTool)}};
  const std::vector<Solid> force =
      arrow(tick.tool, tick.force * scale.length_of_newton, scale.diagonal, color(kForce));
  solids.insert(solids.end(), force.begin(), force.end());
  const double height = reading.normal * scale.length_of_newton;
  const double wide = reading.friction * height;
  if (height > kShortestCone * scale.diagonal && wide > 0) {
    const Eigen::Vector3f rgb = color(color_of(tick.state));
    solids.push_back({Shape::ring, tick.tool + height * outwards, outwards,
                      Eigen::Vector3d::Constant(wide), rgb});
    solids.push_back({Shape::cone, tick.tool, outwards, {wide, wide, height}, rgb, kConeOpacity});
  }
  return solids;
}

std::vector<Solid> hovering_tool(const PickedPlace& place, const ToolScale& scale) {
  const Eigen::Vector3d round = Eigen::Vector3d::Constant(scale.radius);
  return {{Shape::halo, place.position, place.normal, kHaloSize * round, color(kForce)},
          {Shape::ball, place.position + kHoverHeight * scale.radius * place.normal, place.normal,
           round, color(kTool), kGhostOpacity}};
}

std::vector<Solid> free_tool(const Eigen::Vector3d& tool, const ToolScale& scale) {
  return {{Shape::ball, tool, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Constant(scale.radius),
           color(kTool)}};
}

}  // namespace palpate::view
