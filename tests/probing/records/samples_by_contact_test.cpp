// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/samples_by_contact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::probing {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<long long> ids_of(const SamplesByContact& samples, std::size_t contact) {
  std::vector<long long> ids;
  for (const Sample& sample : samples.of(contact)) ids.push_back(sample.id);
  return ids;
}

TEST(SamplesByContact, FindsThemInTheirOrderHoweverTheyAreMixed) {
  Acquisition acquisition;
  acquisition.contacts.resize(3);
  acquisition.contacts[0].id = 30;
  acquisition.contacts[1].id = -7;
  acquisition.contacts[2].id = 12;
  for (const auto& [id, contact] : std::vector<std::pair<long long, long long>>{
           {5, 12}, {4, 30}, {9, 12}, {1, 99}, {2, 30}, {8, 30}}) {
    Sample sample;
    sample.id = id;
    sample.contact = contact;
    acquisition.samples.push_back(sample);
  }
  const SamplesByContact samples(acquisition);
  EXPECT_THAT(ids_of(samples, 0), ElementsAre(4, 2, 8));
  EXPECT_THAT(ids_of(samples, 1), IsEmpty());
  EXPECT_THAT(ids_of(samples, 2), ElementsAre(5, 9));
  EXPECT_EQ(samples.count(0), 3u);
  EXPECT_EQ(samples.count(1), 0u);
}

TEST(SamplesByContact, OfNothingAreNone) {
  Acquisition acquisition;
  EXPECT_NO_THROW(SamplesByContact{acquisition});
  acquisition.contacts.resize(1);
  EXPECT_THAT(SamplesByContact(acquisition).of(0), IsEmpty());
}

}  // namespace
}  // namespace palpate::probing
