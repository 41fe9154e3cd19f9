// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/half_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <opencv2/core.hpp>

#include "palpate/core/error.h"
#include "palpate/sensing/decode.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

const Eigen::Vector3d kNormal = Eigen::Vector3d(0.1, -0.2, 1).normalized();
constexpr double kPlaneDistance = 650;  // mm

/// Without stripes: the errors are then those of the phase alone.
Pattern stripeless(Axis axis) {
  return {.axis = axis, .period = 20, .phase = -1.2, .mean = 0.5, .amplitude = 0.5};
}

/// Distances of the points from the plane [mm], by the map's own camera; without those nearer than
/// `margin` px to the image's border.
std::vector<double> offsets_from_plane(const geometry::RangeMap& range, long margin = 0) {
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(range.camera);
  std::vector<double> offsets;
  for (long i = 0; i < range.z.size(); ++i) {
    const long row = i / range.z.cols();
    const long column = i % range.z.cols();
    const bool inner =
        std::min({row, column, range.z.rows() - 1 - row, range.z.cols() - 1 - column}) >= margin;
    const auto z = static_cast<double>(range.z.data()[i]);
    if (inner && z > 0)
      offsets.push_back(kNormal.dot(z * rays.col(i).homogeneous()) - kPlaneDistance);
  }
  return offsets;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(HalfSize, PixelsLieInTheMiddleOfFourAndTheOddOnesAreLeftOut) {
  // Brightness that rises evenly keeps its place.
  Plane whole(9, 5);
  for (long row = 0; row < whole.rows(); ++row) {
    for (long column = 0; column < whole.cols(); ++column)
      whole(row, column) = static_cast<float>(10 * row + column);
  }
  std::vector<Plane> half;
  half_size({whole, 2 * whole}, half);
  ASSERT_EQ(half.size(), 2U);
  ASSERT_EQ(half[0].rows(), 4);
  ASSERT_EQ(half[0].cols(), 2);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 2; ++column) {
      const double middle = 10 * (2.0 * row + 0.5) + (2.0 * column + 0.5);
      EXPECT_FLOAT_EQ(half[0](row, column), static_cast<float>(middle));
      EXPECT_FLOAT_EQ(half[1](row, column), static_cast<float>(2 * middle));
    }
  }
}

TEST(HalfSize, RowsThatWereInterpolatedShiftTheSinusoidLittle) {
  // A colour of a mosaic: every other row measured, those between the mean of their neighbours.
  constexpr double kFrequency = 2 * std::numbers::pi / 7.2;
  Plane whole(402, 2);
  for (long row = 0; row < whole.rows(); ++row) {
    const double at = row % 2 == 0 ? 1 : std::cos(kFrequency);
    whole.row(row).setConstant(
        static_cast<float>(at * std::cos(kFrequency * static_cast<double>(row))));
  }
  std::vector<Plane> half;
  half_size({whole}, half);
  std::complex<double> sum = 0;
  for (long row = 10; row < 190; ++row) {  // 50 periods
    sum += static_cast<double>(half[0](row, 0)) *
           std::polar(1.0, -kFrequency * (2 * static_cast<double>(row) + 0.5));
  }
  EXPECT_LT(std::abs(std::arg(sum)), 0.025);
}

TEST(HalfSize, ItsCameraSeesTheSameRays) {
  const geometry::Camera whole{.width = 641,
                               .height = 480,
                               .fx = 610,
                               .fy = 605,
                               .cx = 323.4,
                               .cy = 238.1,
                               .distortion = {-0.15, 0.08, 1e-3, -5e-4, 0.01, 0, 0, 0}};
  const geometry::Camera half = half_size(whole);
  EXPECT_EQ(half.width, 320);
  EXPECT_EQ(half.height, 240);
  // The first half pixel lies where the first four meet.
  EXPECT_EQ(half_size(0.5), 0);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0, 0), Eigen::Vector2d(500.3, 77.2)}) {
    const Eigen::Vector2d in_half(half_size(pixel.x()), half_size(pixel.y()));
    EXPECT_NEAR((geometry::undistort(half, in_half) - geometry::undistort(whole, pixel)).norm(), 0,
                1e-12);
  }
}

