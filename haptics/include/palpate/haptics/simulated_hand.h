// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>

#include "palpate/core/fields.h"
#include "palpate/devices/device.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/timed_path.h"

namespace palpate::haptics {

/// A hand that holds a device: a mass that a spring pulls to where the hand wants to be. The
/// meaning, unit and range of the fields that users set stand in its list, `visit`.
struct HandOptions {
  double mass = 0.2;
  double damping = 0.005;
  double friction = 0;
  double stiffness = 0.1;
  Eigen::Vector3d push = Eigen::Vector3d::Zero();  ///< [N] of the hand besides
  double encoder_step = 0.02;
  int delay = 1;
  double rate = 1000;
  double highest_force = 10;  ///< [N] > 0
  bool real_time = false;     ///< on the host's clock; otherwise on its own

  [[nodiscard]] double period() const noexcept { return 1 / rate; }  ///< [s]
};

void visit(HandOptions& options, FieldVisitor& visitor);

/// A simulated hand, which closes the loop. Between two ticks its motion is exact for a constant
/// force. Dry friction is such a force: against the speed at the end of the tick, which is zero if
/// less than `friction` stops the hand. Equal commands give equal states, bit by bit.
class SimulatedHand final : public devices::Device {
 public:
  /// \param wish where the hand wants to be; it begins there, at rest.
  /// \throws InvalidInput on an option outside its range.
  explicit SimulatedHand(TimedPath wish, const HandOptions& options = {});
  ~SimulatedHand() override;

  [[nodiscard]] const devices::DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  [[nodiscard]] bool read(devices::DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const devices::DeviceCommand& command) noexcept override;
  void stop() noexcept override;

  /// Values that encoders do not show: the position [mm], and the present force [N] of the motors.
  [[nodiscard]] const Eigen::Vector3d& position() const noexcept;
  [[nodiscard]] const Eigen::Vector3d& applied_force() const noexcept;

 private:
  struct Simulation;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace palpate::haptics
