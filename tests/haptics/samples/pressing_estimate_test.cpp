// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/pressing_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr double kHardening = 6;  // [mm]

struct Pressed {
  std::vector<PressedContact> contacts;
  std::vector<double> stiffness, touches;
};

struct Recording {
  double noise = 0.02;  // [N]
  Vector3d bias = Vector3d::Zero();
  double late = 0;        // [mm] touches are found up to this much too deep
  double hysteresis = 0;  // > 0: the way back is recorded
  int side = 9, depths = 8;
  unsigned seed = 3;
  double tilt = 0;        // tangent of the angle of pressing
  double resistance = 0;  // force across, relative to the force along times the tilt
};

// A bed that is up to four times as stiff in the middle of a square: k (d + d^2 / kHardening) along
// directions that vary by some degrees.
Pressed pressed(const Recording& recording) {
  std::mt19937 random(recording.seed);
  std::normal_distribution<double> normal(0, recording.noise);
  std::uniform_real_distribution<double> late(0, recording.late), place(-1, 1);
  Pressed result;
  for (int i = 0; i < recording.side * recording.side; ++i) {
    // Uneven, so that no two contacts are equally far from a third one.
    const double x = 5.0 * (i % recording.side) + place(random);
    const double y = 5.0 * (i / recording.side) + place(random);
    const double middle = 2.5 * (recording.side - 1);
    const double square = std::pow(x - middle, 2) + std::pow(y - middle, 2);
    const double k = 0.3 * (1 + 3 * std::exp(-square / 200));
    PressedContact contact;
    contact.position = {x, y, 0};
    contact.direction = Vector3d(0.004 * (x - middle), 0.003 * (y - middle), 1).normalized();
    const double touch = late(random);
    const int ways = recording.hysteresis > 0 ? 2 : 1;
    contact.displacements.resize(3, ways * recording.depths);
    contact.forces.resize(3, ways * recording.depths);
    for (int s = 0; s < ways * recording.depths; ++s) {
      const bool back = s >= recording.depths;
      const double depth = 0.4 * (back ? 2 * recording.depths - s : s + 1);
      const double share = back ? 1 - recording.hysteresis : 1;
      const Vector3d side = recording.tilt * contact.direction.cross(Vector3d::UnitY());
      contact.displacements.col(s) = (depth - touch) * (contact.direction + side);
      contact.forces.col(s) = share * k * (depth + depth * depth / kHardening) *
                                  (contact.direction + recording.resistance * side) +
                              recording.bias +
                              Vector3d{normal(random), normal(random), normal(random)};
      if (ways > 1) contact.unloading.push_back(back);
    }
    result.contacts.push_back(contact);
    result.stiffness.push_back(k);
    result.touches.push_back(touch);
  }
  return result;
}

double rms_of_curves(const Pressed& truth, const PressingEstimate& found) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < truth.contacts.size(); ++i) {
    for (double depth = 0.4; depth < 3.3; depth += 0.4, ++count) {
      const double force = truth.stiffness[i] * (depth + depth * depth / kHardening);
      sum += std::pow(force_at(found.curves[i], depth) - force, 2);
    }
  }
  return std::sqrt(sum / count);
}

TEST(EstimatePressing, FindsOffsetsWithinTheirErrors) {
  const Vector3d bias(0.03, -0.05, 0.06);
  const Pressed truth = pressed({.bias = bias, .late = 0.4});
  const PressingEstimate found = estimate_pressing(truth.contacts);
  ASSERT_TRUE(found.offsets.force_found && found.offsets.touch_found);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(found.offsets.force(i), bias(i), 4 * found.offsets.force_error(i)) << i;
  EXPECT_LT(found.offsets.force_error.maxCoeff(), 0.015);
  EXPECT_NEAR(found.offsets.touch, 0.2, 4 * found.offsets.touch_error);
  EXPECT_LT(found.offsets.touch_error, 0.05);
  EXPECT_NEAR(found.offsets.touch_spread, 0.4 / std::sqrt(12), 0.03);
  EXPECT_NEAR(found.force_noise, 0.02, 0.002);
  double square = 0;
  for (std::size_t i = 0; i < truth.touches.size(); ++i)
    square += std::pow((found.curves[i].touch - truth.touches[i]) / found.curves[i].touch_error, 2);
  EXPECT_GT(square / static_cast<double>(truth.touches.size()), 0.4);
  EXPECT_LT(square / static_cast<double>(truth.touches.size()), 2.5);
  // A fit of each contact alone would be off by its touch, k F' 0.23 mm, and by the bias.
  EXPECT_LT(rms_of_curves(truth, found), 0.025);
}

