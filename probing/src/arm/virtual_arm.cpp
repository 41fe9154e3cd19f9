// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/virtual_arm.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "arm/link_dynamics.h"
#include "arm/simulated_contact.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

// Units: mm, N, s, and so masses in N s^2/mm (1000 kg) and inertias in N mm s^2 (1000 kg mm^2).
namespace palpate::probing {
namespace {

constexpr double kPeriod = 1e-3;  // [s] of the states
constexpr int kSteps = 10;        // of the dynamics in a period

std::uint64_t mix(std::uint64_t value) {  // splitmix64 (Steele, Lea and Flood 2014)
  value += 0x9E3779B97F4A7C15u;
  value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9u;
  value = (value ^ (value >> 27)) * 0x94D049BB133111EBu;
  return value ^ (value >> 31);
}

/// Three normally distributed numbers, a function of the arguments alone.
Eigen::Vector3d normal_numbers(std::uint64_t seed, std::uint64_t sample, std::uint64_t tick,
                               std::uint64_t channel) {
  std::uint64_t state = mix(mix(mix(mix(seed) ^ sample) ^ tick) ^ channel);
  const auto uniform = [&] {
    state = mix(state);
    return (static_cast<double>(state >> 11) + 0.5) * 0x1p-53;
  };
  const auto pair = [&] {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
  };
  const Eigen::Vector2d first = pair(), second = pair();
  return {first.x(), first.y(), second.x()};
}

/// Deflection of a joint's friction after a motion. Dahl's model, but elastic below a breakaway
/// deflection and for motion against the deflection, so that vibrations do not make a joint at rest
/// creep (Dupont, Hayward, Armstrong and Altpeter 2002).
double bristle_after(double bristle, double way, double presliding) {
  constexpr double kBreakaway = 0.8;  // of the deflection when sliding
  const double share = std::abs(bristle) / presliding;
  const double plastic =
      way * bristle > 0 ? std::clamp((share - kBreakaway) / (1 - kBreakaway), 0.0, 1.0) : 0.0;
  const double after = bristle + way * (1 - plastic * share);
  return std::clamp(after, -presliding, presliding);
}

}  // namespace

struct VirtualArm::Simulation {
  Simulation(const Specimen* object, const VirtualArmOptions& o) : options(o) {
    require("VirtualArmOptions::upper_mass", o.upper_mass, above(0).finite(), "kg");
    require("VirtualArmOptions::lower_mass", o.lower_mass, above(0).finite(), "kg");
    require("VirtualArmOptions::rotor", o.rotor.minCoeff(), above(0).finite(), "kg mm^2");
    require("VirtualArmOptions::friction", o.friction.minCoeff(), at_least(0).finite(), "N mm");
    require("VirtualArmOptions::presliding", o.presliding, above(0).finite(), "rad");
    require("VirtualArmOptions::encoder_step", o.encoder_step, above(0).finite(), "rad");
    require("VirtualArmOptions::structure", o.structure, above(0).finite(), "N/mm");
    require("VirtualArmOptions::highest_torque", o.highest_torque, above(0).finite(), "N mm");
    require("VirtualArmOptions::continuous_torque", o.continuous_torque, above(0).finite(), "N mm");
    require("VirtualArmOptions::heating_time", o.heating_time, above(0).finite(), "s");
    q = o.joints;
    T_base_world = o.T_world_base.inverse();
    gain = Eigen::Vector3d::Ones() + o.torque_gain_error * normal_numbers(o.seed, 0, 0, 2);
    if (object != nullptr) contact.emplace(*object, o.structure);
    const double reach = std::max(o.geometry.upper, o.geometry.lower);
    description = {.name = "virtual arm",
                   .period = kPeriod,
                   .highest_force = o.highest_torque / reach,
                   .continuous_force = o.continuous_torque / reach,
                   .measures_joints = true,
                   .measures_force = true,
                   .measures_heat = true,
                   .measures_reference = true,
                   .real_time = false};
    truth.tip = tip_position(o.geometry, q);
  }

