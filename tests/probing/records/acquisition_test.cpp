// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "not_finite.h"
#include "records/probing_testing.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string refused_acquisition(const Acquisition& acquisition) {
  return refusal([&] { return CheckedAcquisition(acquisition); });
}

TEST(CheckedAcquisition, AcceptsWhatAnArmMeasures) {
  EXPECT_NO_THROW((void)CheckedAcquisition(small_acquisition()));
}

TEST(CheckedAcquisition, RefusesAnEmptyAcquisition) {
  EXPECT_THAT(refused_acquisition({}), HasSubstr("no contact"));
}

TEST(CheckedAcquisition, NamesTheContactThatIsWrong) {
  Acquisition acquisition = small_acquisition();
  acquisition.contacts[1].position.y() = kNaN;
  EXPECT_THAT(refused_acquisition(acquisition),
              AllOf(HasSubstr("contact 8"), HasSubstr("not finite")));
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0, kNaN, 1)}) {
    acquisition = small_acquisition();
    acquisition.contacts[1].normal = normal;
    EXPECT_THAT(refused_acquisition(acquisition),
                AllOf(HasSubstr("contact 8"), HasSubstr("unit vector")));
  }
  acquisition = small_acquisition();
  acquisition.contacts[1].id = 3;
  EXPECT_THAT(refused_acquisition(acquisition), AllOf(HasSubstr("contact 3"), HasSubstr("unique")));
}

TEST(CheckedAcquisition, RefusesTwoContactsAtOnePlaceAtAnyScale) {
  for (const double scale : {0x1p-30, 1.0, 0x1p30}) {
    Acquisition acquisition = small_acquisition();
    acquisition.contacts.push_back({5, acquisition.contacts[0].position, {0, 0, 1}});
    acquisition.contacts.back().position.z() += 1e-7;
    for (Contact& contact : acquisition.contacts) contact.position *= scale;
    EXPECT_THAT(refused_acquisition(acquisition), HasSubstr("contacts 3 and 5 are at one place"));
    acquisition.contacts.back().position.z() += 1e-3 * scale;
    EXPECT_NO_THROW((void)CheckedAcquisition(acquisition));
  }
}

TEST(CheckedAcquisition, FindsOnePlaceAmongManyContactsWithTheSameX) {
  Acquisition acquisition;
  for (int i = 0; i < 50; ++i)
    acquisition.contacts.push_back({i, {1.7, static_cast<double>(i * 37 % 50), 0}, {0, 0, 1}});
  EXPECT_NO_THROW((void)CheckedAcquisition(acquisition));
  acquisition.contacts.push_back({50, acquisition.contacts[31].position, {0, 0, 1}});
  EXPECT_THAT(refused_acquisition(acquisition), HasSubstr("contacts 31 and 50"));
}

TEST(CheckedAcquisition, NamesTheSampleThatIsWrong) {
  const auto refused_with = [](auto change) {
    Acquisition acquisition = small_acquisition();
    change(acquisition.samples[2]);
    return refused_acquisition(acquisition);
  };
  EXPECT_THAT(refused_with([](Sample& s) { s.contact = 4; }),
              AllOf(HasSubstr("sample 7"), HasSubstr("no contact 4")));
  EXPECT_THAT(refused_with([](Sample& s) { s.force.x() = kNaN; }), HasSubstr("sample 7"));
  EXPECT_THAT(refused_with([](Sample& s) { s.a.x() = -1 / 0.0; }), HasSubstr("sample 7"));
  EXPECT_THAT(refused_with([](Sample& s) { s.b.x() = kNaN; }), HasSubstr("sample 7"));
  EXPECT_THAT(refused_with([](Sample& s) { s.time = -0.5; }),
              AllOf(HasSubstr("sample 7"), HasSubstr(">= 0")));
  EXPECT_THAT(refused_with([](Sample& s) { s.time = kNaN; }), HasSubstr("sample 7"));
  EXPECT_THAT(refused_with([](Sample& s) { s.id = 1; }),
              AllOf(HasSubstr("sample 1"), HasSubstr("unique")));
  EXPECT_THAT(refused_with([](Sample& s) { s.slipped = s.on_friction_boundary = true; }),
              AllOf(HasSubstr("sample 7"), HasSubstr("both")));
}

TEST(CheckedAcquisition, RefusesForcesAndLengthsThatNobodyMeasures) {
  for (const double bad : {1.1e12, -1e155, 1e300}) {
    Acquisition acquisition = small_acquisition();
    acquisition.contacts[1].position.x() = bad;
    EXPECT_THAT(refused_acquisition(acquisition),
                AllOf(HasSubstr("contact 8"), HasSubstr("1e12 mm")));
    for (Eigen::Vector3d Sample::*vector : {&Sample::force, &Sample::a, &Sample::b}) {
      acquisition = small_acquisition();
      (acquisition.samples[2].*vector).y() = bad;
      EXPECT_THAT(refused_acquisition(acquisition),
                  AllOf(HasSubstr("sample 7"), HasSubstr("1e12 N")));
    }
    acquisition = small_acquisition();
    acquisition.probe_radius = std::abs(bad);
    EXPECT_THAT(refused_acquisition(acquisition), HasSubstr("probe_radius"));
  }
}

std::vector<long long> ids_of(std::span<const Sample> samples) {
  std::vector<long long> ids;
  for (const Sample& sample : samples) ids.push_back(sample.id);
  return ids;
}

TEST(CheckedAcquisition, KeepsTheSamplesOfAContactTogetherInTheirOrder) {
  Acquisition mixed;
  mixed.contacts = {
      {30, {0, 0, 0}, {0, 0, 1}}, {-7, {1, 0, 0}, {0, 0, 1}}, {12, {2, 0, 0}, {0, 0, 1}}};
  for (const auto& [id, contact] :
       std::vector<std::pair<long long, long long>>{{5, 12}, {4, 30}, {9, 12}, {2, 30}, {8, 30}}) {
    mixed.samples.push_back({.id = id, .contact = contact});
  }
  const CheckedAcquisition acquisition = mixed;
  EXPECT_THAT(ids_of(acquisition.samples_of(0)), ElementsAre(4, 2, 8));
  EXPECT_THAT(ids_of(acquisition.samples_of(1)), IsEmpty());
  EXPECT_THAT(ids_of(acquisition.samples_of(2)), ElementsAre(5, 9));
  EXPECT_THAT(ids_of(acquisition.samples()), ElementsAre(4, 2, 8, 5, 9));
  EXPECT_EQ(acquisition.find(12), 2u);
  EXPECT_EQ(acquisition.find(99), std::nullopt);
}

}  // namespace
}  // namespace palpate::probing
