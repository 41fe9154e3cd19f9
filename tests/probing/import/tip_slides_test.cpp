// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/tip_slides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kNormal = 0.5, kLateral = 0.4;  // [N/mm] of a linear object below z = 0
constexpr double kFriction = 0.6;

/// A tip on a way in steps of 0.05 mm over the object, which it drags along until friction yields.
struct DraggedTip {
  Vector3d tip = Vector3d::Zero();
  Vector3d held = Vector3d::Zero();  // the place of the surface that the tip holds
  std::size_t moment = 0;
  TipSlides slides{0, Vector3d::Zero(), {0, 0, -0.1}, 0.1, 1};
  std::optional<TipSlide> found;
  double slid = 0;

  [[nodiscard]] Vector3d force() const {
    return {kLateral * (tip.x() - held.x()), kLateral * (tip.y() - held.y()), kNormal * tip.z()};
  }
  void go(const Vector3d& to) {
    const int steps = std::max(1, static_cast<int>((to - tip).norm() / 0.05));
    const Vector3d step = (to - tip) / steps;
    for (int i = 0; i < steps; ++i) {
      tip += step;
      const double limit = kFriction * -force().z(), drag = force().head<2>().norm();
      if (drag > limit) {
        const Vector3d before = held;
        held.head<2>() += (drag - limit) / kLateral * force().head<2>().normalized();
        slid += (held - before).norm();
      }
      ++moment;
      if (!found) found = slides.add(moment, tip, force());
    }
  }
};

TEST(TipSlides, AreNotSeenInPressesAndDragsThatHold) {
  DraggedTip tip;
  for (int cycle = 0; cycle < 2; ++cycle) {
    tip.go({0, 0, -4});
    for (const double angle : {0.0, 1.5, 3.1, 4.6}) {  // 2.5 mm aside is 1 N of at most 1.2 N
      tip.go({2.5 * std::cos(angle), 2.5 * std::sin(angle), -4});
      tip.go({0, 0, -4});
    }
    tip.go({0, 0, -0.1});
  }
  EXPECT_EQ(tip.slid, 0);
  EXPECT_FALSE(tip.found);
  EXPECT_FALSE(tip.slides.release({0.02, 0, 0}, {0, 0, -0.05}));
}

TEST(TipSlides, AreSeenWithinTheirLengthAndTheForceIsThatOfFriction) {
  DraggedTip tip;
  tip.go({0, 0, -4});
  tip.go({2.9, 0, -4});
  EXPECT_EQ(tip.slid, 0);
  tip.go({6, 0, -4});
  ASSERT_TRUE(tip.found);
  // It held until 3 mm; forces within one step, 0.1 N, are the same.
  EXPECT_NEAR(tip.found->force.x(), kFriction * 2, 0.11);
  EXPECT_NEAR(tip.found->force.z(), -2, 1e-9);
  EXPECT_NEAR(tip.found->tip.x(), 3, 0.11 / kLateral);
  EXPECT_LT(tip.found->last_held, tip.moment);
  // 1 mm and what the object gives way by for 0.1 N are needed.
  DraggedTip shorter;
  shorter.go({0, 0, -4});
  shorter.go({3.8, 0, -4});
  EXPECT_GT(shorter.slid, 0.7);
  EXPECT_FALSE(shorter.found);
}

TEST(TipSlides, ThereAndBackAreSeenAndSoAreThoseWithoutFriction) {
  DraggedTip tip;
  tip.go({0, 0, -4});
  tip.go({-8, 0, -4});
  tip.go({0, 0, -4});
  EXPECT_TRUE(tip.found);
  TipSlides smooth(0, Vector3d::Zero(), {0, 0, -0.1}, 0.1, 1);
  EXPECT_FALSE(smooth.add(1, {0, 0, -2}, {0, 0, -1}));
  EXPECT_TRUE(smooth.add(2, {5, 0, -2}, {0, 0, -1}));
}

TEST(TipSlides, ThatWereTooFastToBeSeenAreSeenAtTheRelease) {
  DraggedTip tip;
  tip.go({0, 0, -4});
  EXPECT_FALSE(tip.slides.release({0.8, 0, 0}, {0, 0, -0.05}));
  const std::optional<TipSlide> slide = tip.slides.release({12, 0, 0}, {0, 0, -0.05});
  ASSERT_TRUE(slide);
  EXPECT_EQ(slide->last_held, 0u);
}

TEST(TipSlides, AreNotDepthsThatCreep) {
  TipSlides slides(0, Vector3d::Zero(), {0, 0, -0.1}, 0.1, 1);
  EXPECT_FALSE(slides.add(1, {0, 0, -4}, {0, 0, -2}));
  EXPECT_FALSE(slides.add(2, {0, 0, -9}, {0, 0, -2}));
}

}  // namespace
}  // namespace palpate::probing
