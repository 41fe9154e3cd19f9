// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_stiffness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

/// Share of the contacts that a force may leave out: those that were given up early.
constexpr double kLeftOut = 0.25;
/// Presses whose forces differ by less, relative to the force, are repetitions of one.
constexpr double kSameForce = 0.01;
/// A depth of fewer standard deviations says nothing of the stiffness.
constexpr double kLeastDepth = 2;

struct DepthPress {
  double force = 0;  // [N] along the normal, into the object
  double depth = 0;  // [mm]
};

// Ascending in force.
std::vector<DepthPress> presses_at(const CheckedAcquisition& acquisition, std::size_t index) {
  const Contact& contact = acquisition.contacts()[index];
  std::vector<DepthPress> presses;
  for (const Sample& sample : acquisition.samples_of(index)) {
    const DepthPress press{-sample.force.dot(contact.normal),
                           (contact.position - sample.a).dot(contact.normal)};
    if (press.force > 0) presses.push_back(press);
  }
  std::stable_sort(
      presses.begin(), presses.end(),
      [](const DepthPress& one, const DepthPress& other) { return one.force < other.force; });
  return presses;
}

struct Depth {
  double mean = 0;   // [mm]
  double count = 0;  // of presses in it
};

std::optional<Depth> depth_under(const std::vector<DepthPress>& presses, double force) {
  Depth repeated;
  DepthPress below;
  for (const DepthPress& press : presses) {
    if (std::abs(press.force - force) <= kSameForce * force) {
      // To the same force along the line from zero.
      repeated.mean += press.depth * force / press.force;
      ++repeated.count;
    } else if (press.force < force) {
      below = press;
    } else if (repeated.count == 0) {
      const double part = (force - below.force) / (press.force - below.force);
      return Depth{below.depth + part * (press.depth - below.depth), 1};
    }
  }
  if (repeated.count == 0) return std::nullopt;
  repeated.mean /= repeated.count;
  return repeated;
}

}  // namespace

double common_press_force(const CheckedAcquisition& acquisition) {
  std::vector<double> most;
  for (std::size_t i = 0; i < acquisition.contacts().size(); ++i) {
    const std::vector<DepthPress> presses = presses_at(acquisition, i);
    if (!presses.empty()) most.push_back(presses.back().force);
  }
  if (most.empty()) return 0;
  std::sort(most.begin(), most.end());
  // Of the repetitions of one force, the least: all of them reach it.
  const auto place = static_cast<std::size_t>(kLeftOut * static_cast<double>(most.size()));
  const auto same = std::find_if(most.begin(), most.end(), [&](double force) {
    return force >= (1 - kSameForce) * most[place];
  });
  return *same;
}

std::vector<ContactStiffness> contact_stiffness(const CheckedAcquisition& acquisition, double force,
                                                const PressNoise& noise) {
  require("contact_stiffness(): force", force, above(0).finite(), "N");
  require("PressNoise::position", noise.position, above(0).finite(), "mm");
  require("PressNoise::force", noise.force, at_least(0).finite(), "N");
  std::vector<ContactStiffness> result;
  for (std::size_t i = 0; i < acquisition.contacts().size(); ++i) {
    const std::optional<Depth> depth = depth_under(presses_at(acquisition, i), force);
    if (!depth) continue;
    // An error of the force acts through the compliance, about that of the whole press.
    const double deviation =
        std::hypot(noise.position, noise.force * depth->mean / force) / std::sqrt(depth->count);
    if (!(depth->mean > kLeastDepth * deviation)) continue;
    const double stiffness = force / depth->mean;
    result.push_back(
        {acquisition.contacts()[i].position, stiffness, stiffness * deviation / depth->mean});
  }
  return result;
}

}  // namespace palpate::probing
