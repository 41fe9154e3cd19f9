// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "force_reading.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate::view {
namespace {

// The same as in the page of a model (web/page/scene.js).
constexpr std::size_t kTrials = 24;
constexpr int kTrialTicks = 100;
constexpr double kTrialGap = 0.1;  // of the depth, above the surface

/// Forces [N] of a press at a contact, at kTrialTicks depths up to `depth` [mm].
std::vector<double> press_at(const haptics::Playback& playback,
                             const haptics::ContactModel& contact, double depth) {
  const Eigen::Vector3d inwards = haptics::pressing_frame(contact).col(2);
  haptics::LoopState state;
  static_cast<void>(playback.step(contact.position - kTrialGap * depth * inwards, state));
  std::vector<double> forces;
  for (int tick = 1; tick <= kTrialTicks; ++tick) {
    const Eigen::Vector3d tool = contact.position + depth * tick / kTrialTicks * inwards;
    forces.push_back(playback.step(tool, state).force.norm());
  }
  return forces;
}

}  // namespace

ForceReading read_force(const haptics::BlendedField& field, const FeltTick& tick) {
  ForceReading reading;
  if (tick.state == haptics::ContactState::free) return reading;
  reading.at = field.surface().closest_point(tick.contact).at;
  if (reading.at.triangle < 0) return reading;
  const haptics::Blend blend = field.blend(reading.at);
  const haptics::FrictionParts parts = haptics::friction_parts(blend, -tick.force);
  reading.total = tick.force.norm();
  reading.normal = parts.normal;
  reading.tangential = parts.tangential;
  reading.friction = blend.friction;
  reading.inwards = blend.frame.col(2);
  reading.displacement = tick.tool - tick.contact;
  reading.deviation = field.deviation(reading.at, reading.displacement);
  reading.weights = blend.contacts;
  return reading;
}

double round_up(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  constexpr double kRounding = 1e-9;
  for (const double step : {1, 2, 5}) {
    if (step * power >= value * (1 - kRounding)) return step * power;
  }
  return 10 * power;
}

PressTrial try_presses(const haptics::Playback& playback, const haptics::Model& model,
                       double deepest) {
  const std::size_t count = std::min(kTrials, model.contacts.size());
  std::vector<std::vector<double>> trials;
  std::vector<std::ptrdiff_t> ticks;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t contact = (2 * i + 1) * model.contacts.size() / (2 * count);
    trials.push_back(press_at(playback, model.contacts[contact], deepest));
    ticks.push_back(std::ranges::max_element(trials.back()) - trials.back().begin());
  }
  std::ranges::sort(ticks);
  const std::ptrdiff_t tick = ticks[count / 4];
  std::vector<double> forces;
  for (const std::vector<double>& trial : trials)
    forces.push_back(trial[static_cast<std::size_t>(tick)]);
  std::ranges::sort(forces);
  const double force = forces[count / 4];
  return {.depth = deepest * static_cast<double>(tick + 1) / kTrialTicks,
          .force = round_up(force > 0 ? force : 1)};
}

}  // namespace palpate::view
