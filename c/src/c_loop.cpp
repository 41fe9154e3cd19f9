// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <string>

#include "c_calls.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/haptics/device_run.h"

namespace palpate::c {

/// A device of callbacks.
class CalledDevice final : public devices::Device {
 public:
  explicit CalledDevice(const palpate_device_calls& calls) : calls_(calls) {
    if (calls.read == nullptr || calls.write == nullptr) {
      throw InvalidInput("palpate_loop_start: read or write is null");
    }
    require("palpate_device_calls.period", calls.period, above(0).finite(), "s");
    require("palpate_device_calls.highest_force", calls.highest_force, above(0).finite(), "N");
    require("palpate_device_calls.damping", calls.damping, at_least(0).finite(), "N s/mm");
    require("palpate_device_calls.delay", calls.delay, at_least(0).finite(), "s");
    description_ = {.name = "called back",
                    .period = calls.period,
                    .highest_force = calls.highest_force,
                    .continuous_force = calls.highest_force,
                    .damping = calls.damping,
                    .delay = calls.delay};
  }

  [[nodiscard]] const devices::DeviceDescription& description() const noexcept override {
    return description_;
  }
  [[nodiscard]] double now() const noexcept override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
  void activate() override { active_ = true; }
  [[nodiscard]] bool read(devices::DeviceState& state) noexcept override {
    devices::DeviceState measured;
    if (calls_.read(calls_.user, measured.tip.data()) != 0) return false;
    measured.time = now();
    state = measured;
    return true;
  }
  [[nodiscard]] bool write(const devices::DeviceCommand& command) noexcept override {
    return active_ && calls_.write(calls_.user, command.force.data()) == 0;
  }
  void stop() noexcept override { active_ = false; }
  [[nodiscard]] std::string last_error() const override {
    return "read, the function of the device, does not answer";
  }

 private:
  palpate_device_calls calls_;
  devices::DeviceDescription description_;
  bool active_ = false;
};

/// The object behind a `palpate_loop`.
struct Loop {
  Loop(const haptics::Model& model, const palpate_device_calls& calls, bool real_time)
      : device(calls),
        run(device, std::make_shared<const haptics::Playback>(model), {},
            {.real_time = real_time}) {}

  CalledDevice device;
  haptics::DeviceRun run;
};

}  // namespace palpate::c

using palpate::c::fail;
using palpate::c::guarded;

palpate_status palpate_loop_start(const palpate_model* model, const palpate_device_calls* device,
                                  int32_t real_time, palpate_loop** loop) {
  if (model == nullptr || device == nullptr || loop == nullptr) {
    return fail(PALPATE_INVALID, "palpate_loop_start: model, device or loop is null");
  }
  return guarded([&] {
    *loop = reinterpret_cast<palpate_loop*>(new palpate::c::Loop(
        *palpate::c::behind(model)->model, palpate::c::taken(*device), real_time != 0));
  });
}

palpate_status palpate_loop_finish(palpate_loop* loop, palpate_loop_statistics* statistics) {
  if (loop == nullptr) return fail(PALPATE_INVALID, "palpate_loop_finish: loop is null");
  const std::unique_ptr<palpate::c::Loop> owned(reinterpret_cast<palpate::c::Loop*>(loop));
  return guarded([&] {
    owned->run.stop();
    const palpate::haptics::RunReport report = owned->run.finish();
    if (statistics != nullptr) {
      palpate_loop_statistics all{};
      all.real_time = report.not_real_time.empty() ? 1 : 0;
      all.ticks = static_cast<uint64_t>(report.time.ticks);
      all.late = static_cast<uint64_t>(report.time.late);
      all.rate = report.time.rate;
      all.p50 = report.time.p50;
      all.p999 = report.time.p999;
      all.largest = report.time.largest;
      all.largest_force = report.largest_force;
      all.given_energy = report.given.in_touches;
      palpate::c::give(all, *statistics);
    }
    if (!report.device_lost.empty()) throw palpate::DeviceError(report.device_lost);
  });
}
