// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The verdict of a registration: the poses that it accepts, and especially those that it does not.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "mesh_corpus.h"
#include "palpate/geometry/registration.h"
#include "registration/registration_testing.h"

namespace palpate::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::bumpy_surface;
using test::kDegree;
using test::kFound;
using test::largest_distance;
using test::points_on;
using test::random_motion;
using enum RegistrationVerdict;

TEST(RegistrationVerdict, SlidesOnAPlateWhichThePointsMeetWithoutBeingMovedAlongIt) {
  const TriangleMesh plate = test::flat_sheet(10, 10, 10.3);
  const Matrix3Xd truth = points_on(plate, 100, 11);
  const Isometry3d tilt =
      Eigen::Translation3d(0, 0, 4.2) * Eigen::AngleAxisd(0.05, Vector3d(0.6, 0.8, 0));
  const Registration found = register_points(tilt * truth, plate);
  EXPECT_EQ(found.verdict, slides) << found.reason;
  EXPECT_LT(found.rms, kFound);
  EXPECT_LT(largest_distance(found.T_target_source * (tilt * truth), truth), 2);
  ASSERT_EQ(found.free_motions.size(), 3u);  // two shifts and a turn, within the plate
  for (const FreeMotion& motion : found.free_motions) {
    EXPECT_LT(std::abs(motion.translation.z()), 1e-3);
    EXPECT_LT(motion.rotation.head<2>().norm(), 1e-4);
    EXPECT_NE(found.reason.find(motion.description), std::string::npos);
  }
  // Free motions are as uncertain as the plate is large; the rest is known exactly.
  const double diagonal = bounding_diagonal(plate);
  EXPECT_NEAR(std::sqrt(found.covariance(3, 3)), diagonal, 0.01 * diagonal);
  EXPECT_NEAR(std::sqrt(found.covariance(4, 4)), diagonal, 0.01 * diagonal);
  EXPECT_LT(std::sqrt(found.covariance(5, 5)), kFound);
}

TEST(RegistrationVerdict, SlidesOnANoisyPlate) {
  TriangleMesh plate = test::flat_sheet(60, 60, 2.3);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  for (double& z : plate.vertices.row(2)) z = noise(random);
  const Registration found = register_points(points_on(plate, 300, 3), plate);
  EXPECT_EQ(found.verdict, slides) << found.reason;
  EXPECT_EQ(found.free_motions.size(), 3u);
}

TEST(RegistrationVerdict, SlidesOnASphere) {
  const TriangleMesh sphere = test::icosphere(4, 50);
  const Matrix3Xd shifted = sphere.vertices.colwise() + Vector3d(2, -1, 3);
  const Registration found = register_points(shifted, sphere);
  EXPECT_EQ(found.verdict, slides) << found.reason;
  EXPECT_EQ(found.free_motions.size(), 3u);  // turns about the middle
  for (const FreeMotion& motion : found.free_motions) {
    EXPECT_LT(motion.translation.norm(), 0.1 * 50 * motion.rotation.norm());
  }
}

TEST(RegistrationVerdict, SlidesOnACylinderAlongAndAboutItsAxis) {
  const TriangleMesh flat = test::height_field(120, 60, 1, [](double, double) { return 0; });
  TriangleMesh cylinder = flat;
  for (auto p : cylinder.vertices.colwise()) {
    p = Vector3d(30 * std::cos(p.x() / 30), p.y(), 30 * std::sin(p.x() / 30)).eval();
  }
  const Registration found = register_points(points_on(cylinder, 300, 4), cylinder);
  EXPECT_EQ(found.verdict, slides) << found.reason;
  EXPECT_EQ(found.free_motions.size(), 2u);
}

TEST(RegistrationVerdict, IsAmbiguousWhereAnotherPoseFitsAsWell) {
  // Waves of 40 mm across and a slope along: every crest looks like the next one.
  const TriangleMesh waves = test::height_field(100, 60, 2, [](double x, double y) {
    return 6 * std::sin(std::numbers::pi * x / 20) * std::cos(y / 11);
  });
  Matrix3Xd points = points_on(waves, 3000, 5);
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (points(0, i) > 60 && points(0, i) < 140) points.col(count++) = points.col(i).eval();
  }
  points.conservativeResize(3, count);
  const Registration found =
      register_points(points, waves, {.search_rotation = 0.1, .search_translation = 60});
  EXPECT_EQ(found.verdict, ambiguous) << found.reason;
  EXPECT_LT(found.runner_up.value(), 0.1);
  // A search near a known start gets an answer.
  const Registration near =
      register_points(points, waves, {.search_rotation = 0.1, .search_translation = 5});
  EXPECT_EQ(near.verdict, accepted) << near.reason;
}

