// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/pair_selection.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

namespace palpate::haptics {
namespace {

// Points one after the other, each as far as possible from those before; the first is `first`.
std::vector<std::size_t> farthest_first(const std::vector<Eigen::Vector3d>& points,
                                        std::size_t first, std::size_t count) {
  std::vector<std::size_t> order;
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  for (std::size_t next = first; order.size() < std::min(count, points.size());) {
    order.push_back(next);
    for (std::size_t i = 0; i < points.size(); ++i)
      distance[i] = std::min(distance[i], (points[i] - points[next]).squaredNorm());
    next = static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
  }
  return order;
}

bool tells(const Pair& pair) { return pair.force.norm() > 0 && pair.displacement.norm() > 0; }

std::map<std::size_t, std::vector<std::size_t>> by_contact(const std::vector<Pair>& pairs) {
  std::map<std::size_t, std::vector<std::size_t>> result;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (tells(pairs[i])) result[pairs[i].contact].push_back(i);
  return result;
}

std::optional<std::size_t> largest(const std::vector<Pair>& pairs,
                                   const std::vector<std::size_t>& among, bool settled) {
  std::optional<std::size_t> result;
  for (const std::size_t i : among) {
    if ((pairs[i].settled == i) != settled) continue;
    if (!result || pairs[i].force.norm() > pairs[*result].force.norm()) result = i;
  }
  return result;
}

}  // namespace

std::vector<Pair> spread_pairs(const std::vector<Pair>& pairs, const std::vector<bool>& allowed,
                               std::size_t most) {
  auto contacts = by_contact(pairs);
  std::erase_if(contacts, [&](const auto& each) { return !allowed[each.first]; });
  std::vector<bool> chosen(pairs.size(), false);
  for (const auto& [contact, own] : contacts) {
    std::vector<Eigen::Vector3d> forces;
    for (const std::size_t i : own) forces.push_back(pairs[i].force);
    const auto first = std::ranges::max_element(
        forces, {}, [](const Eigen::Vector3d& force) { return force.squaredNorm(); });
    const std::size_t count = std::max<std::size_t>(most / contacts.size(), 1);
    for (const std::size_t k :
         farthest_first(forces, static_cast<std::size_t>(first - forces.begin()), count)) {
      const std::size_t settled = pairs[own[k]].settled;
      if (!tells(pairs[settled])) continue;
      chosen[own[k]] = true;
      chosen[settled] = true;
    }
  }
  std::vector<std::size_t> place(pairs.size());
  std::vector<Pair> result;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!chosen[i]) continue;
    place[i] = result.size();
    result.push_back(pairs[i]);
    result.back().settled = place[pairs[i].settled];  // which stands before it
  }
  return result;
}

std::vector<std::size_t> largest_pairs(const std::vector<Pair>& pairs,
                                       std::span<const probing::Contact> contacts,
                                       std::size_t most) {
  const auto groups = by_contact(pairs);
  std::vector<Eigen::Vector3d> places;
  std::vector<std::vector<std::size_t>> members;
  for (const auto& [contact, own] : groups) {
    places.push_back(contacts[contact].position);
    members.push_back(own);
  }
  std::vector<std::size_t> result;
  if (places.empty()) return result;
  for (const std::size_t c : farthest_first(places, 0, (most + 1) / 2)) {
    for (const bool settled : {true, false}) {
      const auto found = largest(pairs, members[c], settled);
      if (found && result.size() < most) result.push_back(*found);
    }
  }
  return result;
}

}  // namespace palpate::haptics
