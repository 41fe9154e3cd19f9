// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/registration.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/surface_query.h"
#include "refusal.h"
#include "registration/registration_testing.h"
#include "test_surfaces.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::bumpy_surface;
using test::kDegree;
using test::kFound;
using test::largest_distance;
using test::part_of_bumpy_surface;
using test::points_on;
using test::random_motion;

/// [mm] PCL's steps are in single precision, 6e-8 of the surface's size an operation.
constexpr double kFoundInFloat = 1e-3;

TEST(RegisterPoints, FindsARigidMotionAgain) {
  const TriangleMesh surface = bumpy_surface();
  const RegistrationTarget target(surface);
  unsigned seed = 0;
  for (const double angle : {0.0, 10 * kDegree, 25 * kDegree, 44 * kDegree}) {
    for (int trial = 0; trial < 4; ++trial) {
      const Matrix3Xd truth = points_on(surface, 400, ++seed);
      const Matrix3Xd moved = random_motion(angle, seed) * truth;
      const Registration found = register_points(moved, target);
      EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << seed << ": " << found.reason;
      EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFound) << seed;
      EXPECT_LT(found.rms, kFound);
      EXPECT_EQ(found.inliers, 400);
      EXPECT_EQ(found.overlap, 1);
    }
  }
}

TEST(RegisterPoints, OfContactsOnARangeMapIsRightFromThirtyDegreesAndSixtyMillimetres) {
  for (const double noise : {0.0, 0.25}) {
    const TriangleMesh map = test::bumpy(30000, noise);
    const RegistrationTarget target(map);
    const Vector3d middle(0, 0, 680);
    for (unsigned seed = 1; seed <= 10; ++seed) {
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> error(-noise, noise);
      Matrix3Xd truth = points_on(map, 100, seed);
      if (noise > 0) truth = truth.unaryExpr([&](double x) { return x + error(random); }).eval();
      std::normal_distribution<double> normal;
      const Vector3d axis{normal(random), normal(random), normal(random)};
      const Vector3d way{normal(random), normal(random), normal(random)};
      const Isometry3d off = Eigen::Translation3d(middle + 60 * way.normalized()) *
                             Eigen::AngleAxisd(30 * kDegree, axis.normalized()) *
                             Eigen::Translation3d(-middle);
      const Registration found = register_points(off * truth, target);
      EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
      EXPECT_LT((found.T_target_source * off * truth - truth).colwise().norm().mean(), 1) << seed;
    }
  }
}

/// Centres of balls that touch a surface from the side of its normals, at random places.
Matrix3Xd touching_balls(const TriangleMesh& surface, double radius, int count, unsigned seed) {
  const SurfaceQuery query(surface);
  const Matrix3Xd normals = vertex_normals(surface);
  Matrix3Xd centres(3, count);
  std::mt19937 random(seed);
  std::uniform_int_distribution<Eigen::Index> any(0, surface.vertices.cols() - 1);
  for (int i = 0; i < count;) {
    const Eigen::Index vertex = any(random);
    const Vector3d place = surface.vertices.col(vertex);
    // Inside the border, which a ball beside the surface would touch.
    if (place.x() < 8 || place.x() > 97 || place.y() < 8 || place.y() > 76) continue;
    // Along the normal to where the nearest point is at a distance of the radius.
    double low = 0, high = 3 * radius;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle = (low + high) / 2;
      const double distance = query.closest_point(place + middle * normals.col(vertex)).distance;
      (distance < radius ? low : high) = middle;
    }
    centres.col(i++) = place + low * normals.col(vertex);
  }
  return centres;
}

TEST(RegisterPoints, WithAStandoffPlacesBallsThatTouchTheSurface) {
  const TriangleMesh surface = bumpy_surface();
  constexpr double kRadius = 3;
  const RegistrationTarget target(surface, kRadius), bare(surface);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Matrix3Xd truth = touching_balls(surface, kRadius, 60, seed);
    const Matrix3Xd moved = random_motion(25 * kDegree, seed) * truth;
    const Registration found = register_points(moved, target);
    EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
    EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFound) << seed;
    EXPECT_LT(found.rms, kFound);
    EXPECT_GT(register_points(moved, bare).rms, 0.05);
  }
}