/// Points that do not belong to the target, or are too far off to be found.
TEST(RegistrationVerdict, AcceptsNoWrongPose) {
  const TriangleMesh map = test::bumpy(30000, 0.25);
  const RegistrationTarget target(map);
  const TriangleMesh other = test::height_field(100, 80, 5.5, [](double x, double y) {
    return 690 + 20 * std::sin(x / 60) * std::cos(y / 45) + 6 * std::sin(x / 17 + y / 23);
  });
  int seen = 0;
  for (const int count : {12, 20, 40, 100}) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
      const Registration strange =
          register_points(points_on(other, count, seed).colwise() - Vector3d(270, 220, 0), target);
      EXPECT_NE(strange.verdict, accepted) << count << " " << seed << ": " << strange.reason;
      Matrix3Xd mirrored = points_on(map, count, seed);
      mirrored.row(0) *= -1;
      EXPECT_NE(register_points(mirrored, target).verdict, accepted) << count << " " << seed;
      // Rotated by more than is searched: found by chance, or not accepted.
      const Matrix3Xd truth = points_on(map, count, 100 + seed);
      const Isometry3d off = Eigen::Translation3d(50, -60, 690) *
                             Eigen::AngleAxisd(75 * kDegree, Vector3d(seed, 2, -3).normalized()) *
                             Eigen::Translation3d(0, 0, -690);
      const Registration far = register_points(off * truth, target);
      if (far.verdict != accepted) continue;
      ++seen;
      EXPECT_LT((far.T_target_source * off * truth - truth).colwise().norm().mean(), 1)
          << count << " " << seed << ": " << far.reason;
    }
  }
  EXPECT_GT(seen, 0);
}

TEST(RegistrationVerdict, AcceptsThePoseDespiteOutliersAndCountsThem) {
  const TriangleMesh surface = bumpy_surface();
  const RegistrationTarget target(surface);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Matrix3Xd truth = points_on(surface, 100, seed);
    Matrix3Xd wrong = truth;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(3, 10);
    for (int i = 0; i < 20; ++i) wrong(2, 5 * i) += uniform(random);
    const Isometry3d off = random_motion(25 * kDegree, seed);
    const Registration found = register_points(off * wrong, target);
    EXPECT_EQ(found.verdict, accepted) << found.reason;
    EXPECT_LT(largest_distance(found.T_target_source * off * truth, truth), kFound);
    EXPECT_EQ(found.inliers, 80);
    EXPECT_EQ(found.overlap, 0.8);
    EXPECT_LT(found.rms, kFound);
    const Registration strict = register_points(off * wrong, target, {.min_overlap = 0.9});
    EXPECT_NE(strict.verdict, accepted) << strict.reason;
  }
}

TEST(RegistrationVerdict, NamesTooFewPointsAndTooLargeDistances) {
  const TriangleMesh surface = bumpy_surface();
  const Matrix3Xd points = points_on(surface, 200, 6);
  EXPECT_EQ(register_points(points.leftCols(3), surface).verdict, too_few_points);
  EXPECT_EQ(register_points(points.leftCols(15), surface).verdict, too_few_points);
  Matrix3Xd rough = points;
  for (int i = 0; i < 200; ++i) rough(2, i) += i % 2 == 0 ? 0.3 : -0.3;
  EXPECT_EQ(register_points(rough, surface).verdict, accepted);
  const Registration strict = register_points(rough, surface, {.max_rms = 0.1});
  EXPECT_EQ(strict.verdict, poor_fit);
  EXPECT_NE(strict.reason.find("at most 0.1 mm"), std::string::npos) << strict.reason;
}

TEST(RegistrationVerdict, NamesStepsThatHadToEnd) {
  const TriangleMesh surface = bumpy_surface();
  const Matrix3Xd moved = random_motion(10 * kDegree, 19) * points_on(surface, 100, 18);
  const RegistrationOptions hasty{
      .search_rotation = 0, .search_translation = 0, .max_iterations = 1};
  EXPECT_EQ(register_points(moved, surface, hasty).verdict, not_converged);
}

TEST(RegistrationVerdict, DoesNotAcceptScansOfDifferentParts) {
  const TriangleMesh left = test::part_of_bumpy_surface(0, 45);
  const Matrix3Xd right = points_on(test::part_of_bumpy_surface(55, 105), 300, 7);
  for (const double reach : {5.0, 20.0, std::numeric_limits<double>::infinity()}) {
    const Registration found =
        register_points(right, left, {.search_rotation = 0.2, .search_translation = reach});
    EXPECT_NE(found.verdict, accepted) << reach << ": " << found.reason;
  }
}

