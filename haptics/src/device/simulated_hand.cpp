// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/simulated_hand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>

#include "device/tick_clock.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

// Units: mm, N, s, and so masses in N s^2/mm (1000 kg).
namespace palpate::haptics {
namespace {

constexpr double kKilogramOfHand = 1e-3;  // [N s^2/mm]
constexpr int kLongestDelay = 16;         // [ticks]

}  // namespace

struct SimulatedHand::Simulation {
  struct Pending {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double end = 0;  // [s] of the lease
  };

  /// One tick of position offset, speed and force: x' = v, v' = (f - b v - k x) / m.
  void make_step() {
    const double mass = kKilogramOfHand * options.mass;
    Eigen::Matrix3d rates;
    rates << 0, 1, 0,                                                  //
        -options.stiffness / mass, -options.damping / mass, 1 / mass,  //
        0, 0, 0;
    step = (options.period() * rates).exp();
  }

  void move() noexcept {
    time += options.period();
    const Pending& due = queue[static_cast<std::size_t>(options.delay)];
    applied = active && time <= due.end + options.period() / 2 ? due.force
                                                               : Eigen::Vector3d::Zero().eval();
    swing(applied + options.push, wish.position(time));
    std::move_backward(queue.begin(), queue.end() - 1, queue.end());
  }

  /// \param force [N] besides the spring's, \param rest of the spring.
  void swing(const Eigen::Vector3d& force, const Eigen::Vector3d& rest) noexcept {
    // Of the axes, as columns, without friction.
    Eigen::Matrix3d next;
    next << (place - rest).transpose(), speed.transpose(), force.transpose();
    next = (step * next).eval();
    const double to_place = step(0, 2), to_speed = step(1, 2);
    Eigen::Vector3d friction = -next.row(1).transpose() / to_speed;  // [N] that stops the hand
    const double needed = friction.norm();
    const bool stops = needed <= options.friction;
    if (stops && speed.isZero(0)) return;  // it balances all other forces up to rounding
    if (!stops) friction *= options.friction / needed;
    place = rest + next.row(0).transpose() + to_place * friction;
    speed.setZero();
    if (!stops) speed = next.row(1).transpose() + to_speed * friction;
  }

  TimedPath wish;
  HandOptions options;
  TickClock clock;
  devices::DeviceDescription description;
  Eigen::Matrix3d step = Eigen::Matrix3d::Identity();
  std::array<Pending, kLongestDelay + 1> queue{};  // [0]: the latest command
  bool active = false;
  double time = 0;  // [s] of the simulation
  Eigen::Vector3d place = Eigen::Vector3d::Zero(), speed = Eigen::Vector3d::Zero();
  Eigen::Vector3d applied = Eigen::Vector3d::Zero();
};

void visit(HandOptions& options, FieldVisitor& visitor) {
  visitor.begin("HandOptions");
  visitor.real({"mass", "Mass of the hand and the device", "kg"}, options.mass,
               at_least(0).finite());
  visitor.real({"damping", "Damping of both", "N s/mm"}, options.damping, at_least(0).finite());
  visitor.real({"friction", "Dry friction of both", "N"}, options.friction, at_least(0).finite());
  visitor.real({"stiffness",
                "Stiffness of the spring that pulls the device to where the hand wants", "N/mm"},
               options.stiffness, at_least(0).finite());
  visitor.real({"encoder_step", "Difference of positions that are told apart; 0: exact", "mm"},
               options.encoder_step, at_least(0).finite());
  visitor.whole({"delay", "Delay from a command until its force begins", "ticks"}, options.delay,
                at_least(0).at_most(kLongestDelay));
  visitor.real({"rate", "Ticks of the device per second", "Hz"}, options.rate, above(0).finite());
}

SimulatedHand::SimulatedHand(TimedPath wish, const HandOptions& options) {
  static_cast<void>(in_range(options));
  require("HandOptions::mass", options.mass, above(0), "kg");  // the held arm may have none
  require("HandOptions::highest_force", options.highest_force, above(0).finite(), "N");
  if (!options.push.allFinite()) {
    throw InvalidInput("HandOptions::push is not finite; it must be a force in N");
  }
  simulation_ = std::make_unique<Simulation>(
      Simulation{.wish = std::move(wish),
                 .options = options,
                 .clock = TickClock(options.period(), options.real_time),
                 .description = {.name = "simulated hand",
                                 .period = options.period(),
                                 .highest_force = options.highest_force,
                                 .continuous_force = options.highest_force,
                                 .real_time = options.real_time,
                                 .damping = options.damping,
                                 .friction = options.friction,
                                 .resolution = options.encoder_step,
                                 .delay = options.delay * options.period()}});
  simulation_->place = simulation_->wish.position(0);
  simulation_->make_step();
}

SimulatedHand::~SimulatedHand() = default;

const devices::DeviceDescription& SimulatedHand::description() const noexcept {
  return simulation_->description;
}

double SimulatedHand::now() const noexcept { return simulation_->clock.now(); }

void SimulatedHand::activate() {
  simulation_->active = true;
  simulation_->queue.fill({});
}

bool SimulatedHand::read(devices::DeviceState& state) noexcept {
  Simulation& s = *simulation_;
  for (int ticks = s.clock.wait(); ticks > 0; --ticks) s.move();
  state = {};
  state.time = s.clock.now();
  const double quantum = s.options.encoder_step;
  state.tip = s.place;
  if (quantum > 0) state.tip = quantum * (s.place / quantum).array().round();
  return true;
}

bool SimulatedHand::write(const devices::DeviceCommand& command) noexcept {
  Simulation& s = *simulation_;
  if (!s.active || !command.force.allFinite()) return false;
  s.queue[0] = {command.force, s.time + s.options.delay * s.options.period() + command.lease};
  return true;
}

void SimulatedHand::stop() noexcept { simulation_->active = false; }

const Eigen::Vector3d& SimulatedHand::position() const noexcept { return simulation_->place; }

const Eigen::Vector3d& SimulatedHand::applied_force() const noexcept {
  return simulation_->applied;
}

}  // namespace palpate::haptics