TEST(RegisterPoints, WithAStandoffDistinguishesTheSidesOfASurface) {
  TriangleMesh surface = bumpy_surface();
  const Matrix3Xd truth = touching_balls(surface, 3, 60, 1);
  surface.triangles.row(1).swap(surface.triangles.row(2));
  const Registration found = register_points(truth, RegistrationTarget(surface, 3));
  EXPECT_FALSE(found.verdict == RegistrationVerdict::accepted && found.rms < 0.3);
  EXPECT_EQ(refusal([&] { (void)RegistrationTarget(surface, -1); }),
            "RegistrationTarget: standoff is -1 mm; it must be >= 0 and finite");
}

TEST(RegisterPoints, WithPclsMethodsFindsTheMotionOntoVertices) {
  const TriangleMesh surface = bumpy_surface();
  const RegistrationTarget target(surface);
  const Matrix3Xd& truth = surface.vertices;
  const Matrix3Xd moved = random_motion(20 * kDegree, 5) * truth;
  for (const auto method :
       {RegistrationMethod::point_to_plane, RegistrationMethod::point_to_point}) {
    const Registration found = register_points(moved, target, {.method = method});
    EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
    EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFoundInFloat);
    EXPECT_GT(found.iterations, 0);
  }
}

TEST(RegisterPoints, TakesNoMoreStepsThanAllowed) {
  const TriangleMesh surface = test::bumpy(4000, 0.25);
  const RegistrationTarget target(surface);
  // A rough map and rough points, so that steps have to be halved: a try counts too.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Matrix3Xd moved = points_on(surface, 12, seed).colwise() + Vector3d(15, -10, 8);
    for (int i = 0; i < 12; ++i) moved(2, i) += i % 2 == 0 ? 4 : -4;
    for (int allowed = 1; allowed <= 20; ++allowed) {
      const Registration found = register_points(
          moved, target,
          {.search_rotation = 0, .search_translation = 0, .max_iterations = allowed});
      EXPECT_LE(found.iterations, allowed);
    }
  }
}

TEST(RegisterPoints, OfSourceAndTargetSwappedIsTheInverse) {
  const TriangleMesh a = bumpy_surface();
  const TriangleMesh b = test::moved(a, random_motion(12 * kDegree, 7));
  const Isometry3d T_b_a = register_points(a.vertices, b).T_target_source;
  const Isometry3d T_a_b = register_points(b.vertices, a).T_target_source;
  EXPECT_LT(largest_distance(T_b_a * a.vertices, b.vertices), kFound);
  EXPECT_LT(largest_distance(T_a_b * (T_b_a * a.vertices), a.vertices), kFound);
}

TEST(RegisterPoints, MovesAlongWithTheStart) {
  const TriangleMesh surface = bumpy_surface();
  const Matrix3Xd truth = points_on(surface, 200, 21);
  const Isometry3d start = random_motion(170 * kDegree, 22);
  const Matrix3Xd moved = start.inverse() * random_motion(20 * kDegree, 23) * truth;
  const Registration found = register_points(moved, surface, {.T_target_source_start = start});
  EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
  EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFound);
}

TEST(RegisterPoints, SearchesAllRotationsOnRequest) {
  const TriangleMesh surface = bumpy_surface();
  const Matrix3Xd truth = points_on(surface, 200, 24);
  const Matrix3Xd moved = random_motion(165 * kDegree, 25) * truth;
  const Registration found = register_points(moved, surface, {.search_rotation = std::numbers::pi});
  EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
  EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFound);
}

TEST(RegisterPoints, SearchesForThePlaceOfAPartOnRequest) {
  const TriangleMesh surface = bumpy_surface();
  Matrix3Xd truth = points_on(surface, 2000, 26);
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < truth.cols(); ++i) {
    if ((truth.col(i) - Vector3d(25, 25, 0)).norm() < 25) truth.col(count++) = truth.col(i).eval();
  }
  truth.conservativeResize(3, count);
  const Matrix3Xd moved = truth.colwise() + Vector3d(40, 20, -15);
  const Registration found =
      register_points(moved, surface, {.search_rotation = 10 * kDegree, .search_translation = 60});
  EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
  EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFound);
}

