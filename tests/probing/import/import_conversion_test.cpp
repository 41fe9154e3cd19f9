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
  EXPECT_EQ(convert.normal_force(4, {0, 0, 1}), Eigen::Vector3d(0, 0, 2));
  EXPECT_EQ(convert.length(4), 40);
  EXPECT_EQ(convert.time(0.5), 30);
}

TEST(ImportConversion, TakesTheWeightBelowTheSensorOffWhateverTheSignOfItsNumbers) {
  const Eigen::Vector3d weight(0, 0, -0.3), force(0.1, 0, -2), normal(0, 0, 1);
  for (const bool on_tool : {false, true}) {
    const AcquisitionMapping mapping{.forces_on_tool = on_tool, .weight = weight};
    const ImportConversion convert(mapping);
    // The object pushes the tool back, and the weight pulls it down: the sensor feels their sum.
    const Eigen::Vector3d felt = -force + weight;
    const Eigen::Vector3d recorded = on_tool ? felt : Eigen::Vector3d(-felt);
    EXPECT_LT((convert.force(recorded) - force).norm(), 1e-15);
    EXPECT_EQ(convert.force(on_tool ? weight : Eigen::Vector3d(-weight)), Eigen::Vector3d::Zero());
    const double load = (on_tool ? 1 : -1) * recorded.z();  // positive while it presses ...
    const double number = on_tool ? -load : load;           // ... but negative on the tool
    EXPECT_LT((convert.normal_force(number, normal) - Eigen::Vector3d(0, 0, -2)).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace palpate::probing