// A room of which the target is a small object: however large the distances are, half of the points
// are within three deviations of them.
TEST(RegistrationVerdict, NamesLittleOverlapOfPointsAllAroundTheTarget) {
  const TriangleMesh object = bumpy_surface();
  const RegistrationTarget target(object);
  for (const unsigned seed : {1U, 2U, 3U}) {
    Matrix3Xd room = points_on(test::icosphere(3, 600), 3000, seed).colwise() + Vector3d(52, 42, 0);
    room.leftCols(300) = points_on(object, 300, seed);
    const Registration found = register_points(room, target);
    EXPECT_EQ(found.verdict, little_overlap) << seed << ": " << found.reason;
    EXPECT_LT(found.overlap, 0.5);
    EXPECT_EQ(found.inliers, std::lround(3000 * found.overlap));
    EXPECT_NE(found.reason.find("of the points lie within"), std::string::npos) << found.reason;
  }
}

/// Points of the bumpy surface from x = `from` mm on, with the noise of a scan.
Matrix3Xd scanned_from(double from, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.05);
  const Matrix3Xd points = points_on(test::part_of_bumpy_surface(from, 105), count, seed);
  return points.unaryExpr([&](double x) { return x + noise(random); });
}

TEST(RegistrationVerdict, AcceptsTheRightPoseOfScansThatOverlapByLessThanHalf) {
  const RegistrationTarget left(test::part_of_bumpy_surface(0, 70));
  for (const auto& [overlap, from] : {std::pair(0.3, 55), {0.4, 47}, {0.47, 39}}) {
    for (unsigned seed = 1; seed <= 2; ++seed) {
      const Matrix3Xd truth = scanned_from(from, 1000, seed);
      const Vector3d middle = truth.rowwise().mean();
      const Isometry3d off = Eigen::Translation3d(middle + Vector3d(5, -4, 4)) *
                             Eigen::AngleAxisd(8 * kDegree, Vector3d(seed, 2, -3).normalized()) *
                             Eigen::Translation3d(-middle);
      const Registration found = register_points(
          off * truth, left,
          {.search_rotation = 0.3, .search_translation = 10, .min_overlap = 0.8 * overlap});
      EXPECT_EQ(found.verdict, accepted) << overlap << " " << seed << ": " << found.reason;
      EXPECT_LT(largest_distance(found.T_target_source * off * truth, truth), 1) << overlap;
      EXPECT_NEAR(found.overlap, overlap, 0.06);
      EXPECT_LT(found.median, 0.2);
    }
  }
}

TEST(RegistrationVerdict, AcceptsNoWrongPoseWhereALittleOverlapIsEnough) {
  const TriangleMesh surface = bumpy_surface(), plate = test::flat_sheet(30, 24, 3.5);
  const TriangleMesh sphere = test::icosphere(3, 50), range_map = test::bumpy(4000, 0.25);
  const RegistrationTarget on_surface(surface), on_plate(plate), on_sphere(sphere);
  const RegistrationTarget on_left(test::part_of_bumpy_surface(0, 45));
  const Vector3d middle = surface.vertices.rowwise().mean();
  for (const double min_overlap : {0.4, 0.24}) {
    const RegistrationOptions options{.search_rotation = 0.2, .min_overlap = min_overlap};
    RegistrationOptions near = options;
    near.search_translation = 10;
    for (const unsigned seed : {1U, 2U}) {
      const auto at_middle = [&](const TriangleMesh& object) {
        const Matrix3Xd points = points_on(object, 200, seed);
        return Matrix3Xd(points.colwise() + (middle - points.rowwise().mean()));
      };
      for (const Registration& found :
           {register_points(at_middle(range_map), on_surface, options),
            register_points(at_middle(sphere), on_surface, options),
            register_points(points_on(plate, 200, seed), on_plate, near),
            register_points(points_on(sphere, 200, seed), on_sphere, near),
            register_points(scanned_from(55, 200, seed), on_left, near)}) {
        EXPECT_NE(found.verdict, accepted) << min_overlap << " " << seed << ": " << found.reason;
      }
    }
  }
}

