// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/pair_selection.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// Three contacts with two levels; to each the settled pair and eight that were dragged.
std::vector<Pair> many_pairs() {
  std::vector<Pair> pairs;
  for (std::size_t contact = 0; contact < 3; ++contact) {
    for (int level = 1; level <= 2; ++level) {
      const std::size_t settled = pairs.size();
      for (int k = 0; k <= 8; ++k) {
        const double angle = 0.8 * k;
        const Vector3d drag =
            k == 0 ? Vector3d(0, 0, 0)
                   : Vector3d(0.4 * level * std::cos(angle), 0.4 * level * std::sin(angle), 0);
        pairs.push_back({.contact = contact,
                         .settled = settled,
                         .displacement = {0, 0, 1},
                         .force = Vector3d(0, 0, level) + drag});
      }
    }
  }
  return pairs;
}

const std::vector<probing::Contact> kThreeContacts{
    {0, {0, 0, 0}, {0, 0, -1}}, {1, {1, 0, 0}, {0, 0, -1}}, {2, {50, 0, 0}, {0, 0, -1}}};

TEST(PairSelection, SpreadsOverContactsAndForcesAndKeepsTheNormalForces) {
  const std::vector<Pair> few = spread_pairs(many_pairs(), kThreeContacts, {true, false, true}, 8);
  int contacts[3] = {};
  bool small = false, left = false, right = false;
  for (std::size_t i = 0; i < few.size(); ++i) {
    ++contacts[few[i].contact];
    ASSERT_LE(few[i].settled, i);
    EXPECT_EQ(few[few[i].settled].settled, few[i].settled);
    EXPECT_EQ(few[few[i].settled].contact, few[i].contact);
    EXPECT_EQ(few[few[i].settled].force.z(), few[i].force.z());
    small = small || few[i].force.z() == 1;
    left = left || few[i].force.x() < -0.5;
    right = right || few[i].force.x() > 0.5;
  }
  EXPECT_EQ(contacts[1], 0);
  EXPECT_GE(contacts[0], 4);
  EXPECT_LE(contacts[0], 6);
  EXPECT_EQ(contacts[0], contacts[2]);
  EXPECT_TRUE(small && left && right);
  EXPECT_EQ(spread_pairs(many_pairs(), kThreeContacts, {true, true, true}, 1000).size(),
            many_pairs().size());
}

TEST(PairSelection, LeavesOutForcesThatDoNotPress) {
  std::vector<Pair> pairs = many_pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].contact == 0) pairs[i].force.setZero();
    if (pairs[i].contact == 1 && i % 2 == 1) pairs[i].force *= -100;  // far from all others
  }
  const std::vector<Pair> few = spread_pairs(pairs, kThreeContacts, {true, true, true}, 12);
  EXPECT_FALSE(few.empty());
  for (const Pair& pair : few) {
    EXPECT_NE(pair.contact, 0U);
    EXPECT_GT(pair.force.z(), 0);
  }
}

TEST(PairSelection, KeepsMarkedPairsWithTheirPresses) {
  const std::vector<Pair> pairs = many_pairs();
  std::vector<bool> marked(pairs.size(), false);
  marked[0] = marked[3] = marked[20] = true;  // the press of the last is not marked
  const std::vector<Pair> kept = marked_pairs(pairs, marked);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[1].settled, 0U);
  EXPECT_EQ(kept[1].force, pairs[3].force);
}

TEST(PairSelection, TakesLargeForcesAtContactsFarApart) {
  const std::vector<Pair> pairs = many_pairs();
  const std::vector<std::size_t> large = largest_pairs(pairs, kThreeContacts, 4);
  ASSERT_EQ(large.size(), 4U);
  for (const std::size_t i : large) {
    EXPECT_NE(pairs[i].contact, 1U);
    EXPECT_EQ(pairs[i].force.z(), 2);
  }
  EXPECT_EQ(std::ranges::count_if(large, [&](std::size_t i) { return pairs[i].settled == i; }), 2);
}

TEST(PairSelection, RepresentsSmallForcesToo) {
  const std::vector<Pair> pairs = many_pairs();
  const std::vector<std::size_t> chosen = representative_pairs(pairs, kThreeContacts, 6);
  const std::vector<std::size_t> large = largest_pairs(pairs, kThreeContacts, 4);
  ASSERT_EQ(chosen.size(), 6U);
  EXPECT_TRUE(std::equal(large.begin(), large.end(), chosen.begin()));
  for (std::size_t k = 4; k < 6; ++k) {
    const Pair& least = pairs[chosen[k]];
    EXPECT_EQ(least.settled, chosen[k]);
    for (const Pair& pair : pairs) {
      if (pair.contact == least.contact) {
        EXPECT_LE(least.force.norm(), pair.force.norm());
      }
    }
  }
}

}  // namespace
}  // namespace palpate::haptics
