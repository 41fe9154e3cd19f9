// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "palpate/probing/arm_prober.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/virtual_arm.h"

namespace palpate::bench {

/// A virtual arm of which is kept what its simulation knows; the program sees none of it.
class WatchedArm final : public devices::Device {
 public:
  /// \param window number of states that `mean_force` is over.
  WatchedArm(probing::VirtualArm& arm, std::size_t window) : arm_(arm), forces_(window) {}

  const devices::DeviceDescription& description() const noexcept override {
    return arm_.description();
  }
  double now() const noexcept override { return arm_.now(); }
  void activate() override { arm_.activate(); }
  void begin_trial(long long trial) noexcept override { arm_.begin_trial(trial); }
  bool read(devices::DeviceState& state) noexcept override {
    const bool good = arm_.read(state);
    forces_[next_++ % forces_.size()] = arm_.truth().force;
    return good;
  }
  bool write(const devices::DeviceCommand& command) noexcept override {
    return arm_.write(command);
  }
  void stop() noexcept override { arm_.stop(); }

  /// [N] on the object, in the frame of the base.
  Eigen::Vector3d mean_force() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& force : forces_) sum += force;
    return sum / static_cast<double>(forces_.size());
  }

 private:
  probing::VirtualArm& arm_;
  std::vector<Eigen::Vector3d> forces_;
  std::size_t next_ = 0;
};

/// A prober over a specimen, set up as `palpate probe run --arm virtual` does.
struct SimulatedRig {
  SimulatedRig(const probing::Specimen& specimen, unsigned seed,
               probing::FrictionCompensation friction = probing::FrictionCompensation::followed,
               bool dithers = true)
      : options(prober_options(specimen, friction, dithers)),
        arm(&specimen, arm_options(options, seed)),
        watched(arm, static_cast<std::size_t>(options.resting_window * 1000)),
        prober(watched, options) {
    prober.calibrate();
  }

  static probing::ArmProberOptions prober_options(const probing::Specimen& specimen,
                                                  probing::FrictionCompensation friction,
                                                  bool dithers) {
    probing::ArmProberOptions options;
    if (!dithers) options.dither = 0;
    options.calibration = probing::sweeps_above_surface();
    options.T_world_base = probing::mount_over(specimen.surface(), options.geometry);
    options.friction = friction;
    return options;
  }
  static probing::VirtualArmOptions arm_options(const probing::ArmProberOptions& options,
                                                unsigned seed) {
    probing::VirtualArmOptions result;
    result.T_world_base = options.T_world_base;
    result.seed = seed;
    return result;
  }

  probing::ArmProberOptions options;
  probing::VirtualArm arm;
  WatchedArm watched;
  probing::ArmProber prober;
};

}  // namespace palpate::bench
