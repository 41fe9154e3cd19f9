// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_prober.h"

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <future>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "arm/arm_motion.h"
#include "arm/resting_window.h"
#include "arm/work_meter.h"
#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kSlowPart = 3.5;  // [mm] last part of the way to the start of an approach ...
constexpr double kSlowSpeed = 10;  // [mm/s] ... which is slow, along the coming force
constexpr double kLateralStiffness = 0.15;  // [N/mm] across the direction of an approach
constexpr double kLateralDamping = 0.0125;  // [N s/mm]
constexpr double kEstimating = 0.1;         // [s] allowed for locating the touch
constexpr double kUnloading = 0.4;          // [s] in which a lift removes the force
constexpr double kUnloaded = 0.05;          // [N] that remain after that
constexpr double kShortestRamp = 0.3;       // [s]
constexpr double kLevelled = 0.05;          // [s] between two checks of whether the tip rests
constexpr double kSwinging = 1.5;           // periods of a dither before the tip is measured
constexpr double kStill = 0.1;              // [mm/s] under a dither, without its oscillation
constexpr double kLongestDither = 2;        // times the shortest, until the tip is still

void check_prober_options(const ArmProberOptions& o) {
  const auto positive = [](const char* name, double value, const char* unit) {
    require(name, value, above(0).finite(), unit);
  };
  positive("ArmProberOptions::structure", o.structure, "N/mm");
  positive("ArmProberOptions::travel_speed", o.travel_speed, "mm/s");
  positive("ArmProberOptions::start_distance", o.start_distance, "mm");
  positive("ArmProberOptions::beyond", o.beyond, "mm");
  positive("ArmProberOptions::push", o.push, "N");
  positive("ArmProberOptions::approach_speed", o.approach_speed, "mm/s");
  require("ArmProberOptions::free_settling", o.free_settling, at_least(0).finite(), "s");
  require("ArmProberOptions::measuring", o.measuring, at_least(0.1).finite(), "s");
  positive("ArmProberOptions::hunting", o.hunting, "N");
  require("ArmProberOptions::attempts", o.attempts, above(0));
  positive("ArmProberOptions::ramp", o.ramp, "N/s");
  require("ArmProberOptions::damping", o.damping, at_least(0).finite(), "N s/mm");
  positive("ArmProberOptions::presliding", o.presliding, "rad");
  require("ArmProberOptions::sliding_friction", o.sliding_friction, at_least(1).finite());
  require("ArmProberOptions::dither", o.dither, at_least(0).finite(), "N mm");
  positive("ArmProberOptions::dither_frequency", o.dither_frequency, "Hz");
  positive("ArmProberOptions::resting_window", o.resting_window, "s");
  positive("ArmProberOptions::settled_speed", o.settled_speed, "mm/s");
  positive("ArmProberOptions::longest_slide", o.longest_slide, "mm");
  positive("ArmProberOptions::heating_time", o.heating_time, "s");
  require("ArmProberOptions::expected_load", o.expected_load, at_least(0).finite(), "s");
  require("ArmProberOptions::warm", o.warm, above(0).below(o.limits.hottest));
}

}  // namespace

struct ArmProber::Impl {
  Impl(devices::Device& arm, const ArmProberOptions& given, const devices::EmergencyStop* button,
       const std::optional<GravityModel>& known)
      : options(given),
        stop(button),
        safe(arm, given.limits, button),
        motion(safe, options),
        gravity(known),
        T_base_world(given.T_world_base.inverse()) {
    check_prober_options(options);
    options.calibration.geometry = options.geometry;
    options.calibration.gains = options.gains;
    if (!arm.description().measures_joints) {
      throw DeviceError(arm.description().name +
                        ": does not measure its joints, so that it cannot be moved by them and "
                        "gravity cannot be compensated");
    }
  }
  ~Impl() { static_cast<void>(end_keeping()); }

  [[nodiscard]] double time() const { return motion.state().time; }
  [[nodiscard]] double seconds() const { return time() - begun; }
  [[nodiscard]] bool has_time(double limit) const { return seconds() + motion.period() <= limit; }

  /// \param bending [N] on the object, in the frame of the base.
  [[nodiscard]] ProbeReport report(ProbeOutcome outcome, const Vector3d& tip,
                                   const Vector3d& bending = Vector3d::Zero()) const {
    return {outcome, options.T_world_base * (tip - bending / options.structure), seconds()};
  }

  void switch_on() {
    try {
      safe.activate();
    } catch (const DeviceError& error) {  // the reason of a fault still exists, or the arm refuses
      const bool pressed = stop != nullptr && stop->pressed();
      throw ArmStopped(error.what(), pressed ? devices::DeviceFault::emergency_stop : safe.fault());
    }
  }

