// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/touch_placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "palpate/geometry/surface_query.h"
#include "placement_testing.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::probing {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using geometry::TriangleMesh;
using test::error_of;
using test::kTurnDegree;
using test::PoseError;
using test::stand;
using ::testing::HasSubstr;

constexpr double kTip = 3;               // [mm]
constexpr double kTouchNoise = 0.03;     // [mm] of a touch along its approach, as the virtual arm's
constexpr double kAlongSurface = 0.014;  // [mm] of a coordinate, along the surface

/// 110 mm x 90 mm with hills, seen from above.
TriangleMesh hilly(double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  TriangleMesh mesh = geometry::test::height_field(74, 60, 1.5, [&](double x, double y) {
    return 8 * std::sin(x / 15.3) * std::cos(y / 12.1) + 4 * std::sin(x / 7.7 + y / 9.1) +
           0.002 * (x - 50) * (y - 40) + noise * normal(random);
  });
  // The camera looks along z.
  const Isometry3d before_camera =
      Eigen::Translation3d(-50, 40, 700) * Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX());
  mesh.vertices = before_camera * mesh.vertices;
  return mesh;
}

/// Centres of a tip that touches the surface from the camera's side, far from its border.
Matrix3Xd touches_of(const TriangleMesh& surface, int count, unsigned seed, double noise) {
  const geometry::SurfaceQuery query(surface);
  const Matrix3Xd normals = vertex_normals(surface);
  const Eigen::AlignedBox3d box(surface.vertices.rowwise().minCoeff(),
                                surface.vertices.rowwise().maxCoeff());
  std::mt19937 random(seed);
  std::uniform_int_distribution<Eigen::Index> any(0, surface.vertices.cols() - 1);
  std::normal_distribution<double> normal(0, 1);
  Matrix3Xd tips(3, count);
  for (int i = 0; i < count;) {
    const Eigen::Index vertex = any(random);
    const Vector3d place = surface.vertices.col(vertex);
    const double border = 8;  // [mm]
    if ((place - box.min()).head<2>().minCoeff() < border ||
        (box.max() - place).head<2>().minCoeff() < border)
      continue;
    double low = 0, high = 3 * kTip;
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = (low + high) / 2;
      const double distance = query.closest_point(place + middle * normals.col(vertex)).distance;
      (distance < kTip ? low : high) = middle;
    }
    const Vector3d error{normal(random), normal(random), normal(random)};
    tips.col(i++) = place + (low + noise * kTouchNoise * normal(random)) * normals.col(vertex) +
                    noise * kAlongSurface * error;
  }
  return tips;
}

Isometry3d rough_pose(const Isometry3d& pose) {
  return Eigen::Translation3d(700 * Vector3d::UnitZ()) *
         Eigen::AngleAxisd(10 * kTurnDegree, Vector3d(1, -2, 1).normalized()) *
         Eigen::Translation3d(Vector3d(8, -6, 10) - 700 * Vector3d::UnitZ()) * pose;
}

TEST(PlaceByTouches, IsExactForExactTouchesFromARoughPoseAndFromNone) {
  const TriangleMesh surface = hilly(0, 1);
  const Matrix3Xd tips = stand().inverse() * touches_of(surface, 40, 1, 0);
  for (const bool has_start : {true, false}) {
    TouchPlacementOptions options{.tip_radius = kTip};
    if (has_start) options.T_camera_base_start = rough_pose(stand());
    const ArmPlacement found = place_by_touches(tips, surface, options);
    ASSERT_TRUE(found.determined) << found.reason;
    EXPECT_LT(error_of(found).shift.norm(), 1e-6);
    EXPECT_LT(error_of(found).turn.norm(), 1e-7);
    EXPECT_EQ(found.used, 40);
    EXPECT_THAT(found.doubts, ::testing::IsEmpty());
  }
}

