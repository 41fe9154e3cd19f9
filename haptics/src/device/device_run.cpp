// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/device_run.h"

#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/haptics/loop_record.h"

namespace palpate::haptics {
namespace {

using HostClock = std::chrono::steady_clock;

/// Locks the memory of the process, but only where later allocations cannot fail by it.
bool lock_memory() {
  rlimit limit{};
  return getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY &&
         mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
}

/// Touches the stack that the loop will use, so that no tick meets a page fault.
void touch_stack() {
  constexpr std::size_t kStack = std::size_t{128} << 10, kPage = 4096;  // [bytes]
  std::array<char, kStack> stack;
  for (std::size_t i = 0; i < kStack; i += kPage) static_cast<volatile char*>(stack.data())[i] = 0;
}

}  // namespace

struct DeviceRun::Runner {
  Runner(devices::Device& a, std::shared_ptr<const Playback> m, std::shared_ptr<ToolWorld> w,
         const DeviceLoopOptions& l, const RunOptions& o)
      : device(a),
        options(o),
        loop(a.description(), l),
        current(std::move(m)),
        world(std::move(w)),
        lease(l.safety.lease) {
    require("RunOptions::duration", options.duration, at_least(0).finite(), "s");
    require("RunOptions::priority", options.priority, at_least(1).at_most(99));
    require("RunOptions::most_unanswered", options.most_unanswered, at_least(1).finite());
    if (current == nullptr && world == nullptr) throw InvalidInput("DeviceRun: there is no model");
    if (world != nullptr && !options.exchanges.empty()) {
      throw InvalidInput("RunOptions::exchanges: the models of a world cannot be exchanged");
    }
    double last = 0;
    for (const ModelExchange& exchange : options.exchanges) {
      if (exchange.model == nullptr || !(exchange.time >= last)) {
        throw InvalidInput(
            "RunOptions::exchanges: each needs a model and a time that is not before the last one");
      }
      last = exchange.time;
    }
    device.activate();
    try {
      if (!options.record.empty()) {
        recorder.emplace(options.record, device.description(), l, options.session);
      }
      thread = std::thread([this] { run(); });
    } catch (...) {
      device.stop();
      throw;
    }
  }

  void run() {
    if (options.real_time) {
      report.not_real_time = devices::ask_for_real_time(options.priority);
      report.memory_locked = lock_memory();
      touch_stack();
    }
    turn();
    static_cast<void>(device.write({.force = Eigen::Vector3d::Zero(), .lease = lease}));
    device.stop();
    ended.store(true, std::memory_order_release);
  }

  // The loop. Nothing in it allocates, locks, throws or logs.
  void turn() noexcept {
    const Playback* model = current.get();
    std::size_t next_exchange = 0;
    int unanswered = 0, refused = 0;  // in a row
    std::optional<double> first_time;
    double last_now = 0;
    const double period = device.description().period;
    const auto tick_length =
        std::chrono::duration_cast<HostClock::duration>(std::chrono::duration<double>(period));
    const bool in_real_time = options.real_time || device.description().real_time;
    const HostClock::time_point begin = HostClock::now();
    TickInput input;
    while (!stopping.load(std::memory_order_relaxed)) {
      const HostClock::time_point asked = HostClock::now();
      input.answered = device.read(input.state);
      // A device that fails at once does not set the pace.
      if (!input.answered && in_real_time) std::this_thread::sleep_until(asked + tick_length);
      const HostClock::time_point start = HostClock::now();
      input.now = device.now();
      unanswered = input.answered ? 0 : unanswered + 1;
      const int failing = std::max(unanswered, refused);
      if (failing >= options.most_unanswered) {
        lost = true;
        takes_commands = refused < options.most_unanswered;
        break;
      }
      if (!first_time) first_time = input.now;
      const bool is_over = options.duration > 0 && input.now - *first_time >= options.duration;
      if (is_over && failing == 0) break;  // otherwise it shows whether the device is lost
      if (report.time.ticks > 0 && input.now - last_now > 1.5 * period) ++report.time.late;
      last_now = input.now;

      input.exchanged = false;
      if (const Playback* other = offered.exchange(nullptr, std::memory_order_acq_rel)) {
        model = other;
        input.exchanged = true;
        adopted.fetch_add(1, std::memory_order_release);
      } else if (next_exchange < options.exchanges.size() &&
                 input.now - *first_time >= options.exchanges[next_exchange].time) {
        model = options.exchanges[next_exchange++].model.get();
        input.exchanged = true;
      }
      report.exchanges += input.exchanged ? 1 : 0;

      TickOutput output = world ? loop.tick(*world, input) : loop.tick(*model, input);
      const double written = device.now();
      loop.check_age(written - input.now, output);
      const auto computing = std::chrono::nanoseconds(HostClock::now() - start).count();
      if (!device.write(
              {.force = output.command.force, .lease = lease, .torque = output.command.torque})) {
        ++report.refused;
        ++refused;
      } else {
        refused = 0;
      }
      account(output, static_cast<std::uint64_t>(computing));
      if (recorder) {
        TickRecord record = record_of(input, written, output);
        record.nanoseconds = static_cast<std::uint64_t>(computing);
        if (!in_real_time) recorder->wait_for_room();
        recorder->put(record);
      }
    }
    const double elapsed = std::chrono::duration<double>(HostClock::now() - begin).count();
    report.time.rate = elapsed > 0 ? static_cast<double>(report.time.ticks) / elapsed : 0;
  }