TEST(EstimatePressing, FindsTheNoiseOfOneSampleAContact) {
  // 0.1 to 0.5 N at 0.4 mm. Differences between contacts and those around are all noise.
  for (const double noise : {0.02, 0.06}) {
    const Pressed truth = pressed({.noise = noise, .depths = 1});
    const PressingEstimate found = estimate_pressing(truth.contacts);
    EXPECT_TRUE(found.noise_was_estimated);
    EXPECT_NEAR(found.force_noise, noise, 0.4 * noise);
    // The curves do not follow the noise of their own sample.
    double square = 0;
    for (std::size_t i = 0; i < truth.contacts.size(); ++i) {
      const double force = truth.stiffness[i] * (0.4 + 0.4 * 0.4 / kHardening);
      square += std::pow(force_at(found.curves[i], 0.4) - force, 2);
    }
    EXPECT_LT(std::sqrt(square / static_cast<double>(truth.contacts.size())), 0.7 * noise);
    EXPECT_EQ(estimate_pressing(truth.contacts, {.force_noise = 0.01}).force_noise, 0.01);
  }
}

TEST(EstimatePressing, StatesTheErrorsOfTouches) {
  // Squared errors in units of the stated ones: of the mean touch, of its slope over heights, and
  // of the touch of each contact. All contacts share the error of the mean. If heights tell the
  // touches, the stated error of the mean is 0.005 mm, up to two times too small.
  constexpr int kSeeds = 3;
  for (const bool heights : {false, true}) {
    double mean = 0, slope = 0, each = 0;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      Pressed truth = pressed({.late = 0.4, .side = 8, .seed = seed});
      const auto count = static_cast<double>(truth.touches.size());
      double true_mean = 0;
      for (std::size_t i = 0; i < truth.touches.size(); ++i) {
        if (heights) truth.contacts[i].height = truth.touches[i] - 0.2;
        true_mean += heights ? 0.2 / count : truth.touches[i] / count;
      }
      const PressingEstimate found = estimate_pressing(truth.contacts);
      ASSERT_TRUE(found.offsets.touch_found);
      mean += std::pow((found.offsets.touch - true_mean) / found.offsets.touch_error, 2) / kSeeds;
      if (heights) {
        slope += std::pow((found.offsets.height_slope - 1) / found.offsets.height_slope_error, 2) /
                 kSeeds;
      }
      for (std::size_t i = 0; i < truth.touches.size(); ++i) {
        each +=
            std::pow((found.curves[i].touch - truth.touches[i]) / found.curves[i].touch_error, 2) /
            (count * kSeeds);
      }
    }
    EXPECT_LT(mean, heights ? 6 : 2.5);
    EXPECT_GT(mean, 0.1) << heights;
    EXPECT_LT(slope, 2.5);
    EXPECT_GT(each, 0.5) << heights;
    EXPECT_LT(each, heights ? 5 : 2);
  }
}

TEST(EstimatePressing, TakesNoOffsetsWhereThereAreNone) {
  const Pressed truth = pressed({});
  const PressingEstimate found = estimate_pressing(truth.contacts);
  EXPECT_FALSE(found.offsets.force_found || found.offsets.touch_found);
  EXPECT_EQ(found.offsets.force, Vector3d(0, 0, 0));
  const PressingEstimate without = estimate_pressing(truth.contacts, {.estimate_offsets = false});
  for (std::size_t i = 0; i < truth.contacts.size(); ++i) {
    EXPECT_EQ(found.curves[i].touch, 0);
    EXPECT_EQ(found.curves[i].coefficients, without.curves[i].coefficients);
  }
  EXPECT_LT(rms_of_curves(truth, found), 0.02 / std::sqrt(3));
}

TEST(EstimatePressing, LearnsFromTheSurfaceHowLateTouchesAre) {
  Pressed truth = pressed({.late = 0.4});
  for (std::size_t i = 0; i < truth.contacts.size(); ++i)
    truth.contacts[i].height = truth.touches[i] - 0.2;  // registered to the surface
  const PressingEstimate found = estimate_pressing(truth.contacts);
  EXPECT_NEAR(found.offsets.height_slope, 1, 4 * found.offsets.height_slope_error);
  EXPECT_NEAR(found.offsets.touch, 0.2, 0.05);
  EXPECT_LT(found.offsets.touch_spread, 0.03);
}

