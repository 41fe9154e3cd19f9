// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/slip_search.h"
#include "not_finite.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "height_field_model.h"
#include "not_finite.h"
#include "palpate/haptics/contact_motion.h"

namespace palpate::haptics {
namespace {

constexpr double kTolerance = 2e-4;  // [N]

// The way along the section and the projected line agree to this part of the way, where the surface
// turns by up to 0.1 rad per mm.
constexpr double kSectionAgrees = 0.1;
constexpr double kBrentTolerance = 5e-3;  // [N] of 1e-3 mm, at a stiffness below 5 N/mm

class SlipSearch : public ::testing::Test {
 protected:
  const Model model = height_field_model({.height = waves, .friction = 0.4, .uneven = true});
  const PackedField field{model};
  const SurfaceWalk surface{model.surface};

  [[nodiscard]] PackedField slippery() const {
    Model copy = model;
    for (ContactModel& c : copy.contacts) c.friction *= 0.1;
    return PackedField(copy);
  }
};

// The contact nearest to `near`.
SlidingContact contact_of(const PackedField& field, const Eigen::Vector3d& near,
                          const Eigen::Vector3d& tool, PlaceField& place) {
  const auto at = field.blended().surface().closest_point(near);
  field.move_to(at.at, at.position, place);
  SlidingContact result{.at = {at.at.triangle, at.position},
                        .force = field.force(place, tool - at.position),
                        .parts = {}};
  result.parts = friction_parts(place, result.force.force);
  return result;
}

TEST_F(SlipSearch, FindsTheRootThatBrentsMethodFindsAfterSmallSteps) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(model.surface);
  int slips = 0, roots = 0, agree = 0;
  for (int i = 0; i < 200; ++i) {
    const double x = 20 * uniform(random), y = 20 * uniform(random);
    const Eigen::Vector3d above(x, y, waves(x, y));
    const Eigen::Vector3d tool =
        above + Eigen::Vector3d{2 * uniform(random), 2 * uniform(random), -3};
    PlaceField place;
    const SlidingContact start = contact_of(field, above, tool, place);
    if (start.parts.excess < 0.01) continue;
    ++slips;
    SlipMemory memory;
    const SlidingContact end =
        search_slip(field, surface, start, tool, {.tolerance = kTolerance}, place, memory);
    EXPECT_LE(std::abs(end.parts.excess), kTolerance) << i;
    EXPECT_LT(memory.slope, 0) << i;
    // The returned force is the one at the returned place.
    EXPECT_LT((field.force(place, tool - end.at.position).force - end.force.force).norm(), 1e-12);
    EXPECT_LT((position(model.surface, surface.point(end.at)) - end.at.position).norm(), 1e-6);
    const TouchPoint brent = slip_contact(
        field.blended(), normals,
        {start.at.position, surface.normal(start.at.triangle), surface.point(start.at)}, tool);
    // Brent's method moves along a straight line and projects: the ways differ by the curvature. It
    // also ends in minima that are no roots.
    const Blend there = field.blended().blend(brent.at);
    const FrictionParts parts =
        friction_parts(there, field.blended().force(there, tool - brent.position));
    if (std::abs(parts.excess) > kBrentTolerance) continue;
    ++roots;
    agree += (brent.position - end.at.position).norm() <
             kSectionAgrees * (end.at.position - start.at.position).norm();
  }
  EXPECT_GT(slips, 100);
  EXPECT_GT(roots, 8 * slips / 10);
  EXPECT_GT(agree, 9 * roots / 10);
}

// If friction is low, the section seldom has a root, and the last slip's Jacobian counts.
TEST_F(SlipSearch, FindsARootWhateverItRemembers) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const PackedField slippery_field = slippery();
  int slips = 0;
  for (int i = 0; i < 200; ++i) {
    const double x = 20 * uniform(random), y = 20 * uniform(random);
    const Eigen::Vector3d above(x, y, waves(x, y));
    const Eigen::Vector3d tool =
        above + Eigen::Vector3d{0.5 * uniform(random), 0.5 * uniform(random), -3};
    PlaceField place;
    const SlidingContact start = contact_of(slippery_field, above, tool, place);
    if (!(start.parts.excess > kTolerance)) continue;
    ++slips;
    SlipMemory fresh;
    PlaceField from = place;
    static_cast<void>(
        search_slip(slippery_field, surface, start, tool, {.tolerance = kTolerance}, from, fresh));
    SlipMemory wrong{.slope = -uniform(random), .in_plane = {}};
    wrong.in_plane = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
    const SlipMemory nothing{.slope = kNaN, .in_plane = Eigen::Matrix3d::Constant(kNaN)};
    for (SlipMemory memory : {SlipMemory{}, fresh, wrong, nothing}) {
      from = place;
      const SlidingContact end = search_slip(slippery_field, surface, start, tool,
                                             {.tolerance = kTolerance}, from, memory);
      EXPECT_LE(std::abs(end.parts.excess), kTolerance) << i;
    }
  }
  EXPECT_GT(slips, 100);
}

TEST_F(SlipSearch, NeverStoresMoreEnergyThanItMay) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const PackedField slippery_field = slippery();
  int stopped = 0;
  for (int i = 0; i < 300; ++i) {
    const double x = 20 * uniform(random), y = 20 * uniform(random);
    const Eigen::Vector3d above(x, y, waves(x, y));
    const Eigen::Vector3d tool =
        above + Eigen::Vector3d{0.5 * uniform(random), 0.5 * uniform(random), -3};
    for (const bool passive : {false, true}) {
      PlaceField place;
      const SlidingContact start = contact_of(slippery_field, above, tool, place);
      if (!(start.parts.excess > kTolerance)) continue;
      SlipMemory memory;
      const SlidingContact end =
          search_slip(slippery_field, surface, start, tool,
                      {.tolerance = kTolerance,
                       .budget = passive ? 0 : std::numeric_limits<double>::infinity()},
                      place, memory);
      if (passive) {
        EXPECT_LE(end.force.energy, start.force.energy + 1e-9) << i;
      } else {
        stopped += end.force.energy > start.force.energy + 1e-6;
      }
    }
  }
  EXPECT_GT(stopped, 3);  // without the rule some do
}

}  // namespace
}  // namespace palpate::haptics
