// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "samples/nearest_contacts.h"

#include <algorithm>
// Boost 1.74 itself includes a header that it calls deprecated, and says so in every build.
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#undef BOOST_ALLOW_DEPRECATED_HEADERS
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "palpate/core/parallel_for.h"

namespace palpate::haptics {
namespace {

namespace bgi = boost::geometry::index;
using TreePoint = boost::geometry::model::point<double, 3, boost::geometry::cs::cartesian>;
using TreeValue = std::pair<TreePoint, std::size_t>;
constexpr std::size_t kMostInNode = 16;
using Tree = bgi::rtree<TreeValue, bgi::linear<kMostInNode>>;
// The tree's distances are rounded otherwise than ours; relative.
constexpr double kDistanceRounding = 1e-9;

TreePoint tree_point(const Eigen::Vector3d& at) { return {at.x(), at.y(), at.z()}; }

Tree tree_of(std::span<const PressedContact> contacts) {
  std::vector<TreeValue> values;
  values.reserve(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i)
    values.emplace_back(tree_point(contacts[i].position), i);
  return Tree(values);
}

}  // namespace

std::vector<std::vector<std::size_t>> nearest_contacts(std::span<const PressedContact> contacts,
                                                       std::size_t count) {
  const Tree tree = tree_of(contacts);
  std::vector<std::vector<std::size_t>> result(contacts.size());
  parallel_for(contacts.size(), [&](std::size_t i) {
    const PressedContact& contact = contacts[i];
    const auto is_wanted = bgi::satisfies([&](const TreeValue& value) {
      return value.second != i && contact.direction.dot(contacts[value.second].direction) > 0;
    });
    const auto square_to = [&](const TreeValue& value) {
      return (contacts[value.second].position - contact.position).squaredNorm();
    };
    std::vector<TreeValue> found;
    tree.query(
        bgi::nearest(tree_point(contact.position), static_cast<unsigned>(count)) && is_wanted,
        std::back_inserter(found));
    if (found.size() == count) {
      // Of several contacts at the largest distance, which the tree chooses is not defined.
      double largest = 0;
      for (const TreeValue& value : found) largest = std::max(largest, square_to(value));
      const Eigen::Vector3d reach = Eigen::Vector3d::Constant(
          (1 + kDistanceRounding) * std::sqrt(largest) + std::numeric_limits<double>::min());
      const boost::geometry::model::box<TreePoint> around(tree_point(contact.position - reach),
                                                          tree_point(contact.position + reach));
      found.clear();
      tree.query(bgi::intersects(around) && is_wanted, std::back_inserter(found));
    }
    std::vector<std::pair<double, std::size_t>> others;
    for (const TreeValue& value : found) others.emplace_back(square_to(value), value.second);
    std::ranges::sort(others);
    others.resize(std::min(count, others.size()));
    result[i].push_back(i);
    for (const auto& [square, other] : others) result[i].push_back(other);
  });
  return result;
}

}  // namespace palpate::haptics