  /// The measured joints.
  [[nodiscard]] Eigen::Vector3d encoders() const {
    return options.encoder_step * (q / options.encoder_step).array().round();
  }

  void tick() {
    time = static_cast<double>(++ticks) * kPeriod;
    const bool leased = active && time <= lease_end;
    const Eigen::Matrix3d jacobian = arm_jacobian(options.geometry, encoders());
    torque = leased ? Eigen::Vector3d(jacobian.transpose() * force)
                    : Eigen::Vector3d(Eigen::Vector3d::Zero());
    for (int i = 0; i < 3; ++i) {
      if (resting[static_cast<std::size_t>(i)]) torque[i] = 0;
      torque[i] = std::clamp(torque[i], -options.highest_torque, options.highest_torque);
      const double load = torque[i] / options.continuous_torque;
      heat[i] += kPeriod / options.heating_time * (load * load - heat[i]);
      if (heat[i] >= 1) resting[static_cast<std::size_t>(i)] = true;
      if (heat[i] < 0.5) resting[static_cast<std::size_t>(i)] = false;
    }
    const std::uint64_t sample_tick = ticks - sample_begin;
    Eigen::Vector3d motor = gain.cwiseProduct(torque);
    if (active) {
      motor += options.torque_noise * normal_numbers(options.seed, sample, sample_tick, 0);
    }
    if (contact)
      contact->find_surface(options.T_world_base * tip_position(options.geometry, q), ticks);
    for (int step = 0; step < kSteps; ++step) move(motor, kPeriod / kSteps);
    if (contact) contact->settle(kPeriod);
    delivered = arm_jacobian(options.geometry, q).transpose().lu().solve(torque) +
                options.force_noise * normal_numbers(options.seed, sample, sample_tick, 1);
  }

  void move(const Eigen::Vector3d& motor, double dt) {
    const LinkDynamics links = link_dynamics(options, q, v);
    const Eigen::Matrix3d jacobian = arm_jacobian(options.geometry, q);
    const Eigen::Vector3d tip = tip_position(options.geometry, q);
    const Eigen::Vector3d on_object = contact_force(tip, jacobian * v);
    Eigen::Vector3d friction;
    for (int i = 0; i < 3; ++i) {
      const double level =
          options.friction[i] * (1 + options.friction_variation * std::sin(9 * q[i] + i));
      bristle[i] = bristle_after(bristle[i], dt * v[i], options.presliding);
      friction[i] = level * bristle[i] / options.presliding + options.viscosity * v[i];
    }
    Eigen::Matrix3d inertia = links.inertia;
    Eigen::Vector3d at_tip = -on_object;
    if (grip) {
      inertia += grip->mass * kKilogram * jacobian.transpose() * jacobian;
      at_tip += grip->stiffness * (grip->place - tip) + grip->push - grip->damping * jacobian * v;
    }
    v += dt * inertia.llt().solve(motor - links.bias - friction + jacobian.transpose() * at_tip);
    q += dt * v;
  }

  /// [N] on the object, base frame; `tip` by the encoders.
  Eigen::Vector3d contact_force(const Eigen::Vector3d& tip, const Eigen::Vector3d& speed) {
    truth.tip = tip;
    truth.force.setZero();
    if (!contact) return truth.force;
    const std::optional<Eigen::Vector3d> pressed = contact->press(options.T_world_base * tip);
    truth.in_contact = contact->touches();
    truth.contact = contact->place();
    truth.slid = contact->slid();
    if (!pressed) return truth.force;
    const Eigen::Vector3d elastic = T_base_world.linear() * *pressed;
    truth.force = elastic + options.contact_damping * speed;
    truth.tip = tip - elastic / options.structure;
    return truth.force;
  }

