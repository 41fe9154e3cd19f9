// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/identify_solid.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "haptics_testing.h"
#include "palpate/probing/specimen.h"
#include "palpate/probing/specimen_file.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

// A block of 40 x 40 x 16 mm, divided into `cells`, with an inclusion.
std::string block_with_inclusion(const std::string& cells, double shear, double inclusion,
                                 double bulk) {
  const auto text = [](double value) { return std::to_string(value); };
  return R"({"type": "finite_elements", "size": [40, 40, 16], "cells": )" + cells +
         R"(, "tip_radius": 5, "shear_modulus": )" + text(shear) + R"(, "bulk_modulus": )" +
         text(bulk * shear) +
         R"(, "regions": [{"low": [0, -21, 699], "high": [21, 21, 717], "shear_modulus": )" +
         text(inclusion) + R"(, "bulk_modulus": )" + text(bulk * inclusion) + "}]}";
}

/// What is probed of a solid.
struct ProbedParts {
  std::vector<int> contacts = {0, 1, 2, 3, 4, 5};
  double force = 1;  ///< unit of the forces
};

// Two presses and drags at each contact, with noise of position [mm] alone.
probing::Acquisition probed_solid(const std::string& specimen_text, double noise, unsigned seed,
                                  const ProbedParts& probed = {}) {
  const auto specimen = probing::parse_specimen(specimen_text, "solid.json");
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  const auto noisy = [&](const Vector3d& at) {
    return Vector3d(at + Vector3d{normal(random), normal(random), normal(random)});
  };
  probing::Acquisition acquisition;
  acquisition.probe_radius = 5;
  long long sample = 0;
  for (const int c : probed.contacts) {
    const Vector3d place(-11 + 11.0 * (c % 3), -6 + 12.0 * (c / 3), 700);
    acquisition.contacts.push_back({c, place, {0, 0, -1}});
    const auto contact = specimen->at(place);
    for (int level = 0; level < 2; ++level) {
      const Vector3d press(0, 0, probed.force * (0.4 + 0.6 * level));
      const Vector3d pressed = contact->displacement(press);
      for (int k = 0; k < 4; ++k) {
        const double angle = 1.57 * k + 0.3 * c;
        const Vector3d drag = 0.3 * press.z() * Vector3d(std::cos(angle), std::sin(angle), 0);
        acquisition.samples.push_back({.id = sample++,
                                       .contact = c,
                                       .group = level,
                                       .force = press + drag,
                                       .a = noisy(place + pressed),
                                       .b = noisy(place + contact->displacement(press + drag))});
      }
    }
  }
  return acquisition;
}

TEST(IdentifySolid, FindsModuliOfAFinerMeshWithinItsErrors) {
  // Measured on 8 x 8 x 3 cells, which no mesh of the estimate has.
  const probing::Acquisition measured =
      probed_solid(block_with_inclusion("[8, 8, 3]", 0.05, 0.12, 8), 0.01, 1);
  // All moduli given are 0.4 times the truth, and the inclusion is unknown.
  const probing::FiniteElementObject given = probing::parse_finite_elements(
      block_with_inclusion("[6, 6, 2]", 0.02, 0.02, 15), "given.json");
  const IdentifiedSolid found = identify_solid(measured, given, {.max_pairs = 24, .mesh_pairs = 4});
  ASSERT_EQ(found.report.parameters.size(), 4U);
  const double truths[2] = {0.05, 0.12};
  for (std::size_t k = 0; k < 2; ++k) {
    const ParameterEstimate& shear = found.report.parameters[k];
    ASSERT_EQ(shear.status, ParameterStatus::determined) << shear.name;
    EXPECT_NEAR(*shear.value, truths[k], 0.2 * truths[k]) << shear.name;
    EXPECT_LT(std::abs(*shear.value - truths[k]), 3 * *shear.standard_error) << shear.name;
    EXPECT_LT(*shear.standard_error, 0.35 * truths[k]) << shear.name;
    EXPECT_EQ(found.object.body.materials[k].shear_modulus, *shear.value);
  }
  // The correction for the mesh goes the right way.
  const double corrected = *found.report.parameters[0].value,
               uncorrected = corrected + found.mesh_errors[0];
  EXPECT_LT(std::abs(corrected - truths[0]), std::abs(uncorrected - truths[0]));
  EXPECT_EQ(found.report.parameters[3].name, "friction");
  EXPECT_EQ(found.report.parameters[3].status, ParameterStatus::undetermined);  // nothing slipped
  EXPECT_EQ(found.report.verdict, Verdict::describes) << found.report.chi2.value_or(-1);
  EXPECT_TRUE(found.left_out.empty());
  EXPECT_FALSE(found.presses.empty());
}

