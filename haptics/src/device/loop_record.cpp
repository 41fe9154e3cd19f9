// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/loop_record.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>
#include <type_traits>

#include "palpate/core/error.h"
#include "palpate/devices/device_description_json.h"

namespace palpate::haptics {
namespace {

using LoopJson = nlohmann::ordered_json;

constexpr const char* kLoopFormat = "palpate loop record";
constexpr int kLoopVersion = 2;  // 1: without what limits the heat of motors
static_assert(std::endian::native == std::endian::little, "the file is in the order of the host");
static_assert(std::is_trivially_copyable_v<TickRecord> && sizeof(TickRecord) == 224,
              "ticks are written as they are, without padding");

constexpr double kWithoutLimit = std::numeric_limits<double>::infinity();

std::array<double, 3> numbers(const Eigen::Vector3d& v) noexcept { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d vector(const std::array<double, 3>& v) noexcept { return {v[0], v[1], v[2]}; }

LoopJson json_of(const std::optional<double>& value) {
  return value ? LoopJson(*value) : LoopJson(nullptr);
}

std::optional<double> optional_of(const LoopJson& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

/// JSON has no infinity.
std::optional<double> finite_or_none(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

LoopJson json_of(const DeviceLoopOptions& options) {
  LoopJson pose = LoopJson::array();
  for (const double entry : options.T_world_device.matrix().topRows<3>().transpose().reshaped()) {
    pose.push_back(entry);
  }
  const devices::SafetyOptions& safety = options.safety;
  const CouplingOptions& coupling = options.coupling;
  return {{"T_world_device", pose},  // row by row
          {"scale", json_of(options.scale)},
          {"clutch_buttons", options.clutch_buttons},
          {"safety",
           {{"force", safety.max_force},
            {"continuous_force", json_of(finite_or_none(safety.continuous_force))},
            {"heating_time", safety.heating_time},
            {"torque", safety.max_torque},
            {"slew", safety.slew},
            {"ramp", safety.ramp},
            {"crossfade", safety.crossfade},
            {"oldest_state", safety.oldest_state},
            {"lease", safety.lease}}},
          {"coupling",
           {{"on", coupling.on},
            {"stiffness", json_of(coupling.stiffness)},
            {"safety", coupling.safety},
            {"least_damping", coupling.least_damping},
            {"tolerance", coupling.tolerance},
            {"most_steps", coupling.most_steps}}}};
}

DeviceLoopOptions options_of(const LoopJson& json, int version) {
  DeviceLoopOptions options;
  for (Eigen::Index i = 0; i < 12; ++i) {
    options.T_world_device.matrix()(i / 4, i % 4) =
        json.at("T_world_device").at(static_cast<std::size_t>(i)).get<double>();
  }
  options.scale = optional_of(json.at("scale"));
  json.at("clutch_buttons").get_to(options.clutch_buttons);
  const LoopJson& safety = json.at("safety");
  safety.at("force").get_to(options.safety.max_force);
  if (version > 1) {
    options.safety.continuous_force =
        optional_of(safety.at("continuous_force")).value_or(kWithoutLimit);
    safety.at("heating_time").get_to(options.safety.heating_time);
  }
  safety.at("torque").get_to(options.safety.max_torque);
  safety.at("slew").get_to(options.safety.slew);
  safety.at("ramp").get_to(options.safety.ramp);
  safety.at("crossfade").get_to(options.safety.crossfade);
  safety.at("oldest_state").get_to(options.safety.oldest_state);
  safety.at("lease").get_to(options.safety.lease);
  const LoopJson& coupling = json.at("coupling");
  coupling.at("on").get_to(options.coupling.on);
  options.coupling.stiffness = optional_of(coupling.at("stiffness"));
  coupling.at("safety").get_to(options.coupling.safety);
  coupling.at("least_damping").get_to(options.coupling.least_damping);
  coupling.at("tolerance").get_to(options.coupling.tolerance);
  coupling.at("most_steps").get_to(options.coupling.most_steps);
  return options;
}

bool same_bits(const TickRecord& a, const TickRecord& b) {
  TickRecord first = a, second = b;
  first.nanoseconds = second.nanoseconds = 0;
  using Bytes = std::array<std::byte, sizeof(TickRecord)>;
  return std::bit_cast<Bytes>(first) == std::bit_cast<Bytes>(second);
}

/// Computes a record again. \param tick of a loop, from what the loop read.
template <typename Tick>
LoopReplay compare_ticks(const LoopRecord& record, Tick&& tick) {
  DeviceLoop loop(record.device, record.options);
  LoopReplay result;
  for (const TickRecord& recorded : record.ticks) {
    const TickInput input = input_of(recorded);
    TickOutput output = tick(loop, input);
    loop.check_age(recorded.written - recorded.now, output);
    if (!same_bits(record_of(input, recorded.written, output), recorded)) {
      if (result.different++ == 0) result.first_different = result.ticks;
    }
    ++result.ticks;
  }
  return result;
}

}  // namespace

TickRecord record_of(const TickInput& input, double written, const TickOutput& output) noexcept {
  const devices::DeviceState& state = input.state;
  TickRecord record;
  record.now = input.now;
  record.state_time = state.time;
  record.tip = numbers(state.tip);
  std::copy_n(state.orientation.data(), 4, record.orientation.begin());
  record.velocity = numbers(state.velocity);
  record.buttons = state.buttons;
  if (input.answered) record.flags |= TickRecord::kAnswered;
  if (state.armed) record.flags |= TickRecord::kArmed;
  if (state.clutched) record.flags |= TickRecord::kClutched;
  if (input.exchanged) record.flags |= TickRecord::kExchanged;
  record.written = written;
  record.force = numbers(output.command.force);
  record.torque = numbers(output.command.torque);
  record.tool = numbers(output.tool);
  record.contact = numbers(output.contact);
  record.contact_state = static_cast<std::uint32_t>(output.state);
  record.actions = output.command.actions;
  return record;
}

TickInput input_of(const TickRecord& record) noexcept {
  TickInput input;
  input.now = record.now;
  input.answered = (record.flags & TickRecord::kAnswered) != 0;
  input.exchanged = (record.flags & TickRecord::kExchanged) != 0;
  input.state.time = record.state_time;
  input.state.tip = vector(record.tip);
  input.state.orientation = Eigen::Vector4d(record.orientation.data());
  input.state.velocity = vector(record.velocity);
  input.state.buttons = record.buttons;
  input.state.armed = (record.flags & TickRecord::kArmed) != 0;
  input.state.clutched = (record.flags & TickRecord::kClutched) != 0;
  return input;
}

struct LoopRecorder::Writer {
  static constexpr std::size_t kRoom = std::size_t{1} << 14;  // ticks: 16 s at 1 kHz

  explicit Writer(const std::filesystem::path& where) : path(where), ring(kRoom) {
    file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) {
      throw OutputError(path.string() + ": cannot be written: " + std::strerror(errno));
    }
  }
  ~Writer() {
    if (thread.joinable()) {
      done.store(true, std::memory_order_release);
      thread.join();
    }
    if (file != nullptr) std::fclose(file);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void run() {
    constexpr std::chrono::milliseconds kPause(2);
    while (true) {
      const bool last = done.load(std::memory_order_acquire);
      const std::size_t end = put.load(std::memory_order_acquire);
      for (std::size_t i = taken.load(std::memory_order_relaxed); i != end;) {
        const std::size_t begin = i % kRoom;
        const std::size_t count = std::min(end - i, kRoom - begin);
        if (std::fwrite(&ring[begin], sizeof(TickRecord), count, file) != count) complete = false;
        i += count;
        taken.store(i, std::memory_order_release);
      }
      if (last) return;
      std::this_thread::sleep_for(kPause);
    }
  }

  std::filesystem::path path;
  std::vector<TickRecord> ring;
  std::atomic<std::size_t> put{0}, taken{0};  // ticks so far
  std::atomic<bool> done{false};
  long long lost = 0;
  bool complete = true;
  std::FILE* file = nullptr;
  std::thread thread;
};

LoopRecorder::LoopRecorder(const std::filesystem::path& path,
                           const devices::DeviceDescription& device,
                           const DeviceLoopOptions& options, const std::string& session)
    : writer_(std::make_unique<Writer>(path)) {
  const std::string head = LoopJson{{"format", kLoopFormat},
                                    {"version", kLoopVersion},
                                    {"byte_order", "little"},
                                    {"tick_bytes", sizeof(TickRecord)},
                                    {"device", LoopJson::parse(devices::to_json(device))},
                                    {"options", json_of(options)},
                                    {"session", session}}
                               .dump(-1, ' ', false, LoopJson::error_handler_t::replace) +
                           "\n";
  if (std::fwrite(head.data(), 1, head.size(), writer_->file) != head.size()) {
    throw OutputError(path.string() + ": cannot be written: " + std::strerror(errno));
  }
  writer_->thread = std::thread([writer = writer_.get()] { writer->run(); });
}

LoopRecorder::~LoopRecorder() = default;

bool LoopRecorder::put(const TickRecord& tick) noexcept {
  Writer& w = *writer_;
  const std::size_t at = w.put.load(std::memory_order_relaxed);
  if (at - w.taken.load(std::memory_order_acquire) >= Writer::kRoom) {
    ++w.lost;
    return false;
  }
  w.ring[at % Writer::kRoom] = tick;
  w.put.store(at + 1, std::memory_order_release);
  return true;
}

void LoopRecorder::wait_for_room() const {
  constexpr std::chrono::microseconds kPause(100);
  const Writer& w = *writer_;
  while (w.put.load(std::memory_order_relaxed) - w.taken.load(std::memory_order_acquire) >=
         Writer::kRoom) {
    std::this_thread::sleep_for(kPause);
  }
}

void LoopRecorder::finish() {
  Writer& w = *writer_;
  if (w.file == nullptr) return;
  w.done.store(true, std::memory_order_release);
  if (w.thread.joinable()) w.thread.join();
  const bool closed = std::fclose(w.file) == 0;
  w.file = nullptr;
  if (!w.complete || !closed) {
    throw OutputError(w.path.string() + ": the record is not complete: the disk may be full");
  }
  if (w.lost > 0) {
    throw OutputError(w.path.string() + ": the record is not complete: the disk was too slow for " +
                      std::to_string(w.lost) + " ticks");
  }
}

LoopRecord read_loop_record(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError(path.string() + ": cannot be read; expected the record of a loop");
  std::string line;
  constexpr std::size_t kLongestHead = 1 << 20;  // [bytes]
  char letter = 0;
  while (line.size() < kLongestHead && file.get(letter) && letter != '\n') line += letter;
  const LoopJson head = LoopJson::parse(line, nullptr, false);
  const auto format = head.find("format");
  if (!head.is_object() || format == head.end() || *format != kLoopFormat) {
    throw FileError(path.string() +
                    ": is no loop record; expected the file of 'palpate play --session'");
  }
  const LoopJson version = head.value("version", LoopJson());
  if ((version != 1 && version != kLoopVersion) ||
      head.value("tick_bytes", LoopJson()) != sizeof(TickRecord)) {
    throw FileError(path.string() + ": is a loop record of version " + version.dump() +
                    "; this program reads 1 to " + std::to_string(kLoopVersion));
  }
  LoopRecord record;
  try {
    record.device = devices::device_description_of(head.at("device").dump());
    record.options = options_of(head.at("options"), version.get<int>());
    head.at("session").get_to(record.session);
  } catch (const InvalidInput& wrong) {
    throw FileError(path.string() + ": the head of the loop record is damaged: " + wrong.what());
  } catch (const nlohmann::json::exception& wrong) {
    throw FileError(path.string() + ": the head of the loop record is damaged: " + wrong.what());
  }
  TickRecord tick;
  while (file.read(reinterpret_cast<char*>(&tick), sizeof(tick))) record.ticks.push_back(tick);
  return record;
}

LoopReplay replay(const LoopRecord& record, std::span<const Playback* const> models) {
  const auto exchanges =
      static_cast<std::size_t>(std::ranges::count_if(record.ticks, [](const TickRecord& tick) {
        return (tick.flags & TickRecord::kExchanged) != 0;
      }));
  if (models.size() < exchanges + 1) {
    throw InvalidInput("replay: there are " + std::to_string(models.size()) +
                       " models; the record has " + std::to_string(exchanges) +
                       " exchanges and needs one more model than that");
  }
  std::size_t model = 0;
  return compare_ticks(record, [&](DeviceLoop& loop, const TickInput& input) {
    if (input.exchanged) ++model;
    return loop.tick(*models[model], input);
  });
}

LoopReplay replay(const LoopRecord& record, ToolWorld& world,
                  const std::function<void()>& after_tick) {
  return compare_ticks(record, [&](DeviceLoop& loop, const TickInput& input) {
    const TickOutput output = loop.tick(world, input);
    if (after_tick) after_tick();
    return output;
  });
}

std::vector<TracePoint> trace_of(const LoopRecord& record) {
  std::vector<TracePoint> trace;
  trace.reserve(record.ticks.size());
  const Eigen::Matrix3d rotation = record.options.T_world_device.linear();
  for (const TickRecord& tick : record.ticks) {
    trace.push_back({tick.state_time, vector(tick.tool), vector(tick.contact),
                     rotation * vector(tick.force),
                     static_cast<ContactState>(std::min(tick.contact_state, 2u))});
  }
  return trace;
}

}  // namespace palpate::haptics
