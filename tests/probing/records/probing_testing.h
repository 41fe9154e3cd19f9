// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "palpate/probing/acquisition.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::probing {

/// Two contacts, three samples, numbers that decimal digits cannot hold exactly.
inline Acquisition small_acquisition() {
  Acquisition acquisition;
  acquisition.contacts = {{3, {0.1, -1.0 / 3, 700.7}, {0, 0.6, -0.8}},
                          {8, {10.3, 2, 701}, {0, 0, -1}}};
  acquisition.samples = {
      {1, 3, 0, {0.1, 0.2, 1e-17}, {1, 2, 3}, {4, 5, 6}, true, false, {}, 0},
      {2, 3, 0, {0.3, 0.2, 1.1}, {1, 2, 3}, {4, 5, 6}, false, true, "range/7, left.tiff", 12.1},
      {7, 8, 1, {-0.3, 0.2, 2.0 / 3}, {1, 2, 3}, {4, 5, 1e12}, false, false, {}, 24.2}};
  return acquisition;
}

inline void expect_same(const CheckedAcquisition& checked, const Acquisition& right) {
  const Acquisition& left = checked.records();
  ASSERT_EQ(left.contacts.size(), right.contacts.size());
  ASSERT_EQ(left.samples.size(), right.samples.size());
  for (std::size_t i = 0; i < left.contacts.size(); ++i) {
    EXPECT_EQ(left.contacts[i].id, right.contacts[i].id);
    EXPECT_EQ(left.contacts[i].position, right.contacts[i].position);
    EXPECT_EQ(left.contacts[i].normal, right.contacts[i].normal);
  }
  for (std::size_t i = 0; i < left.samples.size(); ++i) {
    const Sample &l = left.samples[i], &r = right.samples[i];
    EXPECT_EQ(l.id, r.id);
    EXPECT_EQ(l.contact, r.contact);
    EXPECT_EQ(l.group, r.group);
    EXPECT_EQ(l.force, r.force);
    EXPECT_EQ(l.a, r.a);
    EXPECT_EQ(l.b, r.b);
    EXPECT_EQ(l.on_friction_boundary, r.on_friction_boundary);
    EXPECT_EQ(l.slipped, r.slipped);
    EXPECT_EQ(l.range_map, r.range_map);
    EXPECT_EQ(l.time, r.time);
  }
}

}  // namespace palpate::probing