  void begin_trial(long long number) {
    trial = number;
    safe.begin_trial(number);
    switch_on();
    motion.begin(*gravity);
    force.setZero();
  }

  // Holds the arm between trials, while their results are written to the disk.
  void keep() {
    if (!safe.description().real_time) return;
    keeping = true;
    keeper = std::thread([this] {
      try {
        while (keeping) motion.hold();
      } catch (...) {
        kept = std::current_exception();
      }
    });
  }
  std::exception_ptr end_keeping() {
    keeping = false;
    if (keeper.joinable()) keeper.join();
    return std::exchange(kept, nullptr);
  }

  ProbeReport perform(const ProbeAction& action) {
    if (const std::exception_ptr fault = end_keeping()) std::rethrow_exception(fault);
    if (!gravity) throw InvalidInput("ArmProber: gravity is not known; call calibrate first");
    if (action.trial != trial || safe.fault() != devices::DeviceFault::none)
      begin_trial(action.trial);
    begun = time();
    ProbeReport result;
    switch (action.kind) {
      case ProbeActionKind::travel:
        result = travel(action);
        break;
      case ProbeActionKind::touch:
        result = touch(action);
        break;
      case ProbeActionKind::press:
      case ProbeActionKind::drag:
      case ProbeActionKind::release:
        result = apply(action);
        break;
      case ProbeActionKind::lift:
        result = lift(action);
        keep();
        break;
    }
    return result;
  }

