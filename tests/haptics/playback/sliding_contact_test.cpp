// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/sliding_contact.h"

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

TEST(SlipLine, MeetsTheTangentPlaneWhereTheAxisThroughTheToolDoes) {
  const Eigen::Vector3d normal(0, 0, -1), axis = Eigen::Vector3d(0.3, -0.2, 1).normalized();
  const Eigen::Vector3d displacement(4, 5, 6);
  const Eigen::Vector3d line = slip_line(axis, normal, displacement);
  EXPECT_EQ(line.z(), 0);
  EXPECT_LT((displacement - line).cross(axis).norm(), 1e-12);
  EXPECT_EQ(slip_line({1, 0, 0.1}, normal, displacement), Eigen::Vector3d(4, 5, 0));
}

}  // namespace
}  // namespace palpate::haptics
