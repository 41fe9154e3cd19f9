// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "palpate/devices/device.h"

// A record of a device: all that a program read from it and commanded it, exactly. The file begins
// with one line of JSON, {"format": "palpate arm record", "version": 2, "byte_order": "little",
// "name": ..., "period": ..., "highest_force": ..., "continuous_force": ..., "measures_joints":
// ..., "measures_force": ..., "measures_heat": ..., "measures_reference": ..., "real_time": ...,
// "session": ...}, and a line break. Each event follows as one byte and its numbers, doubles of 8
// bytes or a whole number of 8 bytes:
//
//     N time                           the clock was asked
//     T trial (whole number)           a trial begins
//     A                                motors on
//     R time tip[3] joints[3] force[3] heat[3] reference_force[3]    a state was read
//     F                                a state could not be read
//     W force[3] lease                 a command was taken
//     V force[3] lease                 a command was not taken
//     S                                motors off
//
// Records of version 1, which have no reference force, can be replayed too.
namespace palpate::devices {

/// Records another device, which must outlive it. Writes go through a buffer of 1 MB.
class RecordingDevice final : public Device {
 public:
  /// \param session further text that a replay needs.
  /// \throws OutputError if the file cannot be written.
  RecordingDevice(Device& device, const std::filesystem::path& path,
                  const std::string& session = {});
  ~RecordingDevice() override;

  [[nodiscard]] const DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  void begin_trial(long long trial) noexcept override;
  [[nodiscard]] bool read(DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const DeviceCommand& command) noexcept override;
  void stop() noexcept override;
  [[nodiscard]] std::string last_error() const override;

  /// Writes what is buffered, so that it survives the end of the program. Also while another thread
  /// uses the device. \throws OutputError if the record is not complete: a full disk.
  void flush();

 private:
  struct File;
  Device& device_;
  std::unique_ptr<File> file_;
};

/// A device that answers as in a record, as long as it gets the recorded commands; the same program
/// gets the same measurements from it. At the end of the record, or at a command that differs, it
/// does not answer any more, and `last_error` says why.
class ReplayDevice final : public Device {
 public:
  /// \throws FileError if the file is no record, or of another version.
  explicit ReplayDevice(const std::filesystem::path& path);
  ~ReplayDevice() override;
  /// The text that was given to `RecordingDevice`.
  [[nodiscard]] const std::string& session() const noexcept;

  [[nodiscard]] const DeviceDescription& description() const noexcept override;
  [[nodiscard]] double now() const noexcept override;
  void activate() override;
  /// Goes to the beginning of this trial in the record; if it has none, continues.
  void begin_trial(long long trial) noexcept override;
  [[nodiscard]] bool read(DeviceState& state) noexcept override;
  [[nodiscard]] bool write(const DeviceCommand& command) noexcept override;
  void stop() noexcept override;
  [[nodiscard]] std::string last_error() const override;

 private:
  struct Tape;
  std::unique_ptr<Tape> tape_;
};

}  // namespace palpate::devices