  /// True if all motors can bear `coming` [N] for `expected_load`, by du/dt = (load^2 - u) / T.
  [[nodiscard]] bool is_cool(const Vector3d& coming) const {
    if (!safe.description().measures_heat) return true;
    const double decay = std::exp(-options.expected_load / options.heating_time);
    const double continuous = safe.description().continuous_force *
                              std::max(options.geometry.upper, options.geometry.lower);  // [N mm]
    const Vector3d loaded = motion.torque_of(coming).cwiseAbs2() / (continuous * continuous);
    const Vector3d held =
        motion.torque_of(Vector3d::Zero()).cwiseAbs2() / (continuous * continuous);
    for (int i = 0; i < 3; ++i) {
      const double heat = motion.state().heat[i];
      // Waiting does not remove the heat that holding the arm alone causes.
      constexpr double kAsCoolAsItGets = 0.02;
      if (heat < held[i] + kAsCoolAsItGets) continue;
      if (loaded[i] + (heat - loaded[i]) * decay > options.warm) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_warm() const {
    return safe.description().measures_heat && motion.state().heat.maxCoeff() > options.warm;
  }

  ProbeReport travel(const ProbeAction& action) {
    const Vector3d place = T_base_world * action.target;
    const Vector3d coming = T_base_world.linear() * action.force;
    const double deadline = begun + action.time_limit;
    if (!motion.move_to(place, options.travel_speed, deadline))
      return report(ProbeOutcome::timed_out, motion.state().tip);
    constexpr double kArrived = 1;  // [mm]
    do {
      if (!has_time(action.time_limit)) return report(ProbeOutcome::timed_out, motion.state().tip);
      motion.hold();
    } while (!is_cool(coming) || (motion.state().tip - place).norm() > kArrived);
    return report(ProbeOutcome::done, motion.state().tip);
  }

  ProbeReport touch(const ProbeAction& action) {
    const Vector3d surface = T_base_world * action.target;
    const Vector3d along = (T_base_world.linear() * action.force).normalized();
    const Vector3d start = surface - options.start_distance * along;
    const double deadline = begun + action.time_limit;
    safe.limit_depth(surface, along);
    approached = {along, surface};
    ProbeReport last = report(ProbeOutcome::timed_out, motion.state().tip);
    for (int attempt = 0; attempt < options.attempts; ++attempt) {
      if (!motion.move_to(start - kSlowPart * along, options.travel_speed, deadline) ||
          !motion.move_to(start, kSlowSpeed, deadline))
        return report(ProbeOutcome::timed_out, motion.state().tip);
      if (!measure_internal_force()) {
        last = report(ProbeOutcome::unsettled, motion.state().tip);
        continue;
      }
      last = approach(action, along);
      if (last.outcome == ProbeOutcome::done || last.outcome == ProbeOutcome::no_contact)
        return last;
      motion.take_hold();
    }
    return last;
  }

  /// False if the joints oscillate (`hunting`).
  bool measure_internal_force() {
    for (int i = motion.ticks_in(options.free_settling); i > 0; --i) motion.hold();
    std::vector<Vector3d> held(static_cast<std::size_t>(motion.ticks_in(options.measuring)));
    for (Vector3d& each : held) each = motion.hold();
    const std::optional<Vector3d> internal = internal_force(held, options.hunting);
    if (!internal) return false;
    motion.set_internal_torque(arm_jacobian(options.geometry, motion.state().joints).transpose() *
                               *internal);
    return true;
  }

  ProbeReport approach(const ProbeAction& action, const Vector3d& along) {
    ContactDetector detector(options.contact);
    const Vector3d from = motion.state().tip;
    const Eigen::Matrix3d beside = Eigen::Matrix3d::Identity() - along * along.transpose();
    const double longest = options.start_distance + options.beyond;
    std::vector<Vector3d> offsets;  // one for each sample of the detector
    offsets.reserve(static_cast<std::size_t>(motion.ticks_in(options.contact.longest_approach)));
    while (true) {
      const Vector3d offset = motion.state().tip - from;
      const double way = along.dot(offset);
      const double push =
          std::max(0.0, approach_force(detector.speed(), options.push, options.approach_speed));
      offsets.push_back(offset);
      if (detector.step({.time = time(), .position = way, .force = push})) break;
      if (detector.fault() != SignalFault::none || !has_time(action.time_limit))
        return report(ProbeOutcome::timed_out, motion.state().tip);
      if (way > longest) return report(ProbeOutcome::no_contact, motion.state().tip);
      motion.push(push * along -
                  beside * (kLateralStiffness * offset + kLateralDamping * motion.speed()));
    }
    // Keep the control loop running while the touch is located, which takes milliseconds.
    std::future<std::optional<ContactEstimate>> located = std::async(
        std::launch::async, [&] { return estimate_contact(detector.samples(), options.contact); });
    force = options.push * along;
    for (int i = motion.ticks_in(kEstimating); i > 0; --i)
      motion.push(force - options.damping * motion.speed());
    const std::optional<ContactEstimate> estimate = located.get();
    if (!estimate) return report(ProbeOutcome::timed_out, motion.state().tip);
    const std::span<const ApproachSample> samples = detector.samples();
    latest_approach = {.samples = {samples.begin(), samples.end()}, .found = *estimate};
    const auto touched = std::lower_bound(
        samples.begin(), samples.end() - 1, estimate->time,
        [](const ApproachSample& sample, double value) { return sample.time < value; });
    const Vector3d& sideways = offsets[static_cast<std::size_t>(touched - samples.begin())];
    return report(ProbeOutcome::done, from + beside * sideways + along * estimate->position);
  }

  ProbeReport apply(const ProbeAction& action) {
    const Vector3d before = force, wanted = T_base_world.linear() * action.force;
    const double ramp = std::max(kShortestRamp, (wanted - before).norm() / options.ramp);
    const int rising = motion.ticks_in(ramp), look = motion.ticks_in(kLevelled);
    RestingWindow window(motion.ticks_in(options.resting_window)), reference = window;
    // The work of what drag and release add to the force that stays.
    const Vector3d staying = action.kind == ProbeActionKind::release ? wanted : before;
    const Vector3d start =
        action.kind == ProbeActionKind::press ? without_bending(motion.state().tip) : rested;
    WorkMeter work(time(), before - staying, start, options.damping, look);
    Vector3d constant_from = motion.state().tip, speed_then = motion.speed();
    int measuring = motion.ticks_in(kSwinging / options.dither_frequency + options.resting_window);
    if (options.dither == 0) measuring = 0;
    int resting = 0;  // tick from which the tip rests; 0 while it does not
    Vector3d came_to_rest = Vector3d::Zero();
    for (int tick = 1; has_time(action.time_limit); ++tick) {
      const double t = std::min(1.0, static_cast<double>(tick) / rising);
      force = before + (wanted - before) * (t * t * (3 - 2 * t));
      const Vector3d damped = force - options.damping * motion.speed();
      if (resting > 0)
        motion.push_with_dither(damped, (tick - resting) * motion.period());
      else
        motion.push(damped);
      const Vector3d& tip = motion.state().tip;
      work.add(time(), force - staying, without_bending(tip));
      if (tick == rising) constant_from = tip, speed_then = motion.speed();
      if (is_warm()) return report(ProbeOutcome::timed_out, tip, force);
      const bool too_deep = approached.signedDistance(tip) > options.limits.depth;
      if (tick < rising && !too_deep) continue;
      if (too_deep || (tip - constant_from).norm() > options.longest_slide) {
        const Vector3d bending = std::exchange(force, Vector3d::Zero());  // the lift brakes at once
        return report(ProbeOutcome::fell_off, tip, bending);
      }
      window.add(time(), tip);
      reference.add(time(), motion.state().reference_force);
      if (resting == 0 && window.full() && tick % look == 0 &&
          window.speed() < options.settled_speed) {
        resting = tick;
        came_to_rest = window.mean();
      }
      if (resting == 0) continue;
      const int measured = tick - resting;
      if (measuring > 0 && measured > kLongestDither * measuring) {
        // The dither makes the tip creep, near the limit of friction: wait and measure without it.
        measuring = 0;
        resting = 0;
      } else if (measured >= measuring && tick % look == 0 &&
                 (measuring == 0 || window.speed_of_halves() < kStill)) {
        rested = without_bending(window.mean());
        if (safe.description().measures_reference)
          applied.push_back(
              {action.trial, action.kind, force, motion.internal_force(), reference.mean()});
        ProbeReport done = report(ProbeOutcome::done, window.mean(), force);
        done.creep =
            creep_share(rested - start, came_to_rest - constant_from, wanted - before, speed_then);
        if (action.kind != ProbeActionKind::press) done.work = work.end(force - staying, rested);
        return done;
      }
    }
    return report(ProbeOutcome::unsettled, motion.state().tip, force);
  }

  /// [mm] By `force`.
  [[nodiscard]] Vector3d without_bending(const Vector3d& tip) const {
    return tip - force / options.structure;
  }

  /// Of the displacement `whole`, the share of `late` that the arm's damping does not explain: at
  /// the speed of the tip, it took a part of the change of the force away.
  [[nodiscard]] double creep_share(const Vector3d& whole, const Vector3d& late,
                                   const Vector3d& change, const Vector3d& speed) const {
    const double delayed = options.damping * speed.dot(change) / change.squaredNorm();
    return late.dot(whole) / whole.squaredNorm() - delayed;
  }

  ProbeReport lift(const ProbeAction& action) {
    const Vector3d place = T_base_world * action.target;
    if (!force.isZero(0)) {
      const Vector3d before = force;
      const int ticks = motion.ticks_in(kUnloading);
      for (int i = 1; i <= ticks; ++i) {
        const double left = 1 - static_cast<double>(i) / ticks;
        force = before.normalized() * (kUnloaded + (before.norm() - kUnloaded) * left);
        motion.push(force - options.damping * motion.speed());
      }
      force.setZero();
    }
    motion.take_hold();
    const bool there = motion.move_to(place, options.travel_speed, begun + action.time_limit);
    return report(there ? ProbeOutcome::done : ProbeOutcome::timed_out, motion.state().tip);
  }

  ArmProberOptions options;
  const devices::EmergencyStop* stop;
  devices::SafeDevice safe;
  ArmMotion motion;
  std::optional<GravityModel> gravity;
  std::vector<HeldPose> poses;
  std::optional<ArmApproach> latest_approach;
  std::vector<AppliedForce> applied;
  Eigen::Isometry3d T_base_world;
  long long trial = -1;  // that was begun
  double begun = 0;      // [s] time of the action
  // The place at which the arm began to approach, inwards.
  Eigen::Hyperplane<double, 3> approached{Vector3d::UnitZ(), Vector3d::Zero()};
  Vector3d force = Vector3d::Zero();   // [N] of the tip on the object, as commanded last
  Vector3d rested = Vector3d::Zero();  // [mm] last resting place of the tip, without bending
  std::thread keeper;
  std::atomic<bool> keeping = false;
  std::exception_ptr kept;
};

ArmProber::ArmProber(devices::Device& arm, const ArmProberOptions& options,
                     const devices::EmergencyStop* emergency_stop,
                     const std::optional<GravityModel>& gravity)
    : impl_(std::make_unique<Impl>(arm, options, emergency_stop, gravity)) {}

ArmProber::~ArmProber() = default;

void ArmProber::calibrate() {
  Impl& impl = *impl_;
  static_cast<void>(impl.end_keeping());
  impl.safe.forget_depth();
  impl.switch_on();
  try {
    impl.poses = hold_poses(impl.safe, impl.options.calibration);
    impl.gravity = fit_gravity(impl.poses);
  } catch (const DeviceError& error) {
    if (impl.safe.fault() == devices::DeviceFault::none) throw;
    std::string message = error.what();
    message += ": " + std::string(to_string(impl.safe.fault()));
    if (const std::string words = impl.safe.last_error(); !words.empty())
      message += " (" + words + ")";
    throw ArmStopped(message, impl.safe.fault());
  }
  impl.switch_on();
  impl.motion.begin(*impl.gravity);
  impl.keep();
}

const std::optional<GravityModel>& ArmProber::gravity() const { return impl_->gravity; }

const std::vector<HeldPose>& ArmProber::held_poses() const { return impl_->poses; }

const std::optional<ArmApproach>& ArmProber::approach() const { return impl_->latest_approach; }

const std::vector<AppliedForce>& ArmProber::applied_forces() const { return impl_->applied; }

ProbeReport ArmProber::perform(const ProbeAction& action) { return impl_->perform(action); }

const devices::SafeDevice& ArmProber::arm() const { return impl_->safe; }

}  // namespace palpate::probing
