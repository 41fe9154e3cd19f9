// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "palpate/haptics/device_loop.h"

// A record of a device loop: all that it read and all that it commanded. The file begins with one
// line of JSON and a line break: {"format": "palpate loop record", "version": 2, "byte_order":
// "little", "tick_bytes": 224, "device": {...}, "options": {...}, "session": ...}. Each tick
// follows as a `TickRecord`: numbers of 8 bytes, except pairs of whole numbers of 4.
namespace palpate::haptics {

struct TickRecord {
  double now = 0, state_time = 0;                ///< [s] after the read; measurement
  std::array<double, 3> tip{};                   ///< [mm]
  std::array<double, 4> orientation{};           ///< w, x, y, z
  std::array<double, 3> velocity{};              ///< [mm/s]
  std::uint32_t buttons = 0, flags = 0;          ///< flags: see the constants below
  double written = 0;                            ///< [s] before the write
  std::array<double, 3> force{}, torque{};       ///< [N], [N mm] that were commanded
  std::array<double, 3> tool{}, contact{};       ///< [mm] world
  std::uint32_t contact_state = 0, actions = 0;  ///< `ContactState`, `SafetyAction`
  std::uint64_t nanoseconds = 0;                 ///< of computing; not replayed

  static constexpr std::uint32_t kAnswered = 1, kArmed = 2, kClutched = 4, kExchanged = 8;
};

[[nodiscard]] TickRecord record_of(const TickInput& input, double written,
                                   const TickOutput& output) noexcept;
[[nodiscard]] TickInput input_of(const TickRecord& record) noexcept;

/// Writes a record while a loop runs: the loop hands ticks over without waiting, another thread
/// writes them.
class LoopRecorder {
 public:
  /// \param session further text that a replay needs.
  /// \throws OutputError if the file cannot be written.
  LoopRecorder(const std::filesystem::path& path, const devices::DeviceDescription& device,
               const DeviceLoopOptions& options, const std::string& session = {});
  ~LoopRecorder();

  /// Returns false if the writer is so late that the tick is lost. Real-time safe; one thread.
  bool put(const TickRecord& tick) noexcept;
  /// Waits until there is room: for loops that are not in real time.
  void wait_for_room() const;
  /// Writes the rest and closes the file.
  /// \throws OutputError if the record is not complete: the disk is full, or ticks were lost.
  void finish();

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

struct LoopRecord {
  devices::DeviceDescription device = {};
  DeviceLoopOptions options = {};
  std::string session = {};
  std::vector<TickRecord> ticks = {};
};

/// A record whose last tick is incomplete, as after a loss of power, has the ticks before.
/// \throws FileError if the file is no record, or of another version.
[[nodiscard]] LoopRecord read_loop_record(const std::filesystem::path& path);

/// Comparison of a replay with its record.
struct LoopReplay {
  long long ticks = 0;
  long long different = 0;         ///< ticks whose command or contact differs in any bit
  long long first_different = -1;  ///< its number from 0; -1 for none
};

/// Replays a record from the input that the loop read.
/// \param models as they were exchanged: one more than the record has exchanges.
/// \throws InvalidInput if there are fewer.
[[nodiscard]] LoopReplay replay(const LoopRecord& record, std::span<const Playback* const> models);
/// The same with a world as it was at the start of the session. \param after_tick is called after
/// each tick, if there is such a function.
[[nodiscard]] LoopReplay replay(const LoopRecord& record, ToolWorld& world,
                                const std::function<void()>& after_tick = {});

/// The ticks as a trace: times of the measurements, and forces on the user in the world.
[[nodiscard]] std::vector<TracePoint> trace_of(const LoopRecord& record);

}  // namespace palpate::haptics
