// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/attribute_transfer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "not_finite.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

TEST(AttributeTransfer, KeepsTheValuesOfChosenElementsToTheBit) {
  const Attributes all = {{"label", std::vector<std::int64_t>{5, -1, 1LL << 60}, {}},
                          {"sigma", std::vector<float>{0.1F, 0.2F, 0.3F}, {}},
                          {"uv", std::vector<float>{1, 2, 3, 4, 5, 6}, {1, 2, 3}}};
  const Attributes chosen = selected_attributes(all, std::vector<int>{2, 0, 2});
  EXPECT_EQ(std::get<std::vector<std::int64_t>>(chosen[0].values),
            (std::vector<std::int64_t>{1LL << 60, 5, 1LL << 60}));
  EXPECT_EQ(std::get<std::vector<float>>(chosen[1].values), (std::vector<float>{0.3F, 0.1F, 0.3F}));
  EXPECT_EQ(chosen[2].list_sizes, (std::vector<int>{3, 1, 3}));
  EXPECT_EQ(std::get<std::vector<float>>(chosen[2].values),
            (std::vector<float>{4, 5, 6, 1, 4, 5, 6}));
  EXPECT_NE(refusal([&] { return selected_attributes(all, std::vector<int>{3}); }).find("3"),
            std::string::npos);
}

TEST(AttributeTransfer, ReproducesWhatIsLinearOnTheSurface) {
  const TriangleMesh sheet = test::flat_sheet(7, 5, 1.3);
  std::vector<double> heights;
  std::vector<std::uint8_t> red;
  for (const auto& v : sheet.vertices.colwise()) {
    heights.push_back(3 * v.x() - 2 * v.y() + 1);
    red.push_back(static_cast<std::uint8_t>(20 * v.x()));
  }
  const Attributes attributes = {{"height", heights, {}}, {"red", red, {}}};
  std::vector<SurfacePoint> places;
  for (int t = 0; t < sheet.triangles.cols(); ++t) places.push_back({t, {0.2, 0.3, 0.5}});
  const Attributes there = interpolated_attributes(attributes, sheet, places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d at = position(sheet, places[i]);
    EXPECT_NEAR(std::get<std::vector<double>>(there[0].values)[i], 3 * at.x() - 2 * at.y() + 1,
                1e-12);
    // Cut off at the corners, and rounded in between.
    EXPECT_NEAR(std::get<std::vector<std::uint8_t>>(there[1].values)[i], 20 * at.x(), 1.5);
  }
}

TEST(AttributeTransfer, TakesLabelsAndListsOfTheNearestCorner) {
  TriangleMesh one;
  one.vertices = Eigen::Matrix3d::Identity();
  one.triangles = Eigen::Vector3i(0, 1, 2);
  const Attributes attributes = {{"label", std::vector<std::int32_t>{7, 100, 9}, {}},
                                 {"uv", std::vector<float>{1, 2, 3}, {1, 0, 2}}};
  const Attributes there = interpolated_attributes(
      attributes, one, std::vector<SurfacePoint>{{0, {0.5, 0.3, 0.2}}, {0, {0.1, 0.2, 0.7}}});
  EXPECT_EQ(std::get<std::vector<std::int32_t>>(there[0].values),
            (std::vector<std::int32_t>{7, 9}));
  EXPECT_EQ(there[1].list_sizes, (std::vector<int>{1, 2}));
  EXPECT_EQ(std::get<std::vector<float>>(there[1].values), (std::vector<float>{1, 2, 3}));
}

TEST(AttributeTransfer, KeepsUnknownValuesWhereTheyAreTheNearest) {
  TriangleMesh one;
  one.vertices = Eigen::Matrix3d::Identity();
  one.triangles = Eigen::Vector3i(0, 1, 2);
  const Attributes attributes = {{"sigma", std::vector<double>{kNaN, 2, 4}, {}}};
  const Attributes there = interpolated_attributes(
      attributes, one, std::vector<SurfacePoint>{{0, {0.6, 0.2, 0.2}}, {0, {0.2, 0.4, 0.4}}});
  EXPECT_TRUE(std::isnan(std::get<std::vector<double>>(there[0].values)[0]));
  EXPECT_NEAR(std::get<std::vector<double>>(there[0].values)[1], 3, 1e-12);
}

TEST(AttributeTransfer, RefusesPlacesAndAttributesOfOtherMeshes) {
  const TriangleMesh sheet = test::flat_sheet(2, 2, 1);
  const std::vector<SurfacePoint> outside = {{99, {1, 0, 0}}};
  EXPECT_NE(refusal([&] { return interpolated_attributes({}, sheet, outside); }).find("99"),
            std::string::npos);
  const Attributes few = {{"sigma", std::vector<double>{1, 2}, {}}};
  EXPECT_NE(refusal([&] { return interpolated_attributes(few, sheet, {}); }).find("sigma"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
