// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/pair_selection.h"

#include <algorithm>
#include <limits>
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

// The largest normal force among pairs, or the largest force that was dragged from `press`.
std::optional<std::size_t> largest(const std::vector<Pair>& pairs,
                                   const std::vector<std::size_t>& among,
                                   std::optional<std::size_t> press) {
  std::optional<std::size_t> result;
  for (const std::size_t i : among) {
    const bool settled = pairs[i].settled == i;
    if (press ? settled || pairs[i].settled != *press : !settled) continue;
    if (!result || pairs[i].force.norm() > pairs[*result].force.norm()) result = i;
  }
  return result;
}

}  // namespace

std::vector<ContactPairs> by_contact(std::span<const Pair> pairs) {
  std::vector<ContactPairs> result;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (result.empty() || result.back().contact != pairs[i].contact)
      result.push_back({pairs[i].contact, {}});
    result.back().pairs.push_back(i);
  }
  return result;
}

std::vector<Pair> chosen_pairs(const std::vector<Pair>& pairs,
                               const std::vector<std::size_t>& indices) {
  std::vector<Pair> result;
  for (const std::size_t i : indices) result.push_back(pairs[i]);
  return result;
}

std::vector<Pair> marked_pairs(const std::vector<Pair>& pairs, const std::vector<bool>& marked) {
  std::vector<std::size_t> place(pairs.size());
  std::vector<Pair> result;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!marked[i] || !marked[pairs[i].settled]) continue;
    place[i] = result.size();
    result.push_back(pairs[i]);
    result.back().settled = place[pairs[i].settled];  // which stands before it
  }
  return result;
}

std::vector<Pair> spread_pairs(const std::vector<Pair>& pairs,
                               std::span<const probing::Contact> contacts,
                               const std::vector<bool>& allowed, std::size_t most) {
  const auto presses = [&](const Pair& pair) {
    return pair.force.dot(contacts[pair.contact].normal) < 0 && pair.displacement.norm() > 0;
  };
  std::vector<ContactPairs> groups = by_contact(pairs);
  std::erase_if(groups, [&](const ContactPairs& group) { return !allowed[group.contact]; });
  std::vector<bool> marked(pairs.size(), false);
  for (ContactPairs& group : groups) {
    std::erase_if(group.pairs, [&](std::size_t i) {
      return !presses(pairs[i]) || !presses(pairs[pairs[i].settled]);
    });
    if (group.pairs.empty()) continue;
    std::vector<Eigen::Vector3d> forces;
    for (const std::size_t i : group.pairs) forces.push_back(pairs[i].force);
    const auto first = std::ranges::max_element(
        forces, {}, [](const Eigen::Vector3d& force) { return force.squaredNorm(); });
    const std::size_t count = std::max<std::size_t>(most / groups.size(), 1);
    for (const std::size_t k :
         farthest_first(forces, static_cast<std::size_t>(first - forces.begin()), count)) {
      marked[group.pairs[k]] = true;
      marked[pairs[group.pairs[k]].settled] = true;
    }
  }
  return marked_pairs(pairs, marked);
}

std::vector<std::size_t> largest_pairs(const std::vector<Pair>& pairs,
                                       std::span<const probing::Contact> contacts,
                                       std::size_t most) {
  const std::vector<ContactPairs> groups = by_contact(pairs);
  std::vector<Eigen::Vector3d> places;
  for (const ContactPairs& group : groups) places.push_back(contacts[group.contact].position);
  std::vector<std::size_t> result;
  if (places.empty()) return result;
  for (const std::size_t c : farthest_first(places, 0, (most + 1) / 2)) {
    const auto press = largest(pairs, groups[c].pairs, std::nullopt);
    if (!press || result.size() == most) continue;
    result.push_back(*press);
    const auto drag = largest(pairs, groups[c].pairs, press);
    if (drag && result.size() < most) result.push_back(*drag);
  }
  return result;
}

std::vector<std::size_t> representative_pairs(const std::vector<Pair>& pairs,
                                              std::span<const probing::Contact> contacts,
                                              std::size_t most) {
  constexpr std::size_t kEach = 3;
  std::vector<std::size_t> result =
      largest_pairs(pairs, contacts, 2 * ((most + kEach - 1) / kEach));
  const std::vector<std::size_t> large = result;
  for (const std::size_t i : large) {
    if (pairs[i].settled != i) continue;
    std::size_t least = i;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      if (pairs[k].contact == pairs[i].contact && pairs[k].settled == k &&
          pairs[k].force.squaredNorm() < pairs[least].force.squaredNorm())
        least = k;
    }
    if (least != i) result.push_back(least);
  }
  if (result.size() > most) result.resize(most);
  return result;
}

}  // namespace palpate::haptics
