// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/color_evidence.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "not_finite.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// Two surfaces beside each other, under stripes of 33 px seen one to one, nothing between them.
class ColorEvidence : public ::testing::Test {
 protected:
  static constexpr long kColumns = 200;
  static constexpr long kGap = 100;  // column
  ColorEvidence() : z_(Plane::Constant(40, kColumns, 700)), hue_(40, kColumns), pixel_(z_) {
    for (long column = 0; column < kColumns; ++column) {
      const double pixel = 100.0 + static_cast<double>(column);
      hue_.col(column) = hue_at(pixel);
      pixel_.col(column) = static_cast<float>(pixel);
    }
    z_.col(kGap) = kFloatNaN;
    pixel_.col(kGap) = kFloatNaN;
  }
  float hue_at(double pixel) const {
    std::size_t stripe = 0;
    while (pixel > pattern_.stripe_edges[stripe]) ++stripe;
    return std::numbers::pi_v<float> / 3 * static_cast<float>(pattern_.stripes[stripe]);
  }
  Mask unproven() const {
    Mask marked;
    ColorSays says;
    compare_colors(pixel_, hue_, StripeColors(pattern_), classifier_, says);
    find_unproven_patches(z_, says, classifier_.colors(), marked);
    return marked;
  }
  Pattern pattern_ = make_pattern(Axis::y, 10, 1024);
  HueClassifier classifier_{pattern_, ideal_colors()};
  Plane z_;
  Plane hue_;
  Plane pixel_;
};

TEST_F(ColorEvidence, ASurfaceUnderSeveralStripesOfTheRightColoursIsProven) {
  EXPECT_EQ(unproven().count(), 0);
}

TEST_F(ColorEvidence, ASurfaceOfOneHueIsNotWhateverItsDepth) {
  for (const float shift : {0.F, 33.F, 66.F, 200.F}) {
    hue_.rightCols(kColumns - kGap) = hue_(0, kGap + 20);
    pixel_.rightCols(kColumns - kGap - 1) += shift;
    const Mask marked = unproven();
    EXPECT_EQ(marked.leftCols(kGap).count(), 0) << shift;
    EXPECT_EQ(marked.rightCols(kColumns - kGap - 1).count(), 40 * (kColumns - kGap - 1)) << shift;
  }
}

TEST_F(ColorEvidence, APatchWithinOneStripeIsNotProven) {
  z_.leftCols(kGap) = kFloatNaN;
  z_.block(10, 50, 20, 8) = 700;  // one stripe is 33 px wide
  const Mask marked = unproven();
  EXPECT_EQ(marked.block(10, 50, 20, 8).count(), 20 * 8);
  EXPECT_EQ(marked.count(), 20 * 8);
}

TEST_F(ColorEvidence, WhatIsNotKnownIsNotMarked) {
  z_.setConstant(kFloatNaN);
  EXPECT_EQ(unproven().count(), 0);
}

TEST_F(ColorEvidence, PatchesAreTheConnectedSetsThatOpenCvFinds) {
  std::mt19937 random(1);
  for (const unsigned percent_known : {45U, 60U, 75U}) {
    Plane z = Plane::Constant(61, 83, kFloatNaN);
    ColorSays says(z.rows(), z.cols());
    for (long i = 0; i < z.size(); ++i) {
      if (random() % 100 < percent_known) z.data()[i] = 700;
      // Mostly silent or the first colour, so that the second one decides.
      const unsigned color = random() % 12 == 0 ? 1 : 0;
      says.data()[i] = static_cast<std::uint8_t>(random() % 4 == 0 ? kSilent : color + kConfirms);
    }
    Mask known = (z == z).cast<std::uint8_t>();
    cv::Mat_<int> label;
    const cv::Mat image(static_cast<int>(z.rows()), static_cast<int>(z.cols()), CV_8U,
                        known.data());
    const int count = cv::connectedComponents(image, label, 4, CV_32S);
    std::vector<std::array<int, 2>> speaking(static_cast<std::size_t>(count));
    const auto patch_of = [&](long i) { return static_cast<std::size_t>(label.ptr<int>()[i]); };
    for (long i = 0; i < z.size(); ++i) {
      if (says.data()[i] != kSilent) ++speaking[patch_of(i)][says.data()[i] - kConfirms];
    }
    Mask marked;
    find_unproven_patches(z, says, 2, marked);
    int proven = 0;
    for (long i = 0; i < z.size(); ++i) {
      const auto [first, second] = speaking[patch_of(i)];
      const bool both =
          20 * first >= first + second && 20 * second >= first + second && first > 0 && second > 0;
      const bool unproven = known.data()[i] != 0 && !both;
      EXPECT_EQ(marked.data()[i] != 0, unproven) << percent_known << ", pixel " << i;
      proven += known.data()[i] != 0 && both ? 1 : 0;
    }
    EXPECT_GT(proven, 20) << percent_known;
    EXPECT_GT(marked.count(), 10) << percent_known;
  }
}

}  // namespace
}  // namespace palpate::sensing