TEST(RegisterPoints, OfScansThatOverlapInPartPutsTheCommonPartInPlace) {
  const TriangleMesh left = part_of_bumpy_surface(0, 70);
  const Matrix3Xd truth =
      points_on(part_of_bumpy_surface(25, 105), 1500, 27);  // 56 % of it lie on the left
  const Isometry3d off = Eigen::Translation3d(3, -4, 5) * Eigen::AngleAxisd(0.1, Vector3d::UnitX());
  const Matrix3Xd moved = off * truth;
  const Registration found =
      register_points(moved, left, {.search_rotation = 0.2, .search_translation = 20});
  EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
  EXPECT_LT(largest_distance(found.T_target_source * moved, truth), kFound);
  EXPECT_NEAR(found.overlap, 0.58, 0.04);
}

TEST(RegisterPoints, AveragesNoise) {
  const TriangleMesh target = bumpy_surface();
  constexpr int kCount = 3000;
  constexpr double kNoise = 0.05;
  const Matrix3Xd truth = points_on(target, kCount, 8);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, kNoise);
  const Matrix3Xd noisy = truth.unaryExpr([&](double x) { return x + normal(random); });
  const Matrix3Xd moved = random_motion(10 * kDegree, 10) * noisy;
  const Registration found = register_points(moved, target);
  EXPECT_EQ(found.verdict, RegistrationVerdict::accepted) << found.reason;
  // Only the part of the noise along the normal is a distance.
  EXPECT_NEAR(found.rms, kNoise, 0.1 * kNoise);
  EXPECT_LT(largest_distance(found.T_target_source * moved, noisy), 0.5 * kNoise);
}

TEST(RegisterPoints, LeavesOutPointsThatAreNotFinite) {
  const TriangleMesh target = bumpy_surface();
  const Matrix3Xd moved = random_motion(10 * kDegree, 12) * points_on(target, 100, 13);
  Matrix3Xd with_gaps(3, 103);
  with_gaps << Vector3d(kNaN, 1, 2), moved.leftCols(50),
      Vector3d(1, std::numeric_limits<double>::infinity(), 2), moved.rightCols(50),
      Vector3d(kNaN, kNaN, kNaN);
  for (const auto method :
       {RegistrationMethod::point_to_triangle, RegistrationMethod::point_to_plane,
        RegistrationMethod::point_to_point}) {
    const Registration expected = register_points(moved, target, {.method = method});
    const Registration found = register_points(with_gaps, target, {.method = method});
    EXPECT_EQ(found.T_target_source.matrix(), expected.T_target_source.matrix());
    EXPECT_EQ(found.inliers, expected.inliers);
  }
}

TEST(RegisterPoints, ScalesExactlyWithTheUnitOfLength) {
  const TriangleMesh target = bumpy_surface();
  const Matrix3Xd moved = random_motion(10 * kDegree, 14) * points_on(target, 100, 15);
  for (const auto method :
       {RegistrationMethod::point_to_triangle, RegistrationMethod::point_to_plane,
        RegistrationMethod::point_to_point}) {
    const Registration expected = register_points(moved, target, {.method = method});
    for (const double factor : {0x1p-20, 0x1p20}) {
      const Registration scaled =
          register_points(factor * moved, test::scaled(target, factor), {.method = method});
      EXPECT_EQ(scaled.verdict, expected.verdict);
      EXPECT_EQ(scaled.T_target_source.linear(), expected.T_target_source.linear());
      EXPECT_EQ(scaled.T_target_source.translation(),
                factor * expected.T_target_source.translation());
      EXPECT_EQ(scaled.rms, factor * expected.rms);
      EXPECT_EQ(scaled.covariance(0, 0), expected.covariance(0, 0));
      EXPECT_EQ(scaled.covariance(1, 4), factor * expected.covariance(1, 4));
      EXPECT_EQ(scaled.covariance(5, 5), factor * factor * expected.covariance(5, 5));
    }
  }
}

TEST(RegisterPoints, DoesNotDependOnTheOrderOfPointsNorOnTheThreads) {
  const TriangleMesh target = bumpy_surface();
  Matrix3Xd moved = random_motion(15 * kDegree, 28) * points_on(target, 5000, 29);
  const Registration expected = register_points(moved, target);
  {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const Registration found = register_points(moved, target);
    EXPECT_EQ(found.T_target_source.matrix(), expected.T_target_source.matrix());
    EXPECT_EQ(found.covariance, expected.covariance);
    EXPECT_EQ(found.reason, expected.reason);
  }
  const Registration reversed = register_points(moved.rowwise().reverse(), target);
  EXPECT_EQ(reversed.verdict, expected.verdict);
  EXPECT_LT(largest_distance(reversed.T_target_source * moved, expected.T_target_source * moved),
            kFound);
}