// The goal: 0.1 mm and 0.05 degrees, with errors as stated.
TEST(PlaceByTouches, ErrsByWhatItStates) {
  constexpr int kSeeds = 16;
  const TriangleMesh truth = hilly(0, 1);
  double squares = 0, largest_shift = 0, largest_turn = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const TriangleMesh surface = hilly(0.02, seed);
    const Matrix3Xd tips = stand().inverse() * touches_of(truth, 40, seed, 1);
    const ArmPlacement found = place_by_touches(
        tips, surface, {.T_camera_base_start = rough_pose(stand()), .tip_radius = kTip});
    ASSERT_TRUE(found.determined) << seed << found.reason;
    const PoseError error = error_of(found);
    squares += test::squared_ratio(found);
    largest_shift = std::max(largest_shift, error.shift.norm());
    largest_turn = std::max(largest_turn, error.turn.norm());
  }
  const double ratio = std::sqrt(squares / kSeeds);
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.5);
  EXPECT_LT(largest_shift, 0.1);
  EXPECT_LT(largest_turn, 0.1 * kTurnDegree);
  RecordProperty("ratio", std::to_string(ratio));
  RecordProperty("largest_shift", std::to_string(largest_shift));
  RecordProperty("largest_turn_deg", std::to_string(largest_turn / kTurnDegree));
}

TEST(PlaceByTouches, NamesTouchesThatAreOffTheSurface) {
  const TriangleMesh surface = hilly(0, 1);
  Matrix3Xd tips = touches_of(surface, 40, 2, 1);
  tips(2, 7) -= 1;     // too early
  tips(2, 31) += 0.6;  // too late
  const ArmPlacement found =
      place_by_touches(stand().inverse() * tips, surface,
                       {.T_camera_base_start = rough_pose(stand()), .tip_radius = kTip});
  ASSERT_TRUE(found.determined) << found.reason;
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(found.residuals[i].used, i != 7 && i != 31) << i;
  EXPECT_GT(found.residuals[7].distance, 0.5);
  EXPECT_LT(found.residuals[31].distance, -0.3);
  EXPECT_LT(error_of(found).shift.norm(), 0.1);
}

TEST(PlaceByTouches, LeavesOutTouchesAtTheBorderAndNeedsSixteenOthers) {
  const TriangleMesh whole = hilly(0, 1);
  TriangleMesh half = whole;
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < whole.triangles.cols(); ++t)
    if (whole.vertices(0, whole.triangles(0, t)) < 0)
      half.triangles.col(count++) = whole.triangles.col(t);
  half.triangles.conservativeResize(3, count);
  const Matrix3Xd tips = touches_of(whole, 80, 5, 1);
  std::vector<Eigen::Index> inside;
  for (Eigen::Index i = 0; i < tips.cols(); ++i)
    if (tips(0, i) < -5) inside.push_back(i);
  ASSERT_GE(inside.size(), 25U);
  Matrix3Xd some(3, 28);
  // Three are beyond the border, near enough that their distances are like those of the others.
  for (Eigen::Index i = 0; i < 25; ++i) some.col(i) = tips.col(inside[static_cast<std::size_t>(i)]);
  const geometry::SurfaceQuery query(half);
  for (Eigen::Index i = 25; i < 28; ++i) {
    const double y = static_cast<double>(i - 25) * 6 - 8;
    const Vector3d start = query.closest_point({0, y, 700}).position + Vector3d(50, 0, 0);
    const Vector3d foot = query.closest_point(start).position;
    some.col(i) = foot + kTip * (start - foot).normalized();
  }
  const TouchPlacementOptions options{.T_camera_base_start = rough_pose(stand()),
                                      .tip_radius = kTip};
  const ArmPlacement found = place_by_touches(stand().inverse() * some, half, options);
  EXPECT_TRUE(found.determined) << found.reason;
  EXPECT_EQ(found.used, 25);
  for (std::size_t i = 0; i < 28; ++i) EXPECT_EQ(found.residuals[i].at_border, i >= 25) << i;
  const ArmPlacement fewer =
      place_by_touches(stand().inverse() * some.rightCols(17), half, options);
  EXPECT_FALSE(fewer.determined);
  EXPECT_THAT(fewer.reason, HasSubstr("16"));
}