TEST(IdentifySolid, FollowsTheUnitOfForce) {
  const auto fitted = [](double unit) {
    const probing::Acquisition measured =
        probed_solid(block_with_inclusion("[4, 4, 2]", 0.05 * unit, 0.1 * unit, 10), 0.01, 3,
                     {.contacts = {0, 2}, .force = unit});
    const probing::FiniteElementObject given = probing::parse_finite_elements(
        block_with_inclusion("[4, 4, 2]", 0.05, 0.05, 10), "given.json");
    return identify_solid(measured, given, {.max_pairs = 8, .mesh_pairs = 0},
                          {.displacement_noise = 0.01, .force_noise = 0});
  };
  const IdentifiedSolid once = fitted(1), ten = fitted(10);
  for (std::size_t k = 0; k < 2; ++k) {
    const double value = *once.report.parameters[k].value;
    EXPECT_NEAR(*ten.report.parameters[k].value, 10 * value, 0.01 * 10 * value);
    EXPECT_NEAR(value, 0.05 * static_cast<double>(k + 1), 0.005);
    EXPECT_TRUE(std::isnan(once.mesh_errors[k]));
  }
}

TEST(IdentifySolid, SaysWhatPressesAloneDoNotDetermine) {
  // Small forces at one contact above the soft side.
  const probing::Acquisition measured =
      probed_solid(block_with_inclusion("[4, 4, 2]", 0.05, 0.1, 10), 0.02, 2, {.contacts = {0}});
  const IdentifiedSolid found = identify_solid(
      measured,
      probing::parse_finite_elements(block_with_inclusion("[4, 4, 2]", 0.05, 0.1, 10), "a.json"),
      {.max_pairs = 6, .mesh_pairs = 0});
  EXPECT_EQ(found.report.parameters[0].status, ParameterStatus::determined);
  EXPECT_NE(found.report.parameters[1].status, ParameterStatus::determined) << "the inclusion";
  EXPECT_NE(found.report.parameters[2].status, ParameterStatus::determined) << "the bulk modulus";
  // A value that is not determined stays as it was given (the common factor is one here).
  EXPECT_EQ(found.object.body.materials[1].shear_modulus, 0.1);
}

TEST(IdentifySolid, LeavesOutASampleThatPullsAndOneThatNothingHolds) {
  const std::string text = block_with_inclusion("[4, 4, 2]", 0.05, 0.1, 10);
  // One contact above each material.
  probing::Acquisition measured = probed_solid(text, 0.01, 4, {.contacts = {0, 2}});
  const auto fitted = [&] {
    return identify_solid(measured, probing::parse_finite_elements(text, "a.json"),
                          {.max_pairs = 1000, .mesh_pairs = 0});
  };
  const IdentifiedSolid right = fitted();
  measured.samples[1].force *= -1;
  measured.samples[9].force.head<2>() *= 50;  // beyond the friction of any surface
  const IdentifiedSolid found = fitted();
  EXPECT_LT(found.report.pairs, right.report.pairs);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(*found.report.parameters[k].value, *right.report.parameters[k].value,
                0.02 * *right.report.parameters[k].value);
}

TEST(IdentifySolid, RefusesMeasurementsOfAnotherObjectOrTip) {
  const std::string text = block_with_inclusion("[4, 4, 2]", 0.05, 0.05, 10);
  const probing::FiniteElementObject given = probing::parse_finite_elements(text, "a.json");
  probing::Acquisition measured;
  measured.contacts = {{3, {0, 0, 750}, {0, 0, -1}}};
  measured.samples = {
      {.id = 1, .contact = 3, .force = {0, 0, 1}, .a = {0, 0, 751}, .b = {0, 0, 751}}};
  EXPECT_THAT(refusal([&] { return identify_solid(measured, given); }),
              HasSubstr("contact 3 is 50 mm from the probed surface"));
  measured.contacts[0].position.z() = 700;
  measured.probe_radius = 3;
  EXPECT_THAT(refusal([&] { return identify_solid(measured, given); }),
              HasSubstr("tip_radius of 5 mm"));
  measured.probe_radius.reset();
  EXPECT_THAT(refusal([&] { return identify_solid(measured, given, {.max_pairs = 0}); }),
              HasSubstr("max_pairs"));
  EXPECT_THAT(refusal([&] { return identify_solid(measured, given, {}, {.force_noise = 1}); }),
              HasSubstr("force_noise"));
  measured.contacts[0].position = {1.5, 0, 698};
  measured.contacts[0].normal = Vector3d(1, 0, -1).normalized();  // of another surface
  EXPECT_THAT(refusal([&] { return identify_solid(measured, given); }),
              HasSubstr("(1.414 mm across"));
  measured.contacts[0] = {3, {0, 0, 700}, {0, 0, -1}};
  measured.samples[0].force = {0, 0, -1};
  EXPECT_THAT(refusal([&] { return identify_solid(measured, given); }),
              HasSubstr("no sample presses"));
}

}  // namespace
}  // namespace palpate::haptics
