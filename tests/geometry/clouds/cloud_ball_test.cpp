// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_ball.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/range_map_mesh.h"
#include "refusal.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kBallRadius = 15;  // [mm]
const Vector3d kCentre(12, -7, 620);

/// Distance to the ball along the unit ray [mm]; infinite if it misses.
double meets_ball(const Vector3d& ray, const Vector3d& centre, double radius) {
  const double along = ray.dot(centre);
  const double inside = along * along - centre.squaredNorm() + radius * radius;
  return inside > 0 ? along - std::sqrt(inside) : kInfinite;
}

/// The same for a rod of 6 mm radius from the ball to the right, as an arm that holds it.
double meets_rod(const Vector3d& ray) {
  const Vector3d axis = Vector3d(1, 0.3, 0.4).normalized();
  const Vector3d across = ray - axis.dot(ray) * axis;
  const Vector3d from = kCentre - axis.dot(kCentre) * axis;
  const double a = across.squaredNorm(), b = across.dot(from), c = from.squaredNorm() - 36;
  if (b * b < a * c) return kInfinite;
  const double t = (b - std::sqrt(b * b - a * c)) / a;
  return axis.dot(t * ray - kCentre) > 0 ? t : kInfinite;
}

/// Range map of a ball on a rod in front of a wavy background, with noise along the rays.
RangeMapMesh scene(double radius, double noise, unsigned seed, const Vector3d& centre = kCentre) {
  RangeMap map;
  map.camera.width = 160;
  map.camera.height = 120;
  map.camera.fx = map.camera.fy = 600;
  map.camera.cx = 80;
  map.camera.cy = 60;
  map.z.resize(120, 160);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const Vector3d ray = Vector3d((column - 80) / 600.0, (row - 60) / 600.0, 1).normalized();
      const double wall = (700 + 10 * std::sin(column / 30.0) * std::cos(row / 20.0)) / ray.z();
      const double way = std::min({wall, meets_rod(ray), meets_ball(ray, centre, radius)});
      map.z(row, column) = static_cast<float>(way * ray.z() + noise * normal(random));
    }
  }
  return mesh_range_map(map);
}

std::optional<SeenBall> found_in(const RangeMapMesh& seen, double radius) {
  return find_ball(seen.mesh.vertices, vertex_normals(seen.mesh), radius);
}

TEST(FindBall, IsExactInAnExactRangeMapWithABackgroundAndARod) {
  const auto ball = found_in(scene(kBallRadius, 0, 1), kBallRadius);
  ASSERT_TRUE(ball);
  // Depths are floats, rounded by up to 3e-5 mm.
  EXPECT_LT((ball->centre - kCentre).norm(), 1e-4);
  EXPECT_NEAR(ball->radius, kBallRadius, 1e-3);
  EXPECT_LT(ball->rms, 1e-4);
}

TEST(FindBall, ErrsByWhatItsInformationAndTheNoiseOfItsPointsSay) {
  constexpr double kNoise = 0.1;
  double squares = 0;
  constexpr int kSeeds = 12;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const auto ball = found_in(scene(kBallRadius, kNoise, seed), kBallRadius);
    ASSERT_TRUE(ball) << seed;
    const Vector3d error = ball->centre - kCentre;
    // Of three coordinates, in units of the covariance rms^2 / points * information^-1.
    squares += error.dot(ball->information * error) * ball->points / (ball->rms * ball->rms) / 3;
    EXPECT_LT(error.norm(), 0.05) << seed;
    EXPECT_NEAR(ball->radius, kBallRadius, 0.1);
  }
  const double ratio = std::sqrt(squares / kSeeds);
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.5);
}

TEST(FindBall, TellsTheRadiusThatFitsIfAnotherOneIsGiven) {
  const auto ball = found_in(scene(kBallRadius, 0.05, 1), 0.8 * kBallRadius);
  ASSERT_TRUE(ball);
  EXPECT_NEAR(ball->radius, kBallRadius, 0.1);
}

TEST(FindBall, FindsNoneWhereThereIsNone) {
  EXPECT_FALSE(found_in(scene(kBallRadius, 0.05, 1, {0, 0, 900}), kBallRadius));
  EXPECT_FALSE(find_ball(Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), kBallRadius));
}

TEST(FindBall, LeavesOutWhatIsNotFinite) {
  RangeMapMesh seen = scene(kBallRadius, 0, 1);
  Eigen::Matrix3Xd normals = vertex_normals(seen.mesh);
  const auto whole = find_ball(seen.mesh.vertices, normals, kBallRadius);
  for (Eigen::Index i = 0; i < normals.cols(); i += 7)
    (i % 2 == 0 ? normals : seen.mesh.vertices)(i % 3, i) = std::nan("");
  const auto some = find_ball(seen.mesh.vertices, normals, kBallRadius);
  ASSERT_TRUE(whole && some);
  EXPECT_LT(some->points, whole->points);
  EXPECT_LT((some->centre - whole->centre).norm(), 1e-4);
}

TEST(FindBall, RefusesWhatIsNoCloudOrNoRadius) {
  const Eigen::Matrix3Xd three = Eigen::Matrix3Xd::Zero(3, 3), two = Eigen::Matrix3Xd::Zero(3, 2);
  EXPECT_EQ(refusal([&] { (void)find_ball(three, two, 1); }),
            "find_ball: there are 2 normals for 3 points; each point needs one");
  EXPECT_EQ(refusal([&] { (void)find_ball(three, three, std::nan("")); }),
            "find_ball: radius is nan mm; it must be > 0 and finite");
}

}  // namespace
}  // namespace palpate::geometry