TEST(HalfResolution, MeasuresThePlaneWithinTheDeviationsItPredicts) {
  Rig rig = make_rig(false);
  rig.camera.distortion = {-0.1, 0.05, 1e-3, -5e-4, 0, 0, 0, 0};
  rig.camera.width = 321;  // an odd column
  Scene scene = render(rig, stripeless(Axis::y), plane(kNormal, kPlaneDistance), 0);
  add_noise(scene.frame, 0.01, 5);
  const Anchor anchor{.u_px = 101.3, .v_px = 88.8, .z = static_cast<double>(scene.z(89, 101))};
  const auto decode = [&](bool half) {
    return Decoder(rig, stripeless(Axis::y), {}, {.half_resolution = half, .anchors = {anchor}})
        .decode(scene.frame);
  };
  const DecodeResult half = decode(true);
  ASSERT_EQ(half.range.z.cols(), 160);
  ASSERT_EQ(half.range.z.rows(), 120);
  ASSERT_EQ(half.reasons.cols(), 160);
  EXPECT_EQ(half.range.camera.width, 160);
  EXPECT_GT((half.range.z > 0).count(), 0.9 * 160 * 120);
  std::vector<double> scores;
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(half.range.camera);
  for (long i = 0; i < half.range.z.size(); ++i) {
    const auto z = static_cast<double>(half.range.z.data()[i]);
    if (!(z > 0)) continue;
    const double truth = kPlaneDistance / kNormal.dot(rays.col(i).homogeneous());
    scores.push_back((z - truth) / static_cast<double>(half.sigma.data()[i]));
  }
  EXPECT_NEAR(root_mean_square(scores), 1, 0.3);
  // Away from the borders, where windows are whole: they cover twice as many of the frame's pixels
  // across the sinusoid, and as many along it.
  const double error = root_mean_square(offsets_from_plane(half.range, 10));
  const double whole_error = root_mean_square(offsets_from_plane(decode(false).range, 20));
  EXPECT_LT(error, whole_error);
  EXPECT_GT(error, whole_error / 2);
}

TEST(HalfResolution, DecodesStripesAndTheOtherAxis) {
  const Rig rig = make_rig(true);
  const Pattern striped = make_pattern(Axis::y, 20, 1024);
  const Decoder decoder(rig, striped, ideal_colors(), {.half_resolution = true});
  EXPECT_EQ(decoder.rig().camera.width, 160);
  const DecodeResult result =
      decoder.decode(render(rig, striped, plane(kNormal, kPlaneDistance)).frame);
  EXPECT_GT((result.range.z > 0).count(), 0.85 * 160 * 120);
  EXPECT_LT(root_mean_square(offsets_from_plane(result.range)), 1e-3 * kPlaneDistance);

  const Rig parallel = make_rig(false);
  const Scene scene = render(parallel, stripeless(Axis::x), plane(kNormal, kPlaneDistance), 0);
  const Anchor anchor{.u_px = 201, .v_px = 150, .z = static_cast<double>(scene.z(150, 201))};
  const DecodeResult across =
      Decoder(parallel, stripeless(Axis::x), {}, {.half_resolution = true, .anchors = {anchor}})
          .decode(scene.frame);
  EXPECT_GT((across.range.z > 0).count(), 0.85 * 160 * 120);
  EXPECT_LT(root_mean_square(offsets_from_plane(across.range)), 1e-4 * kPlaneDistance);
}

TEST(HalfResolution, RefusesWhatIsTooFineAndAnAnchorThatIsLeftOut) {
  Rig rig = make_rig(false);
  const Anchor anchor{100, 100, kPlaneDistance};
  Pattern fine = stripeless(Axis::y);
  fine.period = 16;  // 2.8 px
  EXPECT_NO_THROW(Decoder(rig, fine, {}, {.anchors = {anchor}}));
  const std::string message = message_of<InvalidInput>(
      [&] { Decoder(rig, fine, {}, {.half_resolution = true, .anchors = {anchor}}); });
  EXPECT_NE(message.find("half_resolution"), std::string::npos) << message;
  EXPECT_NE(message.find("full size"), std::string::npos) << message;
  fine.period = 20;
  rig.camera.width = 321;
  const Anchor last{320, 100, kPlaneDistance};
  EXPECT_NO_THROW(Decoder(rig, fine, {}, {.anchors = {last}}));
  EXPECT_THROW(Decoder(rig, fine, {}, {.half_resolution = true, .anchors = {last}}), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