TEST(RegisterPoints, WorksOneKilometreAway) {
  const Isometry3d far(Eigen::Translation3d(1e6, -0.7e6, 0.3e6));
  const TriangleMesh target = test::moved(bumpy_surface(), far);
  const Matrix3Xd truth = points_on(target, 200, 16);
  const Isometry3d motion = far * random_motion(15 * kDegree, 17) * far.inverse();
  const Matrix3Xd moved = motion * truth;
  EXPECT_LT(largest_distance(register_points(moved, target).T_target_source * moved, truth),
            kFound);
}

TEST(RegisterPoints, TellsItsProgress) {
  const TriangleMesh surface = test::bumpy(4000, 0.25);
  const RegistrationTarget target(surface);
  const Matrix3Xd points = points_on(surface, 50, 1).colwise() + Vector3d(5, -4, 3);
  for (const auto method :
       {RegistrationMethod::point_to_triangle, RegistrationMethod::point_to_plane}) {
    check_progress(
        [&](const auto& progress) {
          (void)register_points(points, target, {.method = method, .progress = progress});
        },
        7);
  }
}

// Whoever wants to end the work waits for a part of the points only.
TEST(RegisterPoints, TellsThatItIsRunningWithinEachPassOverManyPoints) {
  const TriangleMesh surface = bumpy_surface();
  const RegistrationTarget target(surface);
  constexpr int kCount = 100'000;
  const Matrix3Xd points = points_on(surface, kCount, 1).colwise() + Vector3d(0.2, -0.1, 0.3);
  for (const auto method :
       {RegistrationMethod::point_to_triangle, RegistrationMethod::point_to_point}) {
    int told = 0;
    const auto stop = [&](int, int) {
      if (++told == 3) throw told;
    };
    const RegistrationOptions options{.method = method,
                                      .search_rotation = 0,
                                      .search_translation = 0,
                                      .max_iterations = 1,
                                      .progress = stop};
    EXPECT_THROW((void)register_points(points, target, options), int);
    told = 4;
    (void)register_points(points, target, options);
    EXPECT_GT(told - 4, 2 * kCount / 20'000) << static_cast<int>(method);
  }
}

TEST(RegisterPoints, RefusesBadInputAndNamesIt) {
  const TriangleMesh target = bumpy_surface();
  Matrix3Xd points = points_on(target, 4, 20);
  const auto refused = [](const Matrix3Xd& these, const TriangleMesh& there,
                          const RegistrationOptions& options = {}) {
    return refusal([&] { return register_points(these, there, options); });
  };
  const auto names = [&](const RegistrationOptions& options, const char* name) {
    return refused(points, target, options).find(name) != std::string::npos;
  };
  EXPECT_NO_THROW((void)register_points(points, target));
  EXPECT_NE(refused(points, {}).find("the target"), std::string::npos);
  EXPECT_TRUE(names({.max_iterations = 0}, "max_iterations"));
  for (const double bad : {-1.0, kNaN}) {
    EXPECT_TRUE(names({.search_rotation = bad}, "search_rotation"));
    EXPECT_TRUE(names({.search_translation = bad}, "search_translation"));
    EXPECT_TRUE(names({.min_overlap = bad}, "min_overlap"));
    EXPECT_TRUE(names({.max_rms = bad}, "max_rms"));
  }
  EXPECT_TRUE(names({.search_rotation = 3.2}, "search_rotation"));
  EXPECT_TRUE(names({.min_overlap = 1.1}, "min_overlap"));
  EXPECT_TRUE(names({.min_overlap = 0}, "min_overlap"));
  EXPECT_TRUE(names({.max_rms = 0}, "max_rms"));
  Isometry3d mirror = Isometry3d::Identity();
  mirror.linear()(2, 2) = -1;
  EXPECT_TRUE(names({.T_target_source_start = mirror}, "T_target_source_start"));
  points.rightCols(2).setConstant(kNaN);
  EXPECT_NE(refused(points, target).find("2 of the 4 points are finite"), std::string::npos);
  TriangleMesh no_area = test::flat_sheet(1, 1, 1);
  no_area.vertices.setZero();
  EXPECT_NE(refused(points_on(target, 4, 20), no_area).find("no triangle has an area"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
