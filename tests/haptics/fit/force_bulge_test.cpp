// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/force_bulge.h"

#include <gtest/gtest.h>

#include "haptics_testing.h"
#include "palpate/haptics/passivity_certificate.h"

namespace palpate::haptics {
namespace {

// Displacements [mm] and forces [N] of a contact of a noisy sheet.
struct SheetPairs {
  Eigen::Matrix3Xd displacements{3, 6}, forces{3, 6};
  SheetPairs() {
    displacements.transpose() << -0.57, 0.15, 5.25, -0.46, 0.48, 5.09, -1.83, 0.01, 8.76, -2.51,
        2.97, 8.77, -3.14, -0.11, 11.74, -4.65, 3.91, 11.91;
    forces.transpose() << 0, 0, 0.5, 0.245, 0.05, 0.5, 0, 0, 1.5, -0.497, 0.562, 1.5, 0, 0, 3,
        -0.993, 1.124, 3;
  }
};

// A field that was fitted to pairs of that contact: within 0.2 N of them, but it takes 5.8 N at 1
// mm.
ForceField bumpy_field() {
  return {{{37.8492, 8.5458, {3.347, 1.775, 8.696}},
           {-15.7574, 1.2112, {5.568, 1.811, 10.679}},
           {-21.0415, 2.1321, {0.887, -0.014, 0.372}},
           {18.8788, 0.9694, {0.324, -0.002, 0.111}},
           {-12.6813, 7.5160, {-3.843, 1.345, 4.243}}}};
}

// A convex field of another fit to them.
ForceField ridges() {
  return {
      {{2.4776, 5.0299, {0.323, -6.018, 7.992}, Eigen::Vector3d(0.032, -0.601, 0.798).normalized()},
       {1.4119,
        0.6561,
        {2.596, 0.748, 1.512},
        Eigen::Vector3d(-0.839, -0.241, -0.488).normalized()},
       {2.1751,
        4.7201,
        {-6.193, 4.292, 4.864},
        Eigen::Vector3d(-0.691, 0.479, 0.542).normalized()}}};
}

TEST(ForceBulge, IsFoundBetweenRestAndThePairsThoughTheFieldIsPassive) {
  const SheetPairs pairs;
  const ForceField field = bumpy_field();
  ASSERT_TRUE(is_passive(certify_passivity(field, reachable_volume(pairs.displacements))));
  for (Eigen::Index i = 0; i < pairs.forces.cols(); ++i)
    ASSERT_LT((force(field, pairs.displacements.col(i)) - pairs.forces.col(i)).norm(), 0.25) << i;
  EXPECT_NEAR(force_bulge(field, pairs.displacements, pairs.forces), 5.8 / 3.35, 0.1);
}

TEST(ForceBulge, IsNoneWhereTheForceGrowsToThePairs) {
  const SheetPairs pairs;
  EXPECT_LT(force_bulge(ridges(), pairs.displacements, pairs.forces), 1.05);
  EXPECT_EQ(force_bulge(ForceField{}, pairs.displacements, pairs.forces), 1);
  // It is relative to the forces of the pairs, and has no unit.
  EXPECT_NEAR(force_bulge(ridges(), pairs.displacements, 0.5 * pairs.forces), 2, 0.1);
}

}  // namespace
}  // namespace palpate::haptics
