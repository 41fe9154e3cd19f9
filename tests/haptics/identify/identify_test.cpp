// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/identify.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "haptics_testing.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

using palpate::support::Strip;
using palpate::support::StripProbing;
using ::testing::HasSubstr;

/// Ten contacts and few samples: enough for all parameters.
StripProbing few(unsigned seed) {
  return {.spacing_x = 28,
          .spacing_y = 40,
          .normal_forces = {0.5, 2},
          .directions = 5,
          .resolution = 0.4,
          .seed = seed};
}

const ParameterEstimate& parameter(const Identification& report, const std::string& name) {
  return *std::find_if(report.parameters.begin(), report.parameters.end(),
                       [&](const auto& estimate) { return estimate.name == name; });
}

struct Truth {
  const char* name;
  double value;
};

/// In the frame that identify_strip takes for the contacts of `few`: the sheet's width is longer
/// than its length, so the angle counts from the camera's y.
std::vector<Truth> truths(const Strip& strip) {
  return {{"tension", strip.tension},
          {"axial stiffness", strip.axial},
          {"lateral stiffness", strip.lateral},
          {"compliance", strip.compliance},
          {"curvature", -strip.taper / (75 * 75)}};
}

TEST(Identify, FindsTheStripWithinItsErrorsWhichAreRight) {
  constexpr int kSeeds = 30;
  const Strip strip{.tension = 0.9, .axial = 37, .compliance = 0.3};
  const std::vector<Truth> expected = truths(strip);
  std::vector<double> squares(expected.size(), 0), errors(expected.size(), 0);
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const IdentifiedStrip found = identify_strip(strip_acquisition(strip, few(seed)));
    ASSERT_EQ(found.report.verdict, Verdict::describes) << "seed " << seed;
    EXPECT_NEAR(found.model.high_support - found.model.low_support, 100, 1);
    EXPECT_NEAR(std::abs(found.model.axis.x()), 1, 1e-4);
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const ParameterEstimate& estimate = parameter(found.report, expected[k].name);
      ASSERT_EQ(estimate.status, ParameterStatus::determined) << expected[k].name;
      const double error = (*estimate.value - expected[k].value);
      // Of 150 numbers one may lie beyond three deviations, none beyond four.
      EXPECT_LT(std::abs(error), 4 * *estimate.standard_error)
          << expected[k].name << ", seed " << seed;
      squares[k] += error * error / kSeeds;
      errors[k] += *estimate.standard_error / kSeeds;
    }
  }
  for (std::size_t k = 0; k < expected.size(); ++k) {
    // 30 seeds tell a deviation to 13 %.
    EXPECT_NEAR(std::sqrt(squares[k]) / errors[k], 1, 0.35) << expected[k].name;
  }
}

TEST(Identify, TellsAnObjectThatIsNoStrip) {
  const Strip block{.block = 1.5, .depth = 8, .block_low = {-20, -30}};
  const IdentifiedStrip found = identify_strip(strip_acquisition(block, few(1)));
  EXPECT_NE(found.report.verdict, Verdict::describes);
  const IdentifiedHalfSpace half_space = identify_half_space(strip_acquisition({}, few(1)), 3);
  EXPECT_EQ(half_space.report.verdict, Verdict::does_not_describe);
  // Far softer sideways than any material: the search ends at a bound, which is no estimate.
  const ParameterEstimate& ratio = parameter(half_space.report, "Poisson's ratio");
  EXPECT_NE(ratio.status, ParameterStatus::determined);
  EXPECT_FALSE(ratio.standard_error.has_value());
}

TEST(Identify, DoesNotTakeTheErrorsOfAModelThatExplainsNothingForNoise) {
  probing::Acquisition reversed = palpate::support::strip_acquisition();
  for (probing::Sample& sample : reversed.samples) {
    sample.force *= -1;
    sample.group = 0;  // their scatter passes for noise
  }
  const Identification strip = identify_strip(reversed).report;
  EXPECT_LT(strip.explained, 0.5);
  EXPECT_NE(strip.verdict, Verdict::describes);
  const Identification half_space = identify_half_space(reversed, 3).report;
  EXPECT_LT(half_space.explained, 0.5);
  EXPECT_NE(half_space.verdict, Verdict::describes);

  const probing::Acquisition right = strip_acquisition({}, few(1));
  EXPECT_GT(identify_strip(right).report.explained, 0.99);
  // Noise as large as the displacements agrees with every model, and so with none.
  const Identification hidden =
      identify_half_space(right, 3, {.displacement_noise = 20, .force_noise = 0}).report;
  EXPECT_LT(*hidden.chi2, 2);
  EXPECT_EQ(hidden.verdict, Verdict::not_testable);
}