TEST(PlaceByTouches, SaysWhichMotionsAPlateAndABallLeaveFree) {
  const TouchPlacementOptions near{.T_camera_base_start = Isometry3d::Identity(),
                                   .tip_radius = kTip};
  TriangleMesh plate = geometry::test::flat_sheet(40, 30, 3);
  plate.vertices.row(2).setConstant(700);
  plate.triangles.row(1).swap(plate.triangles.row(2));
  const ArmPlacement on_plate = place_by_touches(touches_of(plate, 30, 1, 1), plate, near);
  EXPECT_FALSE(on_plate.determined);
  EXPECT_THAT(on_plate.reason, HasSubstr("the surface does not fix"));
  EXPECT_THAT(on_plate.reason, HasSubstr("a shift along"));
  EXPECT_THAT(on_plate.reason, HasSubstr("no other touch of this surface would help"));
  EXPECT_FALSE(on_plate.advice);

  TriangleMesh ball = geometry::test::icosphere(4, 40);
  ball.vertices.colwise() += Vector3d(0, 0, 700);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  Matrix3Xd tips(3, 40);
  for (auto tip : tips.colwise())
    tip = Vector3d(0, 0, 700) +
          (40 + kTip + kTouchNoise * normal(random)) *
              Vector3d{normal(random), normal(random), normal(random)}.normalized();
  const ArmPlacement on_ball = place_by_touches(tips, ball, near);
  EXPECT_FALSE(on_ball.determined);
  EXPECT_THAT(on_ball.reason, HasSubstr("a turn about"));
}

TEST(PlaceByTouches, AdvisesATouchThatReducesTheWeakestDirection) {
  // A plate with a step at one side that no touch has reached yet.
  TriangleMesh surface = geometry::test::height_field(60, 40, 2, [](double x, double y) {
    return 3 * std::sin(y / 11) + 2 * std::sin(x / 19 + y / 17) +
           (x > 90 ? 8 * std::sin((x - 90) / 5) : 0);
  });
  const Isometry3d before_camera =
      Eigen::Translation3d(-60, 40, 700) * Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX());
  surface.vertices = before_camera * surface.vertices;
  Matrix3Xd tips = touches_of(surface, 60, 3, 1);
  std::vector<Eigen::Index> left;
  for (Eigen::Index i = 0; i < tips.cols(); ++i)
    if (tips(0, i) < 25) left.push_back(i);
  const Matrix3Xd some = tips(Eigen::all, left);
  const TouchPlacementOptions options{.T_camera_base_start = rough_pose(stand()),
                                      .tip_radius = kTip};
  const ArmPlacement before = place_by_touches(stand().inverse() * some, surface, options);
  ASSERT_TRUE(before.determined) << before.reason;
  ASSERT_TRUE(before.advice);
  EXPECT_LT(before.advice->after, 0.9 * before.advice->before);
  EXPECT_LT((before.T_camera_base * before.advice->tip_base - before.advice->tip_camera).norm(),
            1e-9);
  // On the unknown side.
  EXPECT_GT(before.advice->tip_camera.x(), 25);
  Matrix3Xd more(3, some.cols() + 1);
  more << some, before.advice->tip_camera;
  const ArmPlacement after = place_by_touches(stand().inverse() * more, surface, options);
  ASSERT_TRUE(after.determined && after.advice);
  EXPECT_LT(after.advice->before, before.advice->before);
}

std::string reason_of(const Matrix3Xd& tips, const TriangleMesh& surface,
                      const TouchPlacementOptions& options) {
  const ArmPlacement found = place_by_touches(tips, surface, options);
  EXPECT_FALSE(found.determined);
  return found.reason;
}

TEST(PlaceByTouches, SaysWhatIsWrongWithPositionsThatCannotFit) {
  const TriangleMesh surface = hilly(0, 1);
  const Matrix3Xd tips = stand().inverse() * touches_of(surface, 40, 4, 1);
  const TouchPlacementOptions anywhere{.tip_radius = kTip};
  EXPECT_THAT(reason_of(tips / 1000, surface, anywhere), HasSubstr("in metres"));
  EXPECT_THAT(reason_of(tips / 25.4, surface, anywhere), HasSubstr("in inches"));
  Matrix3Xd left_handed = tips;
  left_handed.row(1) *= -1;
  EXPECT_THAT(reason_of(left_handed, surface, anywhere), HasSubstr("left-handed"));
  EXPECT_THAT(reason_of(tips.leftCols(2), surface, anywhere), HasSubstr("2 touches"));
  EXPECT_THAT(reason_of(tips.leftCols(10), surface, anywhere), HasSubstr("it takes 16"));
}

