// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_selection.h"

#include <gtest/gtest.h>

#include <array>

#include "cloud_testing.h"
#include "not_finite.h"
#include "refusal.h"

namespace palpate::geometry {
namespace {

using test::Matrix3Xd;
using test::Vector3d;

/// A 2 x 2 cloud with bytes, floats, lists and normals.
PointCloud small_cloud() {
  PointCloud cloud;
  cloud.points.resize(3, 4);
  cloud.points << 0, 1, 2, 3, 0, 0, 0, 0, 5, 5, 5, 5;
  cloud.width = 2;
  cloud.height = 2;
  cloud.attributes = {
      {.name = "red", .values = std::vector<std::uint8_t>{10, 21, 200, 255}, .list_sizes = {}},
      {.name = "sigma", .values = std::vector<float>{0.5F, kFloatNaN, 1, 2}, .list_sizes = {}},
      {.name = "seen", .values = std::vector<int>{7, 8, 9, 1, 2, 3}, .list_sizes = {1, 0, 2, 3}}};
  Matrix3Xd normals(3, 4);
  normals << 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1;
  set_normals(cloud.attributes, normals);
  cloud.comments = {"made by hand"};
  return cloud;
}

template <typename Value>
std::vector<Value> values_of(const PointCloud& cloud, const char* name) {
  return std::get<std::vector<Value>>(find_attribute(cloud.attributes, name)->values);
}

TEST(PointsInBox, AreThoseBetweenItsCornersEndsIncluded) {
  Matrix3Xd points(3, 4);
  points << 0, 1, 1.5, kNaN, 0, 2, 0, 0, 0, 3, 0, 0;
  EXPECT_EQ(points_in_box(points, {Vector3d(0, 0, 0), Vector3d(1, 2, 3)}),
            (std::vector<int>{0, 1}));
  EXPECT_TRUE(points_in_box(points, {}).empty());
}

TEST(Selected, HasThePointsWithTheirAttributes) {
  const PointCloud chosen = selected(small_cloud(), std::array{3, 0});
  EXPECT_EQ(chosen.points.row(0), Eigen::RowVector2d(3, 0));
  EXPECT_EQ(chosen.width, 2);
  EXPECT_EQ(chosen.height, 1);
  EXPECT_EQ(values_of<std::uint8_t>(chosen, "red"), (std::vector<std::uint8_t>{255, 10}));
  EXPECT_EQ(values_of<int>(chosen, "seen"), (std::vector<int>{1, 2, 3, 7}));
  EXPECT_EQ(find_attribute(chosen.attributes, "seen")->list_sizes, (std::vector<int>{3, 1}));
  EXPECT_EQ(chosen.comments, small_cloud().comments);
}

TEST(Selected, RefusesWhatIsNoPoint) {
  EXPECT_EQ(refusal([] { return selected(small_cloud(), std::array{4}); }),
            "point cloud: there is no 4 among 4");
  PointCloud wrong = small_cloud();
  wrong.width = 3;
  EXPECT_EQ(refusal([&] { return selected(wrong, std::array{0}); }),
            "point cloud: is 3 x 2, but has 4 points");
}

TEST(WithOnly, KeepsTheGridAndForgetsTheOthers) {
  const PointCloud kept = with_only(small_cloud(), std::array{1, 2});
  EXPECT_EQ(kept.width, 2);
  EXPECT_EQ(kept.height, 2);
  EXPECT_TRUE(kept.points.col(0).array().isNaN().all());
  EXPECT_EQ(kept.points.middleCols(1, 2), small_cloud().points.middleCols(1, 2));
  EXPECT_EQ(values_of<std::uint8_t>(kept, "red"), values_of<std::uint8_t>(small_cloud(), "red"));
}

TEST(Averaged, HasMeansOfWhatIsKnown) {
  const Matrix3Xd points = Matrix3Xd::Constant(3, 2, 4);
  const PointCloud means = averaged(small_cloud(), std::array{0, 0, 1, 1}, points);
  EXPECT_EQ(means.points, points);
  EXPECT_EQ(values_of<std::uint8_t>(means, "red"), (std::vector<std::uint8_t>{16, 228}));
  EXPECT_EQ(values_of<float>(means, "sigma"), (std::vector<float>{0.5F, 1.5F}));
  EXPECT_EQ(find_attribute(means.attributes, "seen"), nullptr);
  const Matrix3Xd mean_normals = *normals(means.attributes);
  EXPECT_LT((mean_normals.col(0) - Vector3d(1, 1, 0).normalized()).norm(), 1e-15);
  EXPECT_TRUE(mean_normals.col(1).array().isNaN().all());  // opposite ones
}

TEST(Averaged, RefusesWrongGroups) {
  const Matrix3Xd points = Matrix3Xd::Zero(3, 2);
  EXPECT_EQ(refusal([&] {
              return averaged(small_cloud(), std::array{0, 0}, points);
            }),
            "point cloud: 4 points, but 2 have a group");
  EXPECT_EQ(refusal([&] {
              return averaged(small_cloud(), std::array{0, 0, -1, 0}, points);
            }),
            "point cloud: no point is in group 1");
}

TEST(Joined, HasAllPointsAndTheAttributesThatAllHave) {
  PointCloud other = small_cloud();
  std::get<std::vector<std::uint8_t>>(other.attributes.front().values) = {1, 2, 3, 4};
  other.attributes[1].values = std::vector<double>{1, 2, 3, 4};  // sigma in another type
  const PointCloud both = joined(std::array{small_cloud(), other});
  EXPECT_EQ(both.points.cols(), 8);
  EXPECT_EQ(both.width, 8);
  EXPECT_EQ(both.height, 1);
  EXPECT_EQ(values_of<std::uint8_t>(both, "red"),
            (std::vector<std::uint8_t>{10, 21, 200, 255, 1, 2, 3, 4}));
  EXPECT_EQ(find_attribute(both.attributes, "sigma"), nullptr);
  EXPECT_EQ(find_attribute(both.attributes, "seen"), nullptr);
  EXPECT_EQ(normals(both.attributes)->cols(), 8);
  EXPECT_EQ(joined(std::array{small_cloud()}).height, 2);
  EXPECT_EQ(refusal([] { return joined({}); }), "point clouds: there is none to join");
}

}  // namespace
}  // namespace palpate::geometry
