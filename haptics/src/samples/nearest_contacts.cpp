// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/nearest_contacts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/core/parallel_for.h"
#include "samples/position_tree.h"

namespace palpate::haptics {
std::vector<std::vector<std::size_t>> nearest_contacts(std::span<const PressedContact> contacts,
                                                       std::size_t count) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i)
    positions.col(static_cast<Eigen::Index>(i)) = contacts[i].position;
  const PositionTree tree(positions);
  std::vector<std::vector<std::size_t>> result(contacts.size());
  parallel_for(contacts.size(), [&](std::size_t i) {
    const PressedContact& contact = contacts[i];
    const auto is_wanted = [&](std::size_t other) {
      return other != i && contact.direction.dot(contacts[other].direction) > 0;
    };
    const auto square_to = [&](std::size_t other) {
      return (contacts[other].position - contact.position).squaredNorm();
    };
    std::vector<std::size_t> found = tree.nearest(contact.position, count, is_wanted);
    if (found.size() == count) {
      // Of several contacts at the largest distance, which the tree chooses is not defined.
      double largest = 0;
      for (const std::size_t other : found) largest = std::max(largest, square_to(other));
      found = tree.in_cube(contact.position, std::sqrt(largest));
      std::erase_if(found, [&](std::size_t other) { return !is_wanted(other); });
    }
    std::vector<std::pair<double, std::size_t>> others;
    for (const std::size_t other : found) others.emplace_back(square_to(other), other);
    std::ranges::sort(others);
    others.resize(std::min(count, others.size()));
    result[i].push_back(i);
    for (const auto& [square, other] : others) result[i].push_back(other);
  });
  return result;
}

}  // namespace palpate::haptics