/// A half-space probed with noise, by the closed form of two springs.
probing::Acquisition probed_half_space(double normal, double tangential, bool only_normal = false) {
  constexpr double kPositionNoise = 0.01;  // [mm]
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, kPositionNoise);
  probing::Acquisition acquisition;
  for (int c = 0; c < 3; ++c) {
    acquisition.contacts.push_back({c, {10.0 * c, 3, 700}, {0, 0, -1}});
    for (int i = 0; i < 40; ++i) {
      const double pressed = 0.5 + 0.5 * (i / 8), angle = i * 0.8;
      const double along = only_normal ? 0 : 0.5 * pressed;
      const Eigen::Vector3d f(along * std::cos(angle), along * std::sin(angle), pressed);
      const Eigen::Vector3d at = acquisition.contacts.back().position;
      const auto scatter = [&] {
        return Eigen::Vector3d{noise(random), noise(random), noise(random)};
      };
      acquisition.samples.push_back(
          {.id = 100 * c + i,
           .contact = c,
           .group = i / 8 + 10 * c,
           .force = f,
           .a = at + Eigen::Vector3d(0, 0, pressed / normal) + scatter(),
           .b = at + Eigen::Vector3d(f.x() / tangential, f.y() / tangential, pressed / normal) +
                scatter()});
    }
  }
  return acquisition;
}

TEST(Identify, FindsTheHalfSpaceFromItsTwoStiffnesses) {
  constexpr double kRadius = 2.5, kModulus = 0.12, kPoisson = 0.4;
  const double normal = 2 * kRadius * kModulus / (1 - kPoisson * kPoisson);
  const double tangential = normal * 2 * (1 - kPoisson) / (2 - kPoisson);
  const Identification found =
      identify_half_space(probed_half_space(normal, tangential), kRadius).report;
  EXPECT_EQ(found.verdict, Verdict::describes);
  const ParameterEstimate& modulus = parameter(found, "Young's modulus");
  const ParameterEstimate& ratio = parameter(found, "Poisson's ratio");
  EXPECT_NEAR(*modulus.value, kModulus, 3 * *modulus.standard_error);
  EXPECT_NEAR(*ratio.value, kPoisson, 3 * *ratio.standard_error);
  EXPECT_LT(*ratio.standard_error, 0.05);
}

/// A half-space that an arm drags near the friction boundary: forces vary about the commanded ones,
/// `shared` of the variance in the same way in both positions of a sample, and the tool holds where
/// the force is inside the cone.
probing::Acquisition dragged_half_space(double normal, double tangential, double shared,
                                        unsigned seed) {
  constexpr double kPositionNoise = 0.02, kTremor = 0.01;  // [mm], [N]
  constexpr double kFriction = 0.7;
  std::mt19937 random(seed);
  std::normal_distribution<double> one;
  const auto noise = [&](double size) {
    return Eigen::Vector3d{size * one(random), size * one(random), size * one(random)};
  };
  const Eigen::Vector3d compliance(1 / tangential, 1 / tangential, 1 / normal);
  probing::Acquisition acquisition;
  for (int c = 0; c < 12; ++c) {
    acquisition.contacts.push_back({c, {10.0 * c, 3, 700}, {0, 0, -1}});
    const Eigen::Vector3d at = acquisition.contacts.back().position;
    for (int level = 0; level < 6; ++level) {
      const double pressed = 0.15 * std::pow(1.7, level);
      for (int k = 0; k < 8; ++k) {
        // Half a deviation inside of the boundary, and as much outside, in four directions.
        const double angle = 0.8 * level + std::numbers::pi / 2 * (k / 2);
        const double drag = kFriction * pressed + (k % 2 == 0 ? -0.5 : 0.5) * kTremor;
        const Eigen::Vector3d force(drag * std::cos(angle), drag * std::sin(angle), pressed);
        const Eigen::Vector3d steady = noise(kTremor * std::sqrt(shared));
        const Eigen::Vector3d first = steady + noise(kTremor * std::sqrt(1 - shared)),
                              second = steady + noise(kTremor * std::sqrt(1 - shared));
        const Eigen::Vector3d real = force + second;
        acquisition.samples.push_back(
            {.id = static_cast<long long>(acquisition.samples.size()),
             .contact = c,
             .group = level + 10 * c,
             .force = force,
             .a = at + compliance.cwiseProduct(Eigen::Vector3d(0, 0, pressed) + first) +
                  noise(kPositionNoise),
             .b = at + compliance.cwiseProduct(real) + noise(kPositionNoise),
             .slipped = std::hypot(real.x(), real.y()) > kFriction * real.z()});
      }
    }
  }
  return acquisition;
}

TEST(Identify, StatesTheErrorsOfAHalfSpaceThatWasDraggedNearSlipping) {
  constexpr double kRadius = 3, kModulus = 0.083, kPoisson = 0.38;
  constexpr int kSeeds = 12;
  const double normal = 2 * kRadius * kModulus / (1 - kPoisson * kPoisson);
  const double tangential = normal * 2 * (1 - kPoisson) / (2 - kPoisson);
  for (const double shared : {0.0, 0.5}) {
    double modulus = 0, ratio = 0;  // squared errors in units of the stated ones
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const Identification found =
          identify_half_space(dragged_half_space(normal, tangential, shared, seed), kRadius).report;
      EXPECT_EQ(found.verdict, Verdict::describes);
      const auto square = [&](const char* name, double truth) {
        const ParameterEstimate& estimate = parameter(found, name);
        return std::pow((estimate.value.value() - truth) / estimate.standard_error.value(), 2);
      };
      modulus += square("Young's modulus", kModulus) / kSeeds;
      ratio += square("Poisson's ratio", kPoisson) / kSeeds;
    }
    EXPECT_LT(std::sqrt(modulus), 1.5) << shared;
    EXPECT_GT(std::sqrt(modulus), 0.5) << shared;
    EXPECT_LT(std::sqrt(ratio), 1.5) << shared;
    EXPECT_GT(std::sqrt(ratio), 0.5) << shared;
  }
}