  void account(const TickOutput& output, std::uint64_t computing) noexcept {
    ++report.time.ticks;
    computing_times.add(computing);
    ++report.states[static_cast<std::size_t>(output.state)];
    for (std::size_t i = 0; i < report.actions.size(); ++i) {
      report.actions[i] += (output.command.actions >> i) & 1u;
    }
    report.largest_force = std::max(report.largest_force, output.command.force.norm());
    if (output.state == ContactState::free) return;
    report.largest_displacement =
        std::max(report.largest_displacement, (output.tool - output.contact).norm());
  }

  devices::Device& device;
  RunOptions options;
  DeviceLoop loop;
  std::shared_ptr<const Playback> current;  // of the owner: that of the loop, or the one before
  std::shared_ptr<ToolWorld> world;         // in place of a model
  double lease;                             // [s]
  std::optional<LoopRecorder> recorder;
  DurationHistogram computing_times;
  RunReport report;
  bool lost = false, takes_commands = true;
  std::atomic<const Playback*> offered{nullptr};
  std::atomic<int> adopted{0};  // models that were offered and taken
  std::atomic<bool> stopping{false}, ended{false};
  std::thread thread;
};

DeviceRun::DeviceRun(devices::Device& device, std::shared_ptr<const Playback> model,
                     const DeviceLoopOptions& loop, const RunOptions& options)
    : runner_(std::make_unique<Runner>(device, std::move(model), nullptr, loop, options)) {}

DeviceRun::DeviceRun(devices::Device& device, std::shared_ptr<ToolWorld> world,
                     const DeviceLoopOptions& loop, const RunOptions& options)
    : runner_(std::make_unique<Runner>(device, nullptr, std::move(world), loop, options)) {}

DeviceRun::~DeviceRun() {
  stop();
  if (runner_->thread.joinable()) runner_->thread.join();
}

void DeviceRun::exchange(std::shared_ptr<const Playback> model) {
  if (model == nullptr) throw InvalidInput("DeviceRun::exchange: there is no model");
  Runner& r = *runner_;
  if (r.world) throw InvalidInput("DeviceRun::exchange: the models of a world cannot be exchanged");
  const int before = r.adopted.load(std::memory_order_acquire);
  r.offered.store(model.get(), std::memory_order_release);
  constexpr std::chrono::microseconds kPause(100);
  while (r.adopted.load(std::memory_order_acquire) == before && !done()) {
    std::this_thread::sleep_for(kPause);
  }
  // The loop does not use the old one any more. Its last model stays until the loop has ended.
  r.current = std::move(model);
}

void DeviceRun::stop() noexcept { runner_->stopping.store(true, std::memory_order_relaxed); }

bool DeviceRun::done() const noexcept { return runner_->ended.load(std::memory_order_acquire); }

RunReport DeviceRun::finish() {
  Runner& r = *runner_;
  if (r.thread.joinable()) r.thread.join();
  r.report.given = r.loop.given();
  r.report.coupling_stiffness = r.loop.coupling_stiffness();
  r.report.time.p50 = 1e-3 * static_cast<double>(r.computing_times.quantile(0.5));
  r.report.time.p999 = 1e-3 * static_cast<double>(r.computing_times.quantile(0.999));
  r.report.time.largest = 1e-3 * static_cast<double>(r.computing_times.largest());
  if (r.lost) {
    const std::string reason = r.device.last_error();
    r.report.device_lost =
        (r.takes_commands ? "it does not answer any more: " : "it takes no commands any more: ") +
        (reason.empty() ? "it gives no reason" : reason);
  }
  if (r.recorder) r.recorder->finish();
  return r.report;
}

}  // namespace palpate::haptics
