// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/realignment.h"

#include <gtest/gtest.h>

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

const probing::Contact kContact{4, {10, 20, 700}, {0, 0, -1}};

probing::Sample sample(long long group, const Vector3d& force, const Vector3d& a, const Vector3d& b,
                       bool slipped = false) {
  return {
      .id = 0, .contact = 4, .group = group, .force = force, .a = a, .b = b, .slipped = slipped};
}

TEST(Realign, MovesEachGroupOntoItsMean) {
  const std::vector<probing::Sample> samples = {
      sample(7, {0.5, 0, 2}, {10.1, 20, 703}, {12.1, 20, 703.5}),
      sample(7, {0, 0.5, 2}, {9.9, 20.2, 703.4}, {9.9, 23.2, 704})};
  const ForceSamples pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 3);
  const Vector3d mean(0, 0.1, 3.2);  // of a, from the contact
  EXPECT_TRUE(pairs.displacements.col(0).isApprox(mean, 1e-12));
  EXPECT_TRUE(pairs.displacements.col(1).isApprox(mean + Vector3d(2, 0, 0.5), 1e-12));
  EXPECT_TRUE(pairs.displacements.col(2).isApprox(mean + Vector3d(0, 3, 0.6), 1e-12));
  EXPECT_TRUE(pairs.forces.col(0).isApprox(Vector3d(0, 0, 2)));
  EXPECT_EQ(pairs.forces.col(1), Vector3d(0.5, 0, 2));
}

TEST(Realign, TakesOnlyTheFirstPositionOfASampleThatSlipped) {
  const std::vector<probing::Sample> samples = {
      sample(1, {1, 0, 2}, {10, 20, 704}, {1e6, 1e6, 1e6}, true),
      sample(1, {0, 0, 2}, {10, 20, 702}, {10, 20, 702})};
  const ForceSamples pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 2);
  EXPECT_EQ(pairs.displacements.col(0), Vector3d(0, 0, 3));
  EXPECT_EQ(pairs.displacements.col(1), Vector3d(0, 0, 3));
}

TEST(Realign, KeepsGroupsAndContactsApart) {
  std::vector<probing::Sample> samples = {sample(2, {0, 0, 1}, {10, 20, 701}, {10, 20, 701}),
                                          sample(1, {0, 0, 3}, {10, 20, 705}, {10, 20, 705}),
                                          sample(1, {0, 0, 3}, {0, 0, 0}, {0, 0, 0})};
  samples.back().contact = 5;
  const ForceSamples pairs = realign(kContact, samples);
  ASSERT_EQ(pairs.forces.cols(), 4);
  EXPECT_EQ(pairs.displacements.row(2), Eigen::RowVector4d(5, 5, 1, 1));
  EXPECT_EQ(pairs.forces.row(2), Eigen::RowVector4d(3, 3, 1, 1));
}

TEST(Realign, OfNothingIsNothing) { EXPECT_EQ(realign(kContact, {}).forces.cols(), 0); }

}  // namespace
}  // namespace palpate::haptics