TEST(Identify, NamesWhatTheDataDoNotDetermine) {
  const Identification normal_only = identify_half_space(probed_half_space(1, 1, true), 2).report;
  EXPECT_EQ(parameter(normal_only, "Poisson's ratio").status, ParameterStatus::undetermined);
  EXPECT_FALSE(parameter(normal_only, "Poisson's ratio").value.has_value());
  // All contacts on one line along the strip: how it varies across does not show.
  const Strip strip;
  const StripProbing probing = few(1);
  probing::Acquisition line;
  palpate::support::StripProbe probe(strip, probing);
  for (const double x : {-42, -14, 14, 42}) probe.probe(line, x, 0);
  const Identification found = identify_strip(line).report;
  EXPECT_EQ(parameter(found, "slope").status, ParameterStatus::undetermined);
  EXPECT_EQ(parameter(found, "curvature").status, ParameterStatus::undetermined);
  EXPECT_EQ(parameter(found, "axial stiffness").status, ParameterStatus::determined);
}

TEST(Identify, DoesNotDependOnFrameUnitAndOrder) {
  const probing::Acquisition measured = strip_acquisition({}, few(3));
  const IdentifiedStrip before = identify_strip(measured);
  probing::Acquisition moved = measured;
  std::reverse(moved.samples.begin(), moved.samples.end());
  const Eigen::Matrix3d rotation = some_rotation();
  constexpr double kUnit = 1e-3;  // metres
  for (probing::Contact& contact : moved.contacts) {
    contact.position = kUnit * (rotation * contact.position);
    contact.normal = rotation * contact.normal;
  }
  for (probing::Sample& sample : moved.samples) {
    sample.a = kUnit * (rotation * sample.a);
    sample.b = kUnit * (rotation * sample.b);
    sample.force = rotation * sample.force;
  }
  const IdentifiedStrip after = identify_strip(moved);
  constexpr double kTol = 1e-3;  // relative; far below the standard errors
  EXPECT_NEAR(after.model.tension, before.model.tension, kTol * before.model.tension);
  EXPECT_NEAR(after.model.axial_stiffness, before.model.axial_stiffness,
              kTol * before.model.axial_stiffness);
  EXPECT_NEAR(after.model.low_support, kUnit * before.model.low_support, kUnit * kTol * 50);
  EXPECT_NEAR(after.model.compliance, kUnit * before.model.compliance, kUnit * kTol);
  EXPECT_LT((after.model.axis - rotation * before.model.axis).norm(), kTol);
  EXPECT_NEAR(*after.report.chi2, *before.report.chi2, kTol);
}

TEST(Identify, LeavesSingleOutliersOut) {
  probing::Acquisition measured = strip_acquisition({}, few(4));
  for (std::size_t i = 0; i < measured.samples.size(); i += 40) {
    measured.samples[i].b += Eigen::Vector3d(0.6, -0.7, 0.5);
  }
  const IdentifiedStrip found = identify_strip(measured);
  EXPECT_EQ(found.report.verdict, Verdict::describes);
  EXPECT_GT(found.report.outliers, 0);
  EXPECT_NEAR(found.model.axial_stiffness, 42, 2);
}

TEST(Identify, RefusesWhatItCannotUse) {
  probing::Acquisition measured = probed_half_space(1, 0.8);
  EXPECT_THAT(refusal([&] { return identify_half_space(measured, 0); }), HasSubstr("radius"));
  EXPECT_THAT(refusal([&] { return identify_strip(measured, {.displacement_noise = 0.1}); }),
              HasSubstr("both"));
  EXPECT_THAT(refusal([&] { return identify_strip(measured, {.max_chi2 = 0.5}); }),
              HasSubstr("max_chi2"));
  probing::Acquisition without = measured;
  without.samples.clear();
  EXPECT_THAT(refusal([&] { return identify_half_space(without, 2); }), HasSubstr("0 samples"));
  measured.samples[7].b.y() = std::nan("");
  EXPECT_FALSE(refusal([&] { return identify_strip(measured); }).empty());
}

TEST(Identify, CannotJudgeWithoutRepeatedPositionsOrTheirNoise) {
  probing::Acquisition measured = probed_half_space(1, 0.8);
  for (probing::Sample& sample : measured.samples) sample.group = sample.id;
  EXPECT_EQ(identify_half_space(measured, 2).report.verdict, Verdict::not_testable);
  EXPECT_EQ(identify_half_space(measured, 2, {.displacement_noise = 0.014, .force_noise = 0})
                .report.verdict,
            Verdict::describes);
}

}  // namespace
}  // namespace palpate::haptics
