// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "repository.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Rig bundled_rig() { return read_rig(repository("demo/rig.yaml")); }

std::vector<Doubt> with_baseline(double mm) {
  Rig rig = bundled_rig();
  rig.T_projector_camera.translation() *= mm / rig.T_projector_camera.translation().norm();
  return rig_doubts(rig);
}

/// 640 x 480 px.
geometry::Camera camera_of(double focal, double cx = 318.5, double cy = 242) {
  return {.width = 640, .height = 480, .fx = focal, .fy = focal, .cx = cx, .cy = cy};
}

TEST(RigDoubts, NothingIsSaidOfRigsOfUsualSizes) {
  for (const std::string name : {"demo/rig.yaml", "demo/verging/rig.yaml"})
    EXPECT_THAT(rig_doubts(read_rig(repository(name))), IsEmpty()) << name;
  for (const double mm : {10.0, 25.0, 120.0, 224.0, 1000.0, 4900.0})
    EXPECT_THAT(with_baseline(mm), IsEmpty()) << mm;
}

TEST(RigDoubts, TinyAndHugeRigsAreUnlikelyButPossible) {
  for (const double mm : {2.0, 5.0, 9.0, 6000.0, 20000.0}) {
    ASSERT_THAT(with_baseline(mm), SizeIs(1)) << mm;
    EXPECT_FALSE(with_baseline(mm)[0].impossible) << mm;
  }
}

// The bundled rig, 223.9 mm wide, read as if its numbers were mm.
TEST(RigDoubts, AWrongUnitIsNamedWithTheLengthThatItWouldGive) {
  const auto doubt = [](double baseline) {
    const std::vector<Doubt> doubts = with_baseline(baseline);
    return doubts.size() == 1 ? doubts[0] : Doubt{};
  };
  EXPECT_TRUE(doubt(0.2239).impossible);
  EXPECT_THAT(doubt(0.2239).message, HasSubstr("223.9 mm if the number is in metres"));
  EXPECT_FALSE(doubt(223.9 / 25.4).impossible);
  EXPECT_THAT(doubt(223.9 / 25.4).message, HasSubstr("223.9 mm if the number is in inches"));
  EXPECT_TRUE(doubt(223.9e3).impossible);
  EXPECT_THAT(doubt(223.9e3).message, HasSubstr("223.9 mm if the number is in micrometres"));
}

TEST(RigDoubts, CamerasOfUsualAnglesAndPartsOfLargerImagesAreBelieved) {
  for (const double focal : {250.0, 476.0, 1100.0, 5000.0, 2e5})
    EXPECT_THAT(camera_doubts(camera_of(focal)), IsEmpty()) << focal;
  // A part of 484 x 152 px of a larger image, of real captures.
  EXPECT_THAT(
      camera_doubts(
          {.width = 484, .height = 152, .fx = 2445.65, .fy = 2445.65, .cx = 483.5, .cy = 607.5}),
      IsEmpty());
  EXPECT_THAT(camera_doubts({.width = 1, .height = 1, .fx = 1, .fy = 1}), IsEmpty());
}

TEST(RigDoubts, AFocalLengthInMillimetresCannotBe) {
  const std::vector<Doubt> doubts = camera_doubts(camera_of(5.8));
  ASSERT_THAT(doubts, SizeIs(1));
  EXPECT_TRUE(doubts[0].impossible);
  // atan(sqrt(320.5^2 + 242^2) / 5.8)
  EXPECT_THAT(doubts[0].message, HasSubstr("89 degrees from the optical axis"));
  EXPECT_THAT(doubts[0].message, HasSubstr("focal length in mm"));
  EXPECT_THAT(camera_doubts(camera_of(1e6)), SizeIs(1));  // in micrometres
}

TEST(RigDoubts, APrincipalPointFarOutsideTheImageIsDoubtedInACameraOnly) {
  for (const auto& [cx, cy] : {std::pair{2000.0, 242.0}, {900.0, 242.0}, {318.5, -300.0}}) {
    const std::vector<Doubt> doubts = camera_doubts(camera_of(580, cx, cy));
    ASSERT_THAT(doubts, SizeIs(1)) << cx << ' ' << cy;
    EXPECT_EQ(doubts[0].subject, "camera");
    EXPECT_FALSE(doubts[0].impossible);
  }
  Rig shifted = bundled_rig();
  shifted.projector.cy = -500;  // a lens that is shifted by more than its image
  EXPECT_THAT(rig_doubts(shifted), IsEmpty());
  shifted.projector.fx = shifted.projector.fy = 15;
  ASSERT_THAT(rig_doubts(shifted), SizeIs(1));
  EXPECT_EQ(rig_doubts(shifted)[0].subject, "projector");
}

TEST(RigDoubts, DepthsTellTheScaleOfADepthImage) {
  for (const double mm : {12.0, 700.0, 9e3, 5e4}) EXPECT_THAT(depth_doubts(mm), IsEmpty()) << mm;
  EXPECT_THAT(depth_doubts(std::nan("")), IsEmpty());
  ASSERT_THAT(depth_doubts(0.7), SizeIs(1));
  EXPECT_TRUE(depth_doubts(0.7)[0].impossible);
  EXPECT_THAT(depth_doubts(0.7)[0].message, HasSubstr("700 mm if the number is in metres"));
  EXPECT_TRUE(depth_doubts(7e14).at(0).impossible);
  EXPECT_FALSE(depth_doubts(1.7).at(0).impossible);
  EXPECT_FALSE(depth_doubts(2e6).at(0).impossible);
}

TEST(RigDoubts, ARangeMapIsJudgedByItsKnownDepths) {
  geometry::RangeMap map{geometry::ImageF::Constant(480, 640, 700), camera_of(580)};
  EXPECT_THAT(range_map_doubts(map), IsEmpty());
  map.z.topRows(200) = std::numeric_limits<float>::quiet_NaN();
  map.z.bottomRows(3) = 1e-3F;  // a few wrong ones
  EXPECT_THAT(range_map_doubts(map), IsEmpty());
  map.z *= 1e-3F;
  EXPECT_THAT(impossible_parts(range_map_doubts(map)), HasSubstr("depths: half of them"));
  map.z = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(range_map_doubts(map), IsEmpty());
}

}  // namespace
}  // namespace palpate::sensing
