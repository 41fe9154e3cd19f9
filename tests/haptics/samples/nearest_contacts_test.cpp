// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/nearest_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

namespace palpate::haptics {
namespace {

PressedContact contact_at(const Eigen::Vector3d& position, const Eigen::Vector3d& direction) {
  PressedContact contact;
  contact.position = position;
  contact.direction = direction;
  return contact;
}

// Compares with a search among all contacts.
void expect_nearest(const std::vector<PressedContact>& contacts, std::size_t count) {
  const std::vector<std::vector<std::size_t>> found = nearest_contacts(contacts, count);
  ASSERT_EQ(found.size(), contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t j = 0; j < contacts.size(); ++j) {
      if (j != i && contacts[i].direction.dot(contacts[j].direction) > 0)
        others.emplace_back((contacts[j].position - contacts[i].position).squaredNorm(), j);
    }
    std::ranges::sort(others);
    std::vector<std::size_t> expected = {i};
    for (std::size_t k = 0; k < std::min(count, others.size()); ++k)
      expected.push_back(others[k].second);
    ASSERT_EQ(found[i], expected) << "contact " << i;
  }
}

TEST(NearestContacts, AreThoseOfASearchAmongAllAlsoWhereDistancesAreEqual) {
  const Eigen::Vector3d down(0, 0, 1);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<PressedContact> scattered, grid;
  for (int i = 0; i < 600; ++i) {
    scattered.push_back(
        contact_at({30 * normal(random), 20 * normal(random), 700 + normal(random)}, down));
    // Many at the same distance, and each place twice.
    grid.push_back(contact_at({1.7 * (i % 20), 1.7 * (i / 2 / 10 % 15), 700.1}, down));
  }
  expect_nearest(scattered, 24);
  expect_nearest(grid, 24);
  expect_nearest(grid, 1);
}

TEST(NearestContacts, AreOnTheSameSideOfTheObject) {
  // A ball that was pressed from all around.
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<PressedContact> ball;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d out =
        Eigen::Vector3d{normal(random), normal(random), normal(random)}.normalized();
    ball.push_back(contact_at(30 * out, -out));
  }
  expect_nearest(ball, 24);
  // Fewer than are wanted: a thin plate with three contacts on one side, one on the other.
  std::vector<PressedContact> plate;
  for (int i = 0; i < 3; ++i) plate.push_back(contact_at({10.0 * i, 0, 0}, {0, 0, 1}));
  plate.push_back(contact_at({10, 0, 1}, {0, 0, -1}));
  expect_nearest(plate, 24);
  EXPECT_EQ(nearest_contacts(plate, 24)[3], std::vector<std::size_t>{3});
}

}  // namespace
}  // namespace palpate::haptics
