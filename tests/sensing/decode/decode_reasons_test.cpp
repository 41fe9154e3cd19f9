// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "palpate/sensing/decode.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// A part of the image in which something is wrong, and its middle.
const cv::Rect kPart(120, 80, 80, 80);
constexpr int kPartMargin = 25;

/// A wall that fills the image.
Scene wall(const Rig& rig, const Pattern& pattern) {
  return render(rig, pattern, plane(Eigen::Vector3d(0.1, -0.1, 1).normalized(), 700));
}

ReasonImage reasons_of(const cv::Mat& frame, const DecodeOptions& options = {},
                       const Rig& rig = make_rig(true),
                       const Pattern& pattern = make_pattern(Axis::y, 20, 1024)) {
  const DecodeResult result = Decoder(rig, pattern, ideal_colors(), options).decode(frame);
  EXPECT_TRUE(((result.range.z > 0) == (result.reasons == 0)).all());
  EXPECT_TRUE((result.reasons < kReasonCount).all());
  return result.reasons;
}

double share(const ReasonImage& reasons, Reason reason) {
  return static_cast<double>(count(reasons, reason)) / static_cast<double>(reasons.size());
}

/// Of the middle of kPart.
double share_in_part(const ReasonImage& reasons, Reason reason) {
  return share(reasons.block(kPart.y + kPartMargin, kPart.x + kPartMargin,
                             kPart.height - 2 * kPartMargin, kPart.width - 2 * kPartMargin),
               reason);
}

class DecodeReasons : public ::testing::Test {
 protected:
  Rig rig_ = make_rig(true);
  Pattern pattern_ = make_pattern(Axis::y, 20, 1024);
  cv::Mat frame_ = wall(rig_, pattern_).frame;
};

TEST_F(DecodeReasons, AWholeWallIsReconstructed) {
  EXPECT_EQ(share_in_part(reasons_of(frame_), Reason::reconstructed), 1);
}

TEST_F(DecodeReasons, DarkIsUnlit) {
  frame_(kPart).setTo(cv::Scalar::all(1000));
  EXPECT_EQ(share_in_part(reasons_of(frame_), Reason::unlit), 1);
}

TEST_F(DecodeReasons, LightBeyondFullScaleIsSaturated) {
  frame_(kPart).setTo(cv::Scalar::all(65535));
  EXPECT_EQ(share_in_part(reasons_of(frame_), Reason::saturated), 1);
  frame_(kPart).setTo(cv::Scalar(0, 65535, 65535));
  EXPECT_EQ(share_in_part(reasons_of(frame_), Reason::saturated), 1);
}

TEST_F(DecodeReasons, ColouredLightWithoutASinusoidIsOfLowModulation) {
  frame_(kPart).setTo(cv::Scalar(0, 30000, 30000));
  EXPECT_EQ(share_in_part(reasons_of(frame_), Reason::low_modulation), 1);
}

TEST_F(DecodeReasons, AFaintSinusoidIsUsedUnlessTheNoiseDrownsIt) {
  Pattern blurred = pattern_;
  blurred.amplitude *= 0.2;  // as by a defocus of 0.29 periods
  cv::Mat frame = wall(rig_, blurred).frame;
  add_noise(frame, 0.002, 3);
  EXPECT_GT(share_in_part(reasons_of(frame), Reason::reconstructed), 0.75);
  frame = wall(rig_, blurred).frame;
  add_noise(frame, 0.1, 3);
  EXPECT_GT(share_in_part(reasons_of(frame), Reason::low_modulation), 0.6);
  EXPECT_LT(share_in_part(reasons_of(frame), Reason::reconstructed), 0.01);
}

TEST_F(DecodeReasons, APhaseThatVariesTooMuchIsUneven) {
  EXPECT_GT(share(reasons_of(frame_, {.max_phase_variance = 1e-12}), Reason::uneven_phase), 0.8);
}

TEST_F(DecodeReasons, ARegionWithinOneStripeHasNoTransition) {
  Pattern wide = make_pattern(Axis::y, 20, 9600);  // a stripe is some 110 camera pixels
  wide.stripe_edges.resize(3);                     // those on the panel
  wide.stripes.resize(4);
  const Scene ball = render(rig_, wide, sphere({-40, 0, 700}, 35));
  const ReasonImage reasons = reasons_of(ball.frame, {}, rig_, wide);
  EXPECT_GT(count(reasons, Reason::no_transition), 500);
  EXPECT_EQ(count(reasons, Reason::reconstructed), 0);
}

TEST_F(DecodeReasons, StripesThatContradictEachOtherAreAmbiguous) {
  // Every other three rows show stripes that lie elsewhere, over the same sinusoid.
  Pattern moved = pattern_;
  for (double& edge : moved.stripe_edges) edge += 150;
  const cv::Mat other = wall(rig_, moved).frame;
  for (int row = 0; row < frame_.rows; ++row) {
    if (row / 3 % 2 == 0) other.row(row).copyTo(frame_.row(row));
  }
  const ReasonImage reasons = reasons_of(frame_);
  EXPECT_GT(share(reasons, Reason::ambiguous_offset), 0.3);
  EXPECT_LT(share(reasons, Reason::reconstructed), 0.05);
}

TEST_F(DecodeReasons, TheRimOfALitObjectIsItsBorder) {
  const ReasonImage reasons = reasons_of(render(rig_, pattern_, sphere({0, 0, 700}, 90)).frame);
  ASSERT_GT(count(reasons, Reason::reconstructed), 5000);
  EXPECT_GT(count(reasons, Reason::border), 50);
  // No depth touches the dark.
  for (long row = 1; row + 1 < reasons.rows(); ++row) {
    for (long column = 1; column + 1 < reasons.cols(); ++column) {
      if (reasons(row, column) != 0) continue;
      EXPECT_EQ(count(reasons.block(row - 1, column - 1, 3, 3), Reason::unlit), 0);
    }
  }
}

TEST_F(DecodeReasons, ASurfaceBeyondThePanelIsTold) {
  Rig cropped = rig_;
  cropped.projector.height = 400;
  const ReasonImage reasons = reasons_of(frame_, {}, cropped);
  EXPECT_GT(share(reasons, Reason::off_panel), 0.2);
  EXPECT_GT(share(reasons, Reason::reconstructed), 0.2);
}

TEST_F(DecodeReasons, APhaseThatSaysTooLittleOfTheDepthIsGrazing) {
  EXPECT_EQ(share_in_part(reasons_of(frame_, {.max_sensitivity = 1e-3}), Reason::grazing), 1);
}

TEST_F(DecodeReasons, ColoursThatContradictTheDepthAreAMismatch) {
  // All stripes become yellow, the sinusoid goes on.
  for (int row = kPart.y; row < kPart.br().y; ++row) {
    for (int column = kPart.x; column < kPart.br().x; ++column) {
      auto& pixel = frame_.at<cv::Vec<ushort, 3>>(row, column);
      const ushort light = std::max({pixel[0], pixel[1], pixel[2]});
      pixel = {1300, light, light};
    }
  }
  const ReasonImage reasons = reasons_of(frame_);
  // Where the part is connected to its surroundings; the rest has no stripe edge.
  EXPECT_GT(share_in_part(reasons, Reason::color_mismatch), 0.2);
  EXPECT_EQ(share_in_part(reasons, Reason::reconstructed), 0);
  EXPECT_GT(share(reasons, Reason::reconstructed), 0.5);
}

}  // namespace
}  // namespace palpate::sensing
