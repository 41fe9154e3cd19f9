// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/import_conversion.h"

#include <gtest/gtest.h>

namespace palpate::probing {
namespace {

TEST(ImportConversion, AppliesUnitsBeforeTheFrameAndTheSignToForcesAlone) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  T.translation() << 1, 2, 3;
  const AcquisitionMapping mapping{
      .length = 10, .force = 0.5, .time = 60, .forces_on_tool = true, .T_surface_file = T};
  const ImportConversion convert(mapping);
  EXPECT_EQ(convert.position({1, 0, 0}), Eigen::Vector3d(1, 12, 3));
  EXPECT_EQ(convert.direction({1, 0, 0}), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(convert.force(Eigen::Vector3d(4, 0, 0)), Eigen::Vector3d(0, -2, 0));
  EXPECT_EQ(convert.force(4), -2);
  EXPECT_EQ(convert.length(4), 40);
  EXPECT_EQ(convert.time(0.5), 30);
}

}  // namespace
}  // namespace palpate::probing
