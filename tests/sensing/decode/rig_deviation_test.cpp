// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/rig_deviation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "not_finite.h"
#include "palpate/core/error.h"
#include "setup/moved_rig.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

/// Independent deviations of a good calibration.
Rig uncertain_rig() {
  Rig rig = make_verging_rig();
  rig.covariance = RigCovariance::Zero();
  for (int p = 0; p < kRigParameters; ++p) {
    const bool of_lens = p < 18 && p % 9 >= 4;
    const double deviation = of_lens ? 5e-4 : p < 18 ? 0.2 : p < 21 ? 1e-4 : 0.05;
    (*rig.covariance)(p, p) = deviation * deviation;
  }
  return rig;
}

TEST(RigDeviation, IsTheScatterOfDepthsWhenEachParameterChanges) {
  const Rig rig = uncertain_rig();
  for (const bool transposed : {false, true}) {
    const Axis axis = Axis::y;
    const long rows = transposed ? 640 : 480;
    const long columns = transposed ? 480 : 640;
    const RigDeviation deviation(rig, axis, {.transposed = transposed, .z = 500}, rows, columns);
    Plane z = Plane::Constant(rows, columns, 480);
    z(100, 200) = 610;
    z(301, 77) = 431;
    Plane sigma = Plane::Constant(rows, columns, 0.03F);
    Plane noise;
    deviation.add(z, {}, sigma, noise);
    EXPECT_TRUE((noise == 0.03F).all());
    const Triangulation exact(rig);
    for (const auto& [row, column] : {std::pair{100, 200}, {301, 77}, {240, 400}, {333, 311}}) {
      const Eigen::Vector2d pixel =
          transposed ? Eigen::Vector2d(row, column) : Eigen::Vector2d(column, row);
      const double depth = static_cast<double>(z(row, column));
      const double lit_by =
          exact.project(exact.direction(geometry::undistort(rig.camera, pixel)), depth).y();
      double variance = 0.03 * 0.03;
      for (int p = 0; p < kRigParameters; ++p) {
        const Rig other = moved_rig(rig, p, std::sqrt((*rig.covariance)(p, p)));
        const Triangulation moved(other);
        const double moved_depth =
            moved.depth(moved.direction(geometry::undistort(other.camera, pixel)), axis, lit_by);
        variance += (moved_depth - depth) * (moved_depth - depth);
      }
      // The table is interpolated.
      EXPECT_NEAR(static_cast<double>(sigma(row, column)), std::sqrt(variance),
                  0.03 * std::sqrt(variance))
          << row << ' ' << column;
    }
  }
}

TEST(RigDeviation, IsTheSameInAPartOfTheImage) {
  const Rig rig = uncertain_rig();
  const RigDeviation deviation(rig, Axis::y, {.z = 500}, 480, 640);
  const ImagePart part{.row = 16, .column = 48, .rows = 101, .columns = 333};
  const Plane z = 480 + 30 * Plane::Random(480, 640);
  Plane sigma = Plane::Constant(480, 640, 0.03F), noise;
  deviation.add(z, {}, sigma, noise);
  Plane of_part = Plane::Constant(part.rows, part.columns, 0.03F);
  deviation.add(part_of(z, part), part, of_part, noise);
  EXPECT_TRUE((of_part == part_of(sigma, part)).all());
}

TEST(RigDeviation, UnknownDepthsStayUnknown) {
  const Rig rig = uncertain_rig();
  const RigDeviation deviation(rig, Axis::y, {.z = 500}, 480, 640);
  Plane z = Plane::Constant(480, 640, 500);
  Plane sigma = Plane::Constant(480, 640, 0.03F);
  z(7, 9) = sigma(7, 9) = std::numeric_limits<float>::quiet_NaN();
  z(479, 639) = 1e6F;  // far beyond the table
  z(0, 0) = 1;         // far before it
  Plane noise;
  deviation.add(z, {}, sigma, noise);
  EXPECT_TRUE(std::isnan(sigma(7, 9)) && std::isnan(noise(7, 9)));
  EXPECT_TRUE(std::isfinite(sigma(479, 639)) && std::isfinite(sigma(0, 0)));
  EXPECT_EQ(sigma.isFinite().count(), sigma.size() - 1);
}

TEST(RigDeviation, ARigWithoutCovarianceHasNone) {
  EXPECT_FALSE(RigDeviation(make_verging_rig(), Axis::y, {.z = 500}, 480, 640).is_known());
  Rig apart = uncertain_rig();
  apart.projector.cx = 1e5;  // lights nothing that the camera sees
  EXPECT_THROW(RigDeviation(apart, Axis::y, {.z = 500}, 480, 640), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
