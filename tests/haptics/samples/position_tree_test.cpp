// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/position_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace palpate::haptics {
namespace {

using ::testing::IsEmpty;
using ::testing::UnorderedElementsAreArray;

Eigen::Matrix3Xd scattered_positions(int count) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 20);
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&] { return normal(random); });
}

TEST(PositionTree, FindsTheSamePositionsAsASearchAmongAll) {
  const Eigen::Matrix3Xd positions = scattered_positions(500);
  const PositionTree tree(positions);
  const auto is_even = [](std::size_t i) { return i % 2 == 0; };
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(30, -5, 12)}) {
    const Eigen::VectorXd distances = (positions.colwise() - place).colwise().norm();
    std::vector<std::size_t> even, in_cube;
    for (std::size_t i = 0; i < 500; ++i) {
      const Eigen::Vector3d offset = positions.col(static_cast<Eigen::Index>(i)) - place;
      if (is_even(i)) even.push_back(i);
      if (offset.cwiseAbs().maxCoeff() <= 15) in_cube.push_back(i);
    }
    std::ranges::sort(even, {},
                      [&](std::size_t i) { return distances(static_cast<Eigen::Index>(i)); });
    even.resize(7);
    EXPECT_THAT(tree.nearest(place, 7, is_even), UnorderedElementsAreArray(even));
    EXPECT_THAT(tree.in_cube(place, 15), UnorderedElementsAreArray(in_cube));
  }
}

TEST(PositionTree, FindsNothingAmongNoPositions) {
  const PositionTree tree(Eigen::Matrix3Xd(3, 0));
  EXPECT_THAT(tree.in_cube({0, 0, 0}, 1e3), IsEmpty());
  EXPECT_THAT(tree.nearest({0, 0, 0}, 3, [](std::size_t) { return true; }), IsEmpty());
}

}  // namespace
}  // namespace palpate::haptics