/// A torus with bumps, which turned by a thirteenth of a turn differs by 1.2 mm at most.
TriangleMesh nearly_symmetric_torus() {
  constexpr double kRadius = 80;
  TriangleMesh torus = test::torus(130, 24, kRadius, 30);
  for (auto p : torus.vertices.colwise()) {
    const double angle = std::atan2(p.y(), p.x());
    const Vector3d middle = kRadius * Vector3d(std::cos(angle), std::sin(angle), 0);
    p = middle + (1 + 0.1 * std::cos(13 * angle) + 0.02 * std::cos(angle + 0.5)) * (p - middle);
  }
  return torus;
}

TEST(RegistrationVerdict, KnowsWhatWasNotSearchedIfThePointsStartFartherOffThanTold) {
  const TriangleMesh torus = nearly_symmetric_torus();
  const RegistrationTarget target(torus);
  int wrong = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Matrix3Xd truth = points_on(torus, 500, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const Vector3d axis{normal(random), normal(random), normal(random)};
    const Vector3d way{normal(random), normal(random), normal(random)};
    const Isometry3d off = Eigen::Translation3d(60 * way.normalized()) *
                           Eigen::AngleAxisd(30 * kDegree, axis.normalized());
    const Registration found =
        register_points(off * truth, target, {.search_rotation = 0, .search_translation = 0});
    const bool is_right = (found.T_target_source * off * truth - truth).colwise().norm().mean() < 1;
    EXPECT_TRUE(is_right || found.verdict != accepted) << seed << ": " << found.reason;
    wrong += is_right ? 0 : 1;
    // Near the start there is no other pose, and nothing has to be searched.
    const Isometry3d near =
        Eigen::Translation3d(1, -2, 1) * Eigen::AngleAxisd(2 * kDegree, axis.normalized());
    EXPECT_EQ(register_points(near * truth, target, {.search_rotation = 0, .search_translation = 0})
                  .verdict,
              accepted);
  }
  EXPECT_GT(wrong, 0);
}

// A start that is rotated by about one tooth moves little to the wrong tooth.
TEST(RegistrationVerdict, DoubtsAWrongPoseNearAStartThatWasFartherOffThanTold) {
  const TriangleMesh torus = nearly_symmetric_torus();
  const RegistrationTarget target(torus);
  int wrong = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Matrix3Xd truth = points_on(torus, 500, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const Vector3d axis{normal(random) / 3, normal(random) / 3, 1};
    const Vector3d way{normal(random), normal(random), normal(random)};
    const Isometry3d off = Eigen::Translation3d(9 * way.normalized()) *
                           Eigen::AngleAxisd(30 * kDegree, axis.normalized());
    const Registration found =
        register_points(off * truth, target, {.search_rotation = 0, .search_translation = 0});
    const bool is_right = (found.T_target_source * off * truth - truth).colwise().norm().mean() < 1;
    EXPECT_TRUE(is_right || found.verdict != accepted) << seed << ": " << found.reason;
    wrong += is_right ? 0 : 1;
  }
  EXPECT_GT(wrong, 0);
}

/// The covariance predicts the scatter of the poses of many noisy scans.
TEST(RegistrationVerdict, ForetellsTheScatterOfThePose) {
  const TriangleMesh surface = bumpy_surface();
  const RegistrationTarget target(surface);
  constexpr int kTrials = 60;
  Eigen::Matrix<double, 6, kTrials> errors;
  Eigen::Matrix<double, 6, 6> foretold = Eigen::Matrix<double, 6, 6>::Zero();
  const Matrix3Xd truth = points_on(surface, 300, 8);
  const Vector3d centre = truth.rowwise().mean();
  for (int trial = 0; trial < kTrials; ++trial) {
    std::mt19937 random(static_cast<unsigned>(trial));
    std::normal_distribution<double> noise(0, 0.05);
    const Matrix3Xd noisy = truth.unaryExpr([&](double x) { return x + noise(random); });
    const Registration found =
        register_points(noisy, target, {.search_rotation = 0, .search_translation = 0});
    const Eigen::AngleAxisd turn(found.T_target_source.linear());
    errors.col(trial) << turn.angle() * turn.axis(), found.T_target_source * centre - centre;
    foretold += found.covariance / kTrials;
  }
  const Eigen::Matrix<double, 6, 6> seen = errors * errors.transpose() / kTrials;
  for (int k = 0; k < 6; ++k) {
    // A standard deviation from 60 trials is off by 9 % (one sigma); biweights cost 2 % more.
    EXPECT_NEAR(std::sqrt(seen(k, k) / foretold(k, k)), 1, 0.35) << k;
  }
}

}  // namespace
}  // namespace palpate::geometry
