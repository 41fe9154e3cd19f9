// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "plausibility/presses.h"

namespace palpate::probing {
namespace {

/// Sums over groups of at least two samples.
struct GroupScatter {
  double force = 0;     ///< [N^2] of the normal forces about the mean of their group
  double position = 0;  ///< [mm^2] of `a`
  double freedom = 0;
  std::size_t largest = 0;  ///< samples of a group
  std::size_t groups = 0;
  double lowest = 0, highest = 0;  ///< [N] normal forces in the group where they differ most
};

GroupScatter group_scatter(const Presses& presses) {
  std::map<long long, std::vector<const Press*>> groups;
  for (const Press& press : presses) groups[press.sample->group].push_back(&press);
  GroupScatter result{.groups = groups.size()};
  for (const auto& [id, group] : groups) {
    const auto count = static_cast<double>(group.size());
    double force = 0;
    Eigen::Vector3d settled = Eigen::Vector3d::Zero();
    for (const Press* press : group) {
      force += press->normal / count;
      settled += press->sample->a / count;
    }
    double low = std::abs(force), high = low;
    for (const Press* press : group) {
      result.force += (press->normal - force) * (press->normal - force);
      result.position += (press->sample->a - settled).squaredNorm();
      low = std::min(low, std::abs(press->normal));
      high = std::max(high, std::abs(press->normal));
    }
    result.freedom += count - 1;
    result.largest = std::max(result.largest, group.size());
    if (high - low > result.highest - result.lowest) {
      result.lowest = low;
      result.highest = high;
    }
  }
  return result;
}

double mean_square_force(const Presses& presses) {
  double sum = 0;
  for (const Press& press : presses) sum += press.normal * press.normal;
  return sum / static_cast<double>(presses.size());
}

const char* const kGroupMeaning =
    "the samples of one contact with one group_id share their normal force: number the groups of a "
    "contact by their normal force, and give every sample a group_id of its own if each has "
    "another normal force";

}  // namespace

void find_groups(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  GroupScatter all;
  double forces = 0, displacements = 0;
  std::size_t count = 0;
  std::vector<long long> mixed;
  for (const ProbedContact& probed : contacts) {
    const GroupScatter here = group_scatter(probed.presses);
    const double square = mean_square_force(probed.presses);
    all.force += here.force;
    all.position += here.position;
    all.freedom += here.freedom;
    if (here.highest - here.lowest > all.highest - all.lowest) {
      all.lowest = here.lowest;
      all.highest = here.highest;
    }
    if (here.force > kImpossibleGroupScatter * kImpossibleGroupScatter * square * here.freedom)
      mixed.push_back(probed.contact->id);
    forces += square * static_cast<double>(probed.presses.size());
    count += probed.presses.size();
    for (const Press& press : probed.presses)
      displacements += (press.sample->a - probed.contact->position).squaredNorm();
  }
  if (all.freedom == 0 || !(forces > 0)) return;
  const auto samples = static_cast<double>(count);
  const double scatter = std::sqrt(all.force / all.freedom / (forces / samples));
  const bool impossible = scatter > kImpossibleGroupScatter || 2 * mixed.size() > contacts.size();
  if (impossible || scatter > kSuspiciousGroupScatter || !mixed.empty()) {
    findings.push_back({Implausibility::mixed_groups, impossible,
                        "the normal forces within one group_id scatter by " + percent(scatter) +
                            " of the forces (root mean square), up to " + figure(all.lowest) +
                            " to " + figure(all.highest) + " N in one group" +
                            (mixed.empty() ? "" : ", most of all at " + named("contact", mixed)),
                        kGroupMeaning});
    return;
  }
  const double moved = std::sqrt(all.position / all.freedom);
  const double displaced = std::sqrt(displacements / samples);
  if (moved > std::max(kSuspiciousPositionScatter * displaced, kPositionScatter)) {
    findings.push_back(
        {Implausibility::scattered_groups, false,
         "the tool positions a within one group_id scatter by " + figure(moved) +
             " mm, at displacements of " + figure(displaced) + " mm (root mean square)",
         "a is the position under the normal component alone, which is the same for the whole "
         "group: check group_id, and whether a holds other positions"});
  }
}

}  // namespace palpate::probing
