// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "palpate/devices/real_time.h"
#include "palpate/haptics/device_loop.h"
#include "palpate/haptics/tick_statistics.h"

namespace palpate::haptics {

/// A change of the model at a moment.
struct ModelExchange {
  double time = 0;  ///< [s] on the device's clock since the first state
  std::shared_ptr<const Playback> model;
};

struct RunOptions {
  double duration = 0;  ///< [s] on the device's clock; 0: until `stop`; >= 0
  /// The thread asks for SCHED_FIFO. With it, or with a device on the host's clock, the loop never
  /// waits for the record.
  bool real_time = true;
  int priority = devices::kRealTimePriority;  ///< of SCHED_FIFO, 1 to 99
  std::filesystem::path record = {};          ///< file of `LoopRecorder`; empty: none
  std::string session = {};                   ///< for the record
  std::vector<ModelExchange> exchanges = {};  ///< in the order of time
  /// Ticks in a row without a state, or with commands that are not taken, after which the device is
  /// lost and the run ends; >= 1. A run whose duration ends while it counts them continues.
  int most_unanswered = 100;
};

struct RunReport {
  TickStatistics time;
  GivenEnergy given;
  /// Ticks with each bit of `SafetyAction`, from the lowest.
  std::array<long long, devices::kSafetyActions> actions{};
  std::array<long long, 3> states{};  ///< ticks of each `ContactState`
  double largest_force = 0;           ///< [N] that was commanded
  double largest_displacement = 0;    ///< [mm] of the tool from the contact, in the world
  double coupling_stiffness = 0;      ///< [N/mm] at the device; infinite without coupling
  long long refused = 0;              ///< commands that the device did not take
  int exchanges = 0;
  std::string not_real_time = {};  ///< why SCHED_FIFO is not allowed; empty if it is, or not asked
  bool memory_locked = false;      ///< the process's memory, against page faults
  std::string device_lost = {};    ///< how, and the device's reason; empty if it was not lost
};

/// Runs a `DeviceLoop` in a thread of its own. The loop neither allocates, locks, throws nor logs.
class DeviceRun {
 public:
  /// Arms the device and starts. `device` must outlive the run, and nobody else may use it.
  /// \throws InvalidInput on an option outside its range, DeviceError if the device cannot be armed,
  /// OutputError if the record cannot be written.
  DeviceRun(devices::Device& device, std::shared_ptr<const Playback> model,
            const DeviceLoopOptions& loop = {}, const RunOptions& options = {});
  /// The same with a world, such as a scene, whose models stay the same.
  DeviceRun(devices::Device& device, std::shared_ptr<ToolWorld> world,
            const DeviceLoopOptions& loop = {}, const RunOptions& options = {});
  /// Stops the loop and disarms the device.
  ~DeviceRun();
  DeviceRun(const DeviceRun&) = delete;
  DeviceRun& operator=(const DeviceRun&) = delete;

  /// Exchanges the model while the loop runs, from any one thread. Returns when the loop uses it,
  /// or has ended. The loop does not wait. \throws InvalidInput if there is a world.
  void exchange(std::shared_ptr<const Playback> model);
  /// Asks the loop to end. Any thread.
  void stop() noexcept;
  [[nodiscard]] bool done() const noexcept;
  /// Waits for the end. \throws OutputError if the record is not complete; another call then
  /// returns the report.
  [[nodiscard]] RunReport finish();

 private:
  struct Runner;
  std::unique_ptr<Runner> runner_;
};

}  // namespace palpate::haptics
