// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/core/quantile.h"
#include "plausibility/presses.h"

namespace palpate::probing {
namespace {

/// [mm] Median distance from the middle of the points: a minority of them does not matter.
double spread(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  std::vector<double> values(points.size());
  for (Eigen::Index k = 0; k < 3; ++k) {
    std::ranges::transform(points, values.begin(), [k](const auto& point) { return point[k]; });
    middle[k] = median(values);
  }
  std::ranges::transform(points, values.begin(),
                         [&](const auto& point) { return (point - middle).norm(); });
  return median(values);
}

std::string unit_guess(double ratio) {
  constexpr double kThousand = 1000, kNear = 2;
  const auto is_near = [&](double value) { return ratio > value / kNear && ratio < value * kNear; };
  if (is_near(1 / kThousand)) return "as in m beside contacts in mm";
  if (is_near(kThousand)) return "as in mm beside contacts in m";
  if (ratio < 1) return "as displacements would, or positions in a larger unit";
  return "as positions in a smaller unit would";
}

/// Contacts whose tool is at another one. The places are sorted, so that only those whose x is near
/// that of the tool are looked at.
std::vector<long long> at_another_contact(const std::vector<ProbedContact>& contacts) {
  std::vector<Eigen::Vector3d> places;
  for (const ProbedContact& probed : contacts) places.push_back(probed.contact->position);
  const auto x_of = [](const Eigen::Vector3d& place) { return place.x(); };
  std::ranges::sort(places, {}, x_of);
  std::vector<long long> ids;
  for (const ProbedContact& probed : contacts) {
    const Eigen::Vector3d& tool = probed.lightest;
    const double own = (tool - probed.contact->position).norm(), radius = own / kTimesNearer;
    if (!(own > kTouchError)) continue;
    const auto first = std::ranges::lower_bound(places, tool.x() - radius, {}, x_of);
    const auto last = std::ranges::upper_bound(places, tool.x() + radius, {}, x_of);
    const bool is_at_another = std::any_of(
        first, last, [&](const Eigen::Vector3d& place) { return (place - tool).norm() < radius; });
    if (is_at_another) ids.push_back(probed.contact->id);
  }
  return ids;
}

void find_distant_tools(const std::vector<ProbedContact>& contacts, double size,
                        std::vector<Finding>& findings) {
  std::vector<long long> far;
  std::vector<double> distances;
  for (const ProbedContact& probed : contacts) {
    distances.push_back((probed.lightest - probed.contact->position).norm());
    if (distances.back() > kSuspiciousDistance * size) far.push_back(probed.contact->id);
  }
  if (!far.empty()) {
    findings.push_back(
        {Implausibility::distant_tool, median(distances) > kImpossibleDistance * size,
         "the tool is up to " + figure(*std::ranges::max_element(distances)) + " mm away from " +
             named("contact", far) + ", while the contacts are spread over " + figure(size) +
             " mm (median from their middle)",
         "contacts and tool positions are in one frame and one unit, mm: check these contacts, or "
         "the frames"});
    return;
  }
  const std::vector<long long> exchanged = at_another_contact(contacts);
  if (exchanged.empty()) return;
  findings.push_back(
      {Implausibility::distant_tool, 2 * exchanged.size() > contacts.size(),
       "at " + count_of(exchanged.size(), contacts.size()) + " contacts (" +
           named("contact", exchanged) +
           ") the tool is, under the least force, less than half as far from another contact as "
           "from its own, up to " +
           figure(*std::ranges::max_element(distances)) + " mm",
       "x,y,z, ax,ay,az and bx,by,bz are positions in one frame, and contact names the contact of "
       "the sample: check the order and the signs of these columns, the numbers of the contacts, "
       "or the frames"});
}

}  // namespace

void find_length_units(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  if (contacts.size() < 2) return;
  std::vector<Eigen::Vector3d> places, tools;
  for (const ProbedContact& probed : contacts) {
    places.push_back(probed.contact->position);
    tools.push_back(probed.lightest);
  }
  const double size = spread(places);
  if (!(size > 0)) return;
  const double ratio = spread(tools) / size;
  if (ratio < kLeastSpread || ratio > kLargestSpread) {
    findings.push_back(
        {Implausibility::length_units, true,
         "under the least forces, the tool positions a are spread over " + figure(ratio * size) +
             ", their contacts over " + figure(size) + " (medians from their middles), " +
             unit_guess(ratio),
         "x,y,z, ax,ay,az and bx,by,bz are positions in one frame and one unit, mm (for another "
         "unit of a whole file see probe import --length-unit)"});
    return;
  }
  find_distant_tools(contacts, size, findings);
}

void find_scales(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  Eigen::Vector3d low = contacts.front().contact->position, high = low;
  std::vector<double> displacements;
  double force = 0;
  for (const ProbedContact& probed : contacts) {
    low = low.cwiseMin(probed.contact->position);
    high = high.cwiseMax(probed.contact->position);
    for (const Press& press : probed.presses) {
      displacements.push_back((press.sample->a - probed.contact->position).norm());
      force = std::max(force, press.sample->force.norm());
    }
  }
  const double extent = (high - low).norm(), displacement = median(displacements);
  const char* const kMillimetres =
      "check the unit of the lengths (probe import --length-unit), or ignore this if it is right";
  if (contacts.size() > 1 && (extent < kSmallestExtent || extent > kLargestExtent)) {
    findings.push_back({Implausibility::length_scale, false,
                        "all contacts lie within " + figure(extent) +
                            " mm, which is unlikely for an object under an arm",
                        kMillimetres});
  } else if (displacement <= kStandstill * std::max(low.norm(), high.norm())) {
    findings.push_back({Implausibility::length_scale, true,
                        "the tool stands still: under most forces it is at its contact",
                        "give the positions of the tool under force in the columns a and b"});
  } else if (displacement < kSmallestDisplacement) {
    findings.push_back({Implausibility::length_scale, false,
                        "the tool moves the surface by " + figure(displacement) +
                            " mm (median), less than an arm can measure",
                        kMillimetres});
  }
  if (force < kSmallestForce || force > kLargestForce) {
    findings.push_back({Implausibility::force_scale, force == 0,
                        "the largest force is " + figure(force) +
                            " N, which is unlikely for an arm that probes a soft object",
                        "check the unit of the forces (probe import --force-unit), or ignore "
                        "this if it is right"});
  }
  std::vector<double> ratios;
  for (const ProbedContact& probed : contacts) {
    double largest = 0;
    for (const Press& press : probed.presses) {
      if (!press.sample->slipped && press.normal != 0)
        largest = std::max(largest, tangential_over_normal(press));
    }
    ratios.push_back(largest);
  }
  const double ratio = median(ratios);
  if (ratio > kLargestFriction) {
    findings.push_back({Implausibility::tilted_forces, false,
                        "samples that held have tangential forces of " + figure(ratio) +
                            " times the normal force (median of the largest at each contact)",
                        "px,py,pz have one unit and are in the frame of the normals nx,ny,nz, and "
                        "slipped is 1 where the tool slid: check these columns"});
  }
}

}  // namespace palpate::probing
