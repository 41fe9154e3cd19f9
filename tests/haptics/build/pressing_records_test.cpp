// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/pressing_records.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "build/synthetic_acquisition.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/evaluate.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// [N] of an object that hardens, at its contacts; stiffer at contacts with larger ids.
double true_force(long long id, double depth) {
  return 0.02 * static_cast<double>(id) * (depth + depth * depth / 8);
}

// Exactly collinear, as recorded without noise and printed with four digits.
probing::Acquisition pressed_flat() {
  probing::Acquisition acquisition;
  acquisition.contacts = flat_acquisition().contacts;
  for (const probing::Contact& contact : acquisition.contacts) {
    for (int s = 1; s <= 6; ++s) {
      const double depth = 0.5 * s;
      probing::Sample sample;
      sample.id = sample.group = static_cast<long long>(acquisition.samples.size());
      sample.contact = contact.id;
      sample.force.z() = std::round(1e4 * true_force(contact.id, depth)) / 1e4;
      sample.a = sample.b = contact.position + Vector3d(0, 0, depth);
      acquisition.samples.push_back(sample);
    }
  }
  return acquisition;
}

TEST(BuildModel, FollowsCollinearPressesAndIsSoftAcross) {
  const BuildResult built = build_model(pressed_flat(), flat_surface());
  ASSERT_TRUE(built.pressing);
  for (std::size_t i = 0; i < built.contacts.size(); ++i) {
    const ContactModel& contact = built.model.contacts[i];
    const double largest = true_force(contact.id, 3);
    for (const double depth : {0.5, 1.25, 3.0})
      EXPECT_NEAR(force(contact.field, {0, 0, depth}).z(), true_force(contact.id, depth),
                  0.01 * largest);
    EXPECT_EQ(contact.samples, 6);  // a sample with a = b counts once
    // Half-space: 0.71 of the normal stiffness, here of the secant at 0.7 times the reach.
    const double across = kHalfSpaceRatio * true_force(contact.id, 2.1) / 2.1;
    EXPECT_NEAR(stiffness(contact.field, {0, 0, 1})(0, 0), across, 0.05 * across);
  }
}

using ForceAt = std::function<double(double x, double depth)>;

// Springs at 36 contacts 14 mm apart, recorded with four digits.
probing::Acquisition pressed_springs(const ForceAt& force_at) {
  probing::Acquisition acquisition;
  for (int i = 0; i < 36; ++i) {
    const Vector3d place(14 * (i % 6) - 35, 14 * (i / 6) - 35, 700);
    acquisition.contacts.push_back({i, place, {0, 0, -1}});
    for (int s = 1; s <= 4; ++s) {
      probing::Sample sample;
      sample.id = sample.group = static_cast<long long>(acquisition.samples.size());
      sample.contact = i;
      sample.force.z() = std::round(1e4 * force_at(place.x(), s)) / 1e4;
      sample.a = sample.b = place + Vector3d(0, 0, s);
      acquisition.samples.push_back(sample);
    }
  }
  return acquisition;
}

TEST(BuildModel, BlendsWhatPredictsLeftOutPlacesBetter) {
  const auto rule_of = [](const ForceAt& force_at) {
    const BuildResult built = build_model(pressed_springs(force_at), flat_surface());
    EXPECT_TRUE(built.rule_errors);
    return built.model.interpolation.rule;
  };
  // One curve of the depth, with a factor in front of the force or of the depth.
  const auto curve = [](double depth) { return depth + 0.3 * depth * depth * depth; };
  EXPECT_EQ(rule_of([&](double x, double depth) { return (0.5 + 0.012 * x) * curve(depth); }),
            BlendRule::forces);
  EXPECT_EQ(rule_of([&](double x, double depth) { return curve(depth / (2 + 0.025 * x)); }),
            BlendRule::compliances);
}

// A sheet that stiffens above a block, pressed along z at five forces and recorded to 0.01 mm and
// 1 mN. With so few depths its curves look like those of a sensor with an offset.
probing::Acquisition sheet_above_block() {
  const support::Strip sheet{.block = 1.5};
  const support::StripProbing probing;
  probing::Acquisition acquisition;
  for (const Eigen::Vector2d& at : support::strip_places(probing)) {
    const auto id = static_cast<long long>(acquisition.contacts.size());
    acquisition.contacts.push_back({id, {at.x(), at.y(), 700}, {0, 0, -1}});
    for (const double force : probing.normal_forces) {
      const double depth = support::strip_displacement(sheet, at.x(), at.y(), {0, 0, force}).z();
      probing::Sample sample;
      sample.id = sample.group = static_cast<long long>(acquisition.samples.size());
      sample.contact = id;
      sample.force.z() = force;
      sample.a = sample.b =
          acquisition.contacts.back().position + Vector3d(0, 0, std::round(100 * depth) / 100);
      acquisition.samples.push_back(sample);
    }
  }
  return acquisition;
}

TEST(BuildModel, TakesNoOffsetsThatPredictLeftOutPlacesWorse) {
  const BuildResult built = build_model(sheet_above_block(), flat_surface(75, 30));
  ASSERT_TRUE(built.pressing);
  EXPECT_FALSE(built.pressing->offsets.force_found);
  EXPECT_FALSE(built.pressing->offsets.touch_found);
}

TEST(BuildModel, LeavesRichAcquisitionsToTheFitOfEachContact) {
  EXPECT_FALSE(build_model(flat_acquisition(), flat_surface()).pressing);
}

TEST(LeaveOneOut, IsNotMisledByAConstantErrorOfTheForces) {
  probing::Acquisition biased = pressed_flat();
  const LeaveOneOut plain =
      leave_one_out(build_model(biased, flat_surface()).model, probing::CheckedAcquisition(biased));
  for (probing::Sample& sample : biased.samples) sample.force += Vector3d(0, 0, 0.3);
  const Model model = build_model(biased, flat_surface()).model;
  ASSERT_TRUE(model.pressing_offsets);
  EXPECT_TRUE(model.pressing_offsets->along_direction);
  EXPECT_LT(leave_one_out(model, probing::CheckedAcquisition(biased)).rms, plain.rms + 0.05);
}

TEST(LeaveOneOut, ReadsNothingThatWasWrittenForPeople) {
  probing::Acquisition biased = pressed_flat();
  for (probing::Sample& sample : biased.samples) sample.force += Vector3d(0, 0, 0.3);
  Model model = build_model(biased, flat_surface()).model;
  const double rms = leave_one_out(model, probing::CheckedAcquisition(biased)).rms;
  using Texts = std::map<std::string, std::string>;
  for (const Texts& made : {Texts{}, Texts{{"pressing_offsets", "9 9 9 N along, 9 mm"},
                                           {"samples_fingerprint", "of others"},
                                           {"triangulation", "by hand"}}}) {
    model.made = made;
    EXPECT_EQ(leave_one_out(model, probing::CheckedAcquisition(biased)).rms, rms);
  }
  model.pressing_offsets->force.z() += 0.2;  // these are read
  EXPECT_GT(leave_one_out(model, probing::CheckedAcquisition(biased)).rms, rms + 0.1);
}

}  // namespace
}  // namespace palpate::haptics
