// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>

#include "palpate/devices/device.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/arm_kinematics.h"
#include "palpate/probing/specimen.h"

namespace palpate::probing {

/// Defaults resemble a PHANToM as the thesis describes it: 0.048 N of friction at the tip, 1.5 N
/// continuously, 3 N for 6 s.
struct VirtualArmOptions {
  ArmGeometry geometry;
  Eigen::Isometry3d T_world_base = Eigen::Isometry3d::Identity();  ///< to the specimen's frame
  Eigen::Vector3d joints{0, 0, 0};                                 ///< [rad] at the beginning
  Eigen::Vector3d gravity{0, -9810, 0};     ///< [mm/s^2] in the frame of the base; tilted if it is
  Eigen::Vector3d rotor{2200, 1300, 2000};  ///< [kg mm^2] inertia of the motors at the joints
  double upper_mass = 0.04, lower_mass = 0.04;    ///< [kg] of the links, each at half its length
  double upper_angle = 0.1, lower_angle = -0.05;  ///< [rad] of each centre of mass off its link
  Eigen::Vector3d friction{10, 10, 10};           ///< [N mm] of the sliding joints (Dahl, Dupont)
  double friction_variation = 0.05;               ///< relative, over the joint's range
  double presliding = 2e-4;                       ///< [rad] in which friction reverses
  double viscosity = 4;                           ///< [N mm s/rad]
  double encoder_step = 1.43e-4;                  ///< [rad]: 0.03 mm at the tip
  double structure = 3.5;                         ///< [N/mm] between the encoders and the tip
  double contact_damping = 0.004;                 ///< [N s/mm] of the object
  double highest_torque = 1445;                   ///< [N mm] of each motor
  double continuous_torque = 320;    ///< [N mm] that heats a motor to 1 in the long run
  double heating_time = 20;          ///< [s]; a motor rests from heat 1 to heat 0.5
  double torque_noise = 0.3;         ///< [N mm] standard deviation at each tick
  double torque_gain_error = 0.002;  ///< relative standard deviation, fixed for each motor
  double force_noise = 0.003;        ///< [N] standard deviation of the delivered force
  std::uint64_t seed = 1;
};

/// The state that a simulation knows and an arm does not measure; for tests and assessments only.
struct VirtualArmTruth {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();    ///< [N] on the object, in the base's frame
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();      ///< [mm] with flexure, in the base's frame
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();  ///< [mm] place on the object, world frame
  double slid = 0;                                    ///< [mm] slip of the contact since the touch
  bool in_contact = false;
};

/// A hand at the tip of a simulated arm, in the frame of its base. Its mass adds to the inertia of
/// the joints; the forces that its turning about them makes are left out.
struct HandGrip {
  double mass = 0;                                  ///< [kg] >= 0
  double damping = 0;                               ///< [N s/mm] >= 0
  double stiffness = 0;                             ///< [N/mm] >= 0, of a spring to ...
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< [mm] ... where the hand wants the tip
  Eigen::Vector3d push = Eigen::Vector3d::Zero();   ///< [N] besides
};

/// The state of a simulated arm in free space between two moments, with which another one continues
/// as it would have.
struct VirtualArmMemory {
  std::uint64_t ticks = 0, sample = 0, sample_begin = 0;
  Eigen::Vector3d joints = Eigen::Vector3d::Zero();   ///< [rad]
  Eigen::Vector3d speed = Eigen::Vector3d::Zero();    ///< [rad/s]
  Eigen::Vector3d bristle = Eigen::Vector3d::Zero();  ///< [rad] deflection of each joint's friction
  Eigen::Vector3d heat = Eigen::Vector3d::Zero();     ///< of each motor
  Eigen::Vector3d resting = Eigen::Vector3d::Zero();  ///< 1 for a motor that must rest, else 0
};

/// A simulated arm on a specimen: dynamics at 10 kHz, states at 1 kHz, on its own clock. Equal
/// seeds, samples and commands give equal states, bit by bit.
class VirtualArm final : public devices::Device {
 public:
  /// \param specimen may be null: the arm is then in free space. It must outlive the arm.
  /// \throws InvalidInput on an option outside its range.
  explicit VirtualArm(const Specimen* specimen, const VirtualArmOptions& options = {});
  ~VirtualArm() override;

  [[nodiscard]] const devices::DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  /// Simulates one period, then measures. False if the specimen has no equilibrium.
  [[nodiscard]] bool read(devices::DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const devices::DeviceCommand& command) noexcept override;
  void stop() noexcept override;
  /// The reason why the specimen has no equilibrium.
  [[nodiscard]] std::string last_error() const override;

  /// From the next tick on, a hand holds the tip like this. Nobody holds a new arm.
  void hold(const HandGrip& grip) noexcept;

  /// Makes the noise that follows a function of the seed, this number and the tick since, so that a
  /// resumed campaign sees the noise that it would have seen.
  void begin_sample(std::uint64_t sample) noexcept;
  [[nodiscard]] const VirtualArmTruth& truth() const noexcept;

  /// For a tip in free space with motors that are about to be activated: neither the contact nor
  /// the latest command is in it.
  [[nodiscard]] VirtualArmMemory memory() const noexcept;
  void restore(const VirtualArmMemory& memory) noexcept;

 private:
  struct Simulation;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace palpate::probing
