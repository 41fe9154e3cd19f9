// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>

#include "plausibility/presses.h"

namespace palpate::probing {
namespace {

enum class Side { right, forces_reversed, normals_inwards, tool_outside };

/// True if the tool moves outwards as it presses harder, and is outside under the larger forces.
bool is_outside(const Presses& presses) {
  double weight = 0, height = 0, force = 0, squares = 0;
  for (const Press& press : presses) {
    weight += std::abs(press.normal);
    height += std::abs(press.normal) * press.height;
    squares += press.normal * press.normal;
  }
  if (!(weight > 0) || !(height > 0)) return false;
  const auto count = static_cast<double>(presses.size());
  force = weight / count;
  double mean = 0, forces = 0, heights = 0, product = 0;
  for (const Press& press : presses) mean += press.height / count;
  for (const Press& press : presses) {
    const double df = std::abs(press.normal) - force, dh = press.height - mean;
    forces += df * df;
    heights += dh * dh;
    product += df * dh;
  }
  // One level of force shows no change with it.
  constexpr double kOneLevel = 0.1;  // of the force, its standard deviation
  constexpr double kClearCorrelation = 0.5;
  if (forces <= kOneLevel * kOneLevel * squares) return height > kTouchError * weight;
  return product > kClearCorrelation * std::sqrt(forces * heights);
}

Side side_of(const Presses& presses) {
  double force = 0;
  for (const Press& press : presses) force += press.normal;
  const bool pulls = force > 0, outside = is_outside(presses);
  if (pulls) return outside ? Side::normals_inwards : Side::forces_reversed;
  return outside ? Side::tool_outside : Side::right;
}

Finding sign_finding(Implausibility kind, const std::vector<long long>& ids, std::size_t all,
                     bool impossible) {
  const std::string where = count_of(ids.size(), all) + " contacts (" + named("contact", ids) + ")";
  switch (kind) {
    case Implausibility::forces_reversed:
      return {kind, impossible,
              "at " + where +
                  " the forces px,py,pz point out of the object while the tool goes into it: they "
                  "are those of the object on the tool",
              "give the force of the tool on the object, so that px*nx + py*ny + pz*nz < 0: change "
              "the signs of px,py,pz, or import them with --forces-on tool"};
    case Implausibility::normals_inwards:
      return {kind, impossible,
              "at " + where +
                  " both the forces and the ways of the tool point along the normal: the normals "
                  "point into the object",
              "normals nx,ny,nz point out of the object, towards the tool: change their signs"};
    default:
      return {kind, impossible,
              "at " + where +
                  " the tool is outside of the object, on the side that the normal points to, "
                  "although the forces press inwards",
              "a is the position of the tool inside the undeformed surface, so that "
              "(ax - x)*nx + (ay - y)*ny + (az - z)*nz < 0: check the signs and the frame of the "
              "tool positions"};
  }
}

}  // namespace

void find_signs(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  std::map<Side, std::vector<long long>> wrong;
  std::size_t count = 0;
  for (const ProbedContact& probed : contacts) {
    const Side side = side_of(probed.presses);
    if (side == Side::right) continue;
    wrong[side].push_back(probed.contact->id);
    ++count;
  }
  const bool impossible = 2 * count > contacts.size();
  const auto add = [&](Side side, Implausibility kind) {
    if (wrong.contains(side))
      findings.push_back(sign_finding(kind, wrong[side], contacts.size(), impossible));
  };
  add(Side::forces_reversed, Implausibility::forces_reversed);
  add(Side::normals_inwards, Implausibility::normals_inwards);
  add(Side::tool_outside, Implausibility::tool_outside);
}

void find_single_samples(const std::vector<ProbedContact>& contacts,
                         std::vector<Finding>& findings) {
  std::vector<long long> pulling, outside;
  for (const ProbedContact& probed : contacts) {
    if (side_of(probed.presses) != Side::right) continue;
    double force = 0, depth = 0;
    for (const Press& press : probed.presses) {
      force = std::max(force, std::abs(press.normal));
      depth = std::max(depth, std::abs(press.height));
    }
    for (const Press& press : probed.presses) {
      if (press.normal > kOppositeShare * force) pulling.push_back(press.sample->id);
      if (press.height > std::max(kOppositeShare * depth, kTouchError))
        outside.push_back(press.sample->id);
    }
  }
  if (!pulling.empty()) {
    findings.push_back({Implausibility::pulling_samples, false,
                        named("sample", pulling) + (pulling.size() == 1 ? " pulls" : " pull") +
                            " at the object, while the others of the same contact press",
                        "check the signs of px,py,pz there, or remove the samples"});
  }
  if (!outside.empty()) {
    findings.push_back({Implausibility::outside_samples, false,
                        named("sample", outside) + (outside.size() == 1 ? " has" : " have") +
                            " the tool position a far outside of the object",
                        "check ax,ay,az there, or remove the samples"});
  }
}

void find_exchanged_ends(const std::vector<ProbedContact>& contacts,
                         std::vector<Finding>& findings) {
  constexpr double kClearly = 3;    // negative work over positive
  constexpr double kEnough = 0.02;  // of the work of pressing; less may be noise
  double forwards = 0, backwards = 0, pressing = 0;
  for (const ProbedContact& probed : contacts) {
    const Eigen::Vector3d n = probed.contact->normal.normalized();
    for (const Press& press : probed.presses) {
      if (press.sample->slipped) continue;
      const Sample& sample = *press.sample;
      const double work = (sample.force - press.normal * n).dot(sample.b - sample.a);
      (work > 0 ? forwards : backwards) += std::abs(work);
      pressing += std::abs(press.normal * press.height);
    }
  }
  if (backwards > kClearly * forwards && backwards > kEnough * pressing) {
    findings.push_back(
        {Implausibility::exchanged_ends, true,
         "tangential forces move the tool backwards, from a to b: " +
             percent(backwards / (forwards + backwards)) + " of their work is negative",
         "a is the position under the normal component alone, b under the whole force, and forces "
         "and positions are in one frame: check whether a and b are exchanged"});
  }
}

}  // namespace palpate::probing