  VirtualArmOptions options;
  std::optional<SimulatedContact> contact;
  Eigen::Isometry3d T_base_world;
  devices::DeviceDescription description;
  VirtualArmTruth truth;
  Eigen::Vector3d gain;

  // the arm
  double time = 0;
  double lease_end = 0;
  std::uint64_t ticks = 0, sample = 0, sample_begin = 0;
  std::array<bool, 3> resting{};
  bool active = false;
  std::string refusal;  // why the specimen gave no displacement
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  Eigen::Vector3d delivered = Eigen::Vector3d::Zero();
  Eigen::Vector3d heat = Eigen::Vector3d::Zero();
  std::optional<HandGrip> grip;
  Eigen::Vector3d q, v = Eigen::Vector3d::Zero(), bristle = Eigen::Vector3d::Zero();
};

VirtualArm::VirtualArm(const Specimen* specimen, const VirtualArmOptions& options)
    : simulation_(std::make_unique<Simulation>(specimen, options)) {}

VirtualArm::~VirtualArm() = default;

const devices::DeviceDescription& VirtualArm::description() const noexcept {
  return simulation_->description;
}

double VirtualArm::now() const noexcept { return simulation_->time; }

void VirtualArm::activate() {
  simulation_->active = true;
  simulation_->refusal.clear();
  simulation_->force.setZero();
}

bool VirtualArm::read(devices::DeviceState& state) noexcept {
  Simulation& s = *simulation_;
  try {
    s.tick();
  } catch (const Error& none) {  // the specimen has no equilibrium
    s.refusal = none.what();
    return false;
  }
  state.time = s.time;
  state.joints = s.encoders();
  state.tip = tip_position(s.options.geometry, state.joints);
  state.delivered_force = s.delivered;
  state.heat = s.heat;
  state.reference_force = s.truth.force;
  return state.tip.allFinite();
}

bool VirtualArm::write(const devices::DeviceCommand& command) noexcept {
  if (!simulation_->active || !command.force.allFinite()) return false;
  simulation_->force = command.force;
  simulation_->lease_end = simulation_->time + command.lease;
  return true;
}

void VirtualArm::stop() noexcept { simulation_->active = false; }

std::string VirtualArm::last_error() const { return simulation_->refusal; }

void VirtualArm::hold(const HandGrip& grip) noexcept { simulation_->grip = grip; }

void VirtualArm::begin_sample(std::uint64_t sample) noexcept {
  simulation_->sample = sample;
  simulation_->sample_begin = simulation_->ticks;
}

VirtualArmMemory VirtualArm::memory() const noexcept {
  const Simulation& s = *simulation_;
  VirtualArmMemory memory{.ticks = s.ticks,
                          .sample = s.sample,
                          .sample_begin = s.sample_begin,
                          .joints = s.q,
                          .speed = s.v,
                          .bristle = s.bristle,
                          .heat = s.heat};
  for (int i = 0; i < 3; ++i) memory.resting[i] = s.resting[static_cast<std::size_t>(i)] ? 1 : 0;
  return memory;
}

void VirtualArm::restore(const VirtualArmMemory& memory) noexcept {
  Simulation& s = *simulation_;
  s.ticks = memory.ticks;
  s.time = static_cast<double>(s.ticks) * kPeriod;
  s.sample = memory.sample;
  s.sample_begin = memory.sample_begin;
  s.q = memory.joints;
  s.v = memory.speed;
  s.bristle = memory.bristle;
  s.heat = memory.heat;
  for (int i = 0; i < 3; ++i) s.resting[static_cast<std::size_t>(i)] = memory.resting[i] != 0;
  s.truth.in_contact = false;
  if (s.contact) s.contact->leave();
  s.truth.tip = tip_position(s.options.geometry, s.q);
}

const VirtualArmTruth& VirtualArm::truth() const noexcept { return simulation_->truth; }

}  // namespace palpate::probing