TEST(EstimatePressing, FindsTheStiffnessAcrossWhereTheToolWasPressedAtAnAngle) {
  const auto found = [](double resistance) {
    return estimate_pressing(pressed({.tilt = 0.3, .resistance = resistance}).contacts);
  };
  const PressingEstimate half = found(0.5);
  EXPECT_NEAR(half.lateral_ratio, 0.5, 4 * half.lateral_ratio_error);
  EXPECT_LT(half.lateral_ratio_error, 0.1);
  // No object pulls the tool along: that of a half-space is kept.
  const PressingEstimate pulled = found(-0.5);
  EXPECT_EQ(pulled.lateral_ratio, kHalfSpaceRatio);
  EXPECT_EQ(pulled.lateral_ratio_error, kHalfSpaceRatioError);
}

TEST(EstimatePressing, FindsHowMuchForceIsMissingOnTheWayBack) {
  const Pressed truth = pressed({.hysteresis = 0.2});
  const PressingEstimate found = estimate_pressing(truth.contacts);
  EXPECT_NEAR(found.offsets.hysteresis, 0.2, 4 * found.offsets.hysteresis_error + 0.002);
  EXPECT_LT(rms_of_curves(truth, found), 0.02);
}

TEST(EstimatePressing, DoesNotDependOnTheFrameOrTheOrder) {
  const Pressed truth = pressed({.bias = {0.03, -0.05, 0.06}, .late = 0.4, .side = 7});
  const PressingEstimate found = estimate_pressing(truth.contacts);
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized();
  std::vector<PressedContact> turned = truth.contacts;
  for (PressedContact& contact : turned) {
    contact.position = turn * contact.position + Vector3d(100, -50, 700);
    contact.direction = turn * contact.direction;
    contact.displacements = Eigen::Matrix3Xd(turn.toRotationMatrix() * contact.displacements)
                                .rowwise()
                                .reverse()
                                .eval();
    contact.forces =
        Eigen::Matrix3Xd(turn.toRotationMatrix() * contact.forces).rowwise().reverse().eval();
  }
  std::ranges::reverse(turned);
  const PressingEstimate other = estimate_pressing(turned);
  EXPECT_LT((turn * found.offsets.force - other.offsets.force).norm(), 1e-5);
  const std::size_t count = truth.contacts.size();
  for (std::size_t i = 0; i < count; ++i) {
    const PressingCurve &a = found.curves[i], &b = other.curves[count - 1 - i];
    EXPECT_NEAR(a.touch, b.touch, 1e-4);
    EXPECT_NEAR(force_at(a, 2), force_at(b, 2), 1e-4);
  }
}

TEST(EstimatePressing, TakesWhatIsThereOfFewSamples) {
  for (const int depths : {1, 2}) {
    const Pressed truth = pressed({.side = 3, .depths = depths});
    const PressingEstimate found = estimate_pressing(truth.contacts);
    for (std::size_t i = 0; i < truth.contacts.size(); ++i) {
      const double depth = 0.4 * depths;
      EXPECT_NEAR(force_at(found.curves[i], depth),
                  truth.contacts[i].forces.col(depths - 1).dot(truth.contacts[i].direction), 0.1)
          << depths;
    }
  }
  const PressingEstimate one = estimate_pressing(std::vector{pressed({}).contacts.front()});
  EXPECT_NEAR(force_at(one.curves[0], 3.2), 0.3 * 3.2 * (1 + 3.2 / kHardening), 0.1);
}

TEST(EstimatePressing, RefusesWhatIsNoMeasurement) {
  EXPECT_THROW(static_cast<void>(estimate_pressing({})), InvalidInput);
  std::vector<PressedContact> contacts = pressed({.side = 3}).contacts;
  contacts[4].forces(1, 2) = std::numeric_limits<double>::quiet_NaN();
  try {
    static_cast<void>(estimate_pressing(contacts));
    FAIL() << "a NaN was taken";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("contact 4"), std::string::npos) << error.what();
  }
  contacts[4].forces.resize(3, 1);
  EXPECT_THROW(static_cast<void>(estimate_pressing(contacts)), InvalidInput);
  EXPECT_THROW(static_cast<void>(estimate_pressing(pressed({}).contacts, {.force_noise = 0.0})),
               InvalidInput);
}

}  // namespace
}  // namespace palpate::haptics
