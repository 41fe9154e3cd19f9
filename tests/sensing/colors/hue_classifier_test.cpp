// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "colors/hue_classifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "image/hue.h"
#include "palpate/core/error.h"
#include "synthetic_scene.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(Hue, KnowsThePureColoursAndIgnoresAddedWhite) {
  EXPECT_FLOAT_EQ(hue_of(1, 0, 0).angle, 0);
  EXPECT_FLOAT_EQ(hue_of(0.5F, 0.5F, 0).angle, static_cast<float>(std::numbers::pi / 3));
  EXPECT_FLOAT_EQ(hue_of(0, 1, 0).angle, static_cast<float>(2 * std::numbers::pi / 3));
  EXPECT_FLOAT_EQ(hue_of(0.1F, 0.1F, 0.6F).angle, static_cast<float>(4 * std::numbers::pi / 3));
  EXPECT_FLOAT_EQ(hue_of(1, 0, 1).angle, static_cast<float>(5 * std::numbers::pi / 3));
  EXPECT_FLOAT_EQ(hue_of(0.7F, 0.4F, 0.2F).angle, hue_of(0.5F, 0.2F, 0).angle);
  EXPECT_FLOAT_EQ(hue_of(0.8F, 0.2F, 0.4F).saturation, 0.75F);
  EXPECT_EQ(hue_of(0.3F, 0.3F, 0.3F).saturation, 0);
  EXPECT_EQ(hue_of(0, 0, 0).saturation, 0);
}

TEST(Hue, OfAnImageIsThatOfEachPixel) {
  Plane red(3, 7);
  Plane green(3, 7);
  Plane blue(3, 7);
  for (int i = 0; i < 21; ++i) {
    red.data()[i] = static_cast<float>(i % 3);
    green.data()[i] = static_cast<float>(i % 4) - 0.5F;
    blue.data()[i] = static_cast<float>(i % 5) / 2;
  }
  Plane hue;
  find_hues(red, green, blue, hue);
  for (int i = 0; i < 21; ++i) {
    EXPECT_EQ(hue.data()[i], hue_of(red.data()[i], green.data()[i], blue.data()[i]).angle) << i;
    EXPECT_GE(hue.data()[i], 0);
    EXPECT_LE(hue.data()[i], static_cast<float>(2 * std::numbers::pi));
  }
}

TEST(HueClassifier, IsBayesWithGaussians) {
  const TrainedColors trained{{{"A", 1.0, 0.04, 100}, {"B", 1.5, 0.09, 100}}};
  Pattern pattern;
  pattern.colors = {{"B", {0, 1, 0}}, {"A", {1, 0, 0}}};
  const HueClassifier classifier(pattern, trained);
  for (const double hue : {0.9, 1.1, 1.25, 1.4, 1.8}) {
    const auto density = [&](double mean, double sigma) {
      return std::exp(-(hue - mean) * (hue - mean) / (2 * sigma * sigma)) / sigma;
    };
    const double b = density(1.5, 0.3) / (density(1.5, 0.3) + density(1.0, 0.2));
    // The table has a step of 2 pi / 1024.
    EXPECT_NEAR(classifier.probabilities(static_cast<float>(hue))[0], b, 0.03) << hue;
    EXPECT_EQ(classifier.best(static_cast<float>(hue)), b > 0.5 ? 0 : 1) << hue;
  }
}

TEST(HueClassifier, HuesAreCircular) {
  const HueClassifier classifier(make_pattern(Axis::y, 10, 1024), ideal_colors());
  EXPECT_EQ(classifier.best(0.02F), 0);
  EXPECT_EQ(classifier.best(static_cast<float>(2 * std::numbers::pi - 0.02)), 0);
  EXPECT_EQ(classifier.best(static_cast<float>(5 * std::numbers::pi / 3)), 5);
}

TEST(HueClassifier, ProbabilitiesSumToOneFarFromEveryColour) {
  const TrainedColors trained{{{"A", 0.1, 0, 100}, {"B", 0.3, 0, 100}}};
  Pattern pattern;
  pattern.colors = {{"A", {1, 0, 0}}, {"B", {0, 1, 0}}};
  const HueClassifier classifier(pattern, trained);
  const float* probabilities = classifier.probabilities(3.3F);
  EXPECT_NEAR(probabilities[0] + probabilities[1], 1, 1e-6);
}

TEST(HueClassifier, ColoursThatWereNeverTrainedAreRefusedByName) {
  TrainedColors trained = ideal_colors();
  trained.colors.pop_back();
  const Pattern pattern = make_pattern(Axis::y, 10, 1024);
  const std::string message = message_of<InvalidInput>([&] { HueClassifier(pattern, trained); });
  EXPECT_NE(message.find("colour M"), std::string::npos) << message;
  trained.colors.push_back({"M", std::nan(""), 0.1, 10});
  EXPECT_THROW(HueClassifier(pattern, trained), InvalidInput);
}

}  // namespace
}  // namespace palpate::sensing
