// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/fingerprint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpate::probing {
namespace {

Acquisition some_acquisition() {
  Acquisition acquisition;
  acquisition.contacts = {{1, {0, 0, 700}, {0, 0, -1}}, {2, {10, 0, 700}, {0, 0, -1}}};
  acquisition.samples = {
      {.id = 1, .contact = 1, .group = 1, .force = {0, 0, 2}, .a = {0, 0, 703}, .b = {0, 0, 703}},
      {.id = 2,
       .contact = 2,
       .group = 2,
       .force = {1, 0, 2},
       .a = {10, 0, 703},
       .b = {12, 0, 703}}};
  return acquisition;
}

TEST(Fingerprint, DiffersWhereAnythingMeasuredDoes) {
  const std::vector<std::function<void(Acquisition&)>> changes = {
      [](Acquisition&) {},
      [](Acquisition& a) { a.contacts[0].id = 3; },
      [](Acquisition& a) { a.contacts[1].position.x() += 1e-12; },
      [](Acquisition& a) {
        a.contacts[1].normal = {0, 1, 0};
      },
      [](Acquisition& a) { a.contacts.pop_back(); },
      [](Acquisition& a) { a.samples.pop_back(); },
      [](Acquisition& a) { a.samples.push_back(a.samples[0]); },
      [](Acquisition& a) { a.samples[0].contact = 2; },
      [](Acquisition& a) { a.samples[0].group = 2; },
      [](Acquisition& a) { a.samples[1].force.y() = 1e-9; },
      [](Acquisition& a) { a.samples[1].a.y() = 1e-9; },
      [](Acquisition& a) { a.samples[1].b.y() = 1e-9; },
      [](Acquisition& a) { std::swap(a.samples[1].a, a.samples[1].b); },
      [](Acquisition& a) { a.samples[1].slipped = true; },
      [](Acquisition& a) { a.samples[1].on_friction_boundary = true; }};
  std::set<std::string> found;
  for (const auto& change : changes) {
    Acquisition acquisition = some_acquisition();
    change(acquisition);
    found.insert(fingerprint(acquisition));
    EXPECT_EQ(found.rbegin()->find_first_not_of("0123456789abcdef"), std::string::npos);
    EXPECT_EQ(found.rbegin()->size(), 16u);
  }
  EXPECT_EQ(found.size(), changes.size());
}

TEST(Fingerprint, IsThatOfWhatWasMeasuredAndNotOfHowItIsKept) {
  Acquisition acquisition = some_acquisition();
  std::reverse(acquisition.contacts.begin(), acquisition.contacts.end());
  std::reverse(acquisition.samples.begin(), acquisition.samples.end());
  acquisition.samples[0].id = 77;
  acquisition.samples[0].time = 12;
  acquisition.samples[1].force.x() = -0.0;
  acquisition.meta["arm"] = "left";
  EXPECT_EQ(fingerprint(acquisition), fingerprint(some_acquisition()));
}

}  // namespace
}  // namespace palpate::probing
