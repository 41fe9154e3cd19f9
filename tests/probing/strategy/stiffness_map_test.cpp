// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/stiffness_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

// A plane of 80 x 80 mm at z = 0.
geometry::TriangleMesh plane() {
  return geometry::test::height_field(40, 40, 2, [](double, double) { return 0.0; });
}

// Contacts on a square grid of 5 mm, 10 mm from the border or more.
template <typename Law>
std::vector<ContactStiffness> contacts_of(const Law& law, double noise, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<ContactStiffness> contacts;
  for (double y = 10; y <= 70; y += 5) {
    for (double x = 10; x <= 70; x += 5) {
      const double stiffness = law(x, y) * (1 + noise * normal(random));
      contacts.push_back({{x, y, 0}, stiffness, noise * stiffness});
    }
  }
  return contacts;
}

// A bump whose half height is at 12 mm from (40, 40).
double bump(double x, double y) {
  const double square = std::pow(x - 40, 2) + std::pow(y - 40, 2);
  return 0.1 * (1 + std::exp2(-square / 144));
}

TEST(StiffnessMap, ContourOfABumpIsWhereItIsHalfAsHigh) {
  const StiffnessMap map = stiffness_map(plane(), contacts_of(bump, 1e-3));
  EXPECT_TRUE(map.distinct);
  EXPECT_NEAR(map.stiff, 0.2, 0.002);
  EXPECT_LT((map.stiffest - Vector3d(40, 40, 0)).norm(), 3);
  // The median of the map is above the foot of the bump, which is wide.
  EXPECT_NEAR(map.soft, 0.1, 0.01);
  EXPECT_DOUBLE_EQ(map.threshold, (map.soft + map.stiff) / 2);
  const double radius = 12 * std::sqrt(-std::log2(map.threshold / 0.1 - 1));
  ASSERT_GT(map.contour.cols(), 20);
  for (const auto& end : map.contour.colwise())
    EXPECT_NEAR((end - Vector3d(40, 40, 0)).norm(), radius, 0.3);
  EXPECT_NEAR(map.area, std::numbers::pi * radius * radius, 0.03 * 452);
}

TEST(StiffnessMap, TheContourIsClosed) {
  const StiffnessMap map = stiffness_map(plane(), contacts_of(bump, 1e-3));
  // Each end of a segment is that of exactly one other.
  for (Eigen::Index i = 0; i < map.contour.cols(); ++i) {
    const Eigen::RowVectorXd away = (map.contour.colwise() - map.contour.col(i)).colwise().norm();
    EXPECT_EQ((away.array() < 1e-9).count(), 2);
  }
}

TEST(StiffnessMap, IsUnknownWhereNoContactIsNear) {
  const geometry::TriangleMesh surface = plane();
  const StiffnessMap map = stiffness_map(surface, contacts_of(bump, 1e-3));
  for (Eigen::Index i = 0; i < surface.vertices.cols(); ++i) {
    const Vector3d at = surface.vertices.col(i);
    const bool inside = (at.head<2>().array() >= 10).all() && (at.head<2>().array() <= 70).all();
    const bool far = (at.head<2>().array() < 4.9).any() || (at.head<2>().array() > 75.1).any();
    if (inside) EXPECT_TRUE(std::isfinite(map.stiffness(i)) && std::isfinite(map.deviation(i)));
    if (far) EXPECT_TRUE(std::isnan(map.stiffness(i)) && std::isnan(map.deviation(i)));
  }
}

TEST(StiffnessMap, NoiseOfAPlainObjectHasNoContour) {
  int distinct = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const StiffnessMap map =
        stiffness_map(plane(), contacts_of([](double, double) { return 0.1; }, 0.05, seed));
    distinct += map.distinct ? 1 : 0;
    EXPECT_NEAR(map.soft, 0.1, 0.005);
    if (map.distinct) continue;
    EXPECT_EQ(map.contour.cols(), 0);
    EXPECT_EQ(map.area, 0);
  }
  EXPECT_LE(distinct, 1);
}

TEST(StiffnessMap, RefusesASurfaceWithoutContacts) {
  geometry::TriangleMesh surface = plane();
  surface.vertices.row(2).array() += 500;
  EXPECT_THROW((void)stiffness_map(surface, contacts_of(bump, 1e-3)), InvalidInput);
  surface.triangles(0, 0) = -1;
  EXPECT_THROW((void)stiffness_map(surface, contacts_of(bump, 1e-3)), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