TEST(PlaceByTouches, SaysWhatIsWrongWithAStartOrASurface) {
  const TriangleMesh surface = hilly(0, 1);
  const Matrix3Xd tips = stand().inverse() * touches_of(surface, 40, 4, 1);
  const TouchPlacementOptions anywhere{.tip_radius = kTip};
  TouchPlacementOptions swapped = anywhere;
  swapped.T_camera_base_start = stand().inverse();
  EXPECT_THAT(reason_of(tips, surface, swapped), HasSubstr("the inverse of the start pose"));
  TouchPlacementOptions far = anywhere;
  far.T_camera_base_start = Eigen::Translation3d(90, 0, 60) * stand();
  EXPECT_THAT(reason_of(tips, surface, far), HasSubstr("farther from the start pose"));
  TriangleMesh inside_out = surface;
  inside_out.triangles.row(1).swap(inside_out.triangles.row(2));
  EXPECT_THAT(reason_of(tips, inside_out, anywhere), HasSubstr("the other side of the surface"));
}

TEST(PlaceByTouches, DoubtsARadiusAndAFrameThatDoNotSuitTheTouches) {
  TriangleMesh block = geometry::test::icosphere(4, 40);
  // Without a symmetry, and touched all around.
  for (auto vertex : block.vertices.colwise())
    vertex = (1 + 0.15 * std::sin(vertex.x() / 11 + 1) + 0.1 * std::cos(vertex.y() / 8)) * vertex +
             Vector3d(0, 0, 700);
  const Matrix3Xd tips = [&] {
    const geometry::SurfaceQuery query(block);
    const Matrix3Xd normals = vertex_normals(block);
    Matrix3Xd centres(3, 60);
    for (Eigen::Index i = 0; i < 60; ++i) {
      const Vector3d place = block.vertices.col(20 * i);
      double low = 0, high = 9;
      for (int halving = 0; halving < 50; ++halving) {
        const double middle = (low + high) / 2;
        (query.closest_point(place + middle * normals.col(20 * i)).distance < kTip ? low : high) =
            middle;
      }
      centres.col(i) = place + low * normals.col(20 * i);
    }
    return centres;
  }();
  const ArmPlacement smaller =
      place_by_touches(stand().inverse() * tips, block,
                       {.T_camera_base_start = rough_pose(stand()), .tip_radius = kTip - 0.5});
  ASSERT_TRUE(smaller.determined) << smaller.reason;
  ASSERT_EQ(smaller.doubts.size(), 1U);
  EXPECT_THAT(smaller.doubts.front(), HasSubstr("better than one of 2.50 mm"));
  EXPECT_THAT(smaller.doubts.front(), HasSubstr("a radius of 3.0"));
  const ArmPlacement same = place_by_touches(
      tips, block, {.T_camera_base_start = Isometry3d::Identity(), .tip_radius = kTip});
  ASSERT_EQ(same.doubts.size(), 1U);
  EXPECT_THAT(same.doubts.front(), HasSubstr("already in the frame of the camera"));
}

TEST(PlaceByTouches, RefusesNumbersThatAreNone) {
  const TriangleMesh surface = hilly(0, 1);
  Matrix3Xd tips = touches_of(surface, 20, 1, 1);
  EXPECT_EQ(refusal([&] { (void)place_by_touches(tips, surface, {.tip_radius = -1}); }),
            "TouchPlacementOptions::tip_radius is -1 mm; it must be >= 0 and finite");
  tips(1, 4) = std::nan("");
  EXPECT_EQ(refusal([&] { (void)place_by_touches(tips, surface, {.tip_radius = 3}); }),
            "place_by_touches: touch 5 has a coordinate that is not finite");
}

}  // namespace
}  // namespace palpate::probing
