// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_score.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

TEST(ErrorStatistics, OfKnownValues) {
  const ErrorStatistics s = error_statistics({3, -4, 0, 1, -2});
  EXPECT_EQ(s.count, 5);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt(30.0 / 5));
  EXPECT_DOUBLE_EQ(s.median, 2);
  EXPECT_DOUBLE_EQ(s.p90, 3.6);  // between 3 and 4
  EXPECT_DOUBLE_EQ(s.p95, 3.8);
  EXPECT_DOUBLE_EQ(s.max, 4);
}

TEST(ErrorStatistics, DoNotDependOnOrderAndLeaveOutWhatIsNotFinite) {
  const ErrorStatistics a = error_statistics({0.1, 0.7, 1000.1, -0.3});
  const ErrorStatistics b =
      error_statistics({1000.1, kNaN, -0.3, 0.1, 0.7, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.median, b.median);
}

TEST(ErrorStatistics, OfNothingAreNaN) {
  const ErrorStatistics s = error_statistics({kNaN});
  EXPECT_EQ(s.count, 0);
  EXPECT_TRUE(std::isnan(s.rms) && std::isnan(s.median) && std::isnan(s.p90) && std::isnan(s.max));
}

TEST(DepthDifference, IsSignedAndUnknownWhereEitherIs) {
  ImageF a = ImageF::Constant(2, 3, 700.5f);
  ImageF b = ImageF::Constant(2, 3, 700.0f);
  a(0, 0) = kUnknown;
  b(1, 2) = kUnknown;
  const ImageF difference = depth_difference(a, b);
  EXPECT_TRUE(std::isnan(difference(0, 0)));
  EXPECT_TRUE(std::isnan(difference(1, 2)));
  EXPECT_EQ(difference(0, 1), 0.5f);
}

TEST(DepthDifference, RefusesMapsOfDifferentSize) {
  EXPECT_THROW((void)depth_difference(ImageF::Zero(2, 3), ImageF::Zero(3, 2)), InvalidInput);
}

TEST(RangeMapScore, CountsWhatIsFoundAndWhatIsWrong) {
  ImageF truth = ImageF::Constant(2, 5, 1000.0f);
  truth.col(4) = kUnknown;
  ImageF measured = truth;
  measured(0, 0) = 1000.5f;   // within the bound
  measured(0, 1) = 1010.0f;   // beyond it
  measured(1, 1) = kUnknown;  // not found
  measured(0, 4) = 900.0f;    // found where nothing is
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> measurable(2, 5);
  measurable << 1, 1, 1, 0, 0,  //
      1, 1, 1, 1, 0;
  const RangeMapScore score = score_range_map(measured, truth, measurable, 5);
  EXPECT_DOUBLE_EQ(score.reconstructed, 6.0 / 7);
  EXPECT_DOUBLE_EQ(score.wrong, 2.0 / 8);
  EXPECT_EQ(score.error.count, 7);
  EXPECT_DOUBLE_EQ(score.error.max, 10);
  EXPECT_DOUBLE_EQ(score.distance, 1000);
}

TEST(DistancesToSurface, ArePositiveOnTheSideOfTheNormals) {
  TriangleMesh square;
  square.vertices.resize(3, 4);
  square.vertices << 0, 10, 10, 0,  //
      0, 0, 10, 10,                 //
      5, 5, 5, 5;
  square.triangles.resize(3, 2);
  square.triangles << 0, 0,  //
      1, 2,                  //
      2, 3;
  Eigen::Matrix3Xd points(3, 4);
  points << 3, 3, 13, kNaN,  //
      4, 4, 14, 0,           //
      7.5, 1, 5, 0;
  const Eigen::VectorXd distances = distances_to_surface(points, square);
  EXPECT_DOUBLE_EQ(distances(0), 2.5);
  EXPECT_DOUBLE_EQ(distances(1), -4);
  EXPECT_DOUBLE_EQ(distances(2), 5);  // beyond the corner: 3 and 4 to the side
  EXPECT_TRUE(std::isnan(distances(3)));
}

TEST(RangeMapScore, RefusesAnErrorThatNothingCanBeBelow) {
  const ImageF z = ImageF::Constant(2, 3, 700);
  const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> all = z > 0;
  EXPECT_THROW((void)score_range_map(z, z, all, 0), InvalidInput);
  EXPECT_THROW((void)score_range_map(z, z, all, kNaN), InvalidInput);
}

TEST(Comparison, PartsOfOnlyOneSurfaceHaveNoDistance) {
  // A square of 2 mm at z = 5 in two triangles.
  TriangleMesh square;
  square.vertices.resize(3, 4);
  square.vertices << 0, 2, 2, 0, 0, 0, 2, 2, 5, 5, 5, 5;
  square.triangles.resize(3, 2);
  square.triangles << 0, 0, 1, 2, 2, 3;
  Eigen::Matrix3Xd points(3, 6);
  points.col(0) << 0.5, 1.5, 6;  // above it
  points.col(1) << 1, 1, 4.5;    // below the edge that both triangles share
  points.col(2) << 2.5, 1, 5.1;  // beside an edge of the border
  points.col(3) << -1, -1, 5;    // beside a corner
  points.col(4) << 1, 1.2, 9;    // far
  points.col(5) << std::nan(""), 0, 0;
  const Eigen::VectorXd distances = distances_in_both(points, square, 3);
  EXPECT_DOUBLE_EQ(distances(0), 1);
  EXPECT_DOUBLE_EQ(distances(1), 0.5);
  EXPECT_TRUE(distances.tail<4>().array().isNaN().all());
  EXPECT_DOUBLE_EQ(distances_in_both(points, square)(4), 4);
  EXPECT_THROW((void)distances_in_both(points, square, std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
