// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/device_record.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/devices/device_description_json.h"

namespace palpate::devices {
namespace {

using nlohmann::json;

constexpr const char* kRecordFormat = "palpate arm record";
constexpr int kRecordVersion = 2;
constexpr std::size_t kStateNumbers = 16, kCommandNumbers = 4;
constexpr std::size_t kStateNumbersOfVersion1 = 13;  // without the reference force
constexpr const char* kRecordExpected = "; expected the file of 'palpate probe run --record'";
static_assert(std::endian::native == std::endian::little, "the file is in the order of the host");

using StateNumbers = std::array<double, kStateNumbers>;
using CommandNumbers = std::array<double, kCommandNumbers>;

StateNumbers numbers_of(const DeviceState& state) {
  StateNumbers numbers{state.time};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    numbers[1 + i] = state.tip[k];
    numbers[4 + i] = state.joints[k];
    numbers[7 + i] = state.delivered_force[k];
    numbers[10 + i] = state.heat[k];
    numbers[13 + i] = state.reference_force[k];
  }
  return numbers;
}

DeviceState state_of(const StateNumbers& numbers) {
  DeviceState state;
  state.time = numbers[0];
  state.tip = Eigen::Vector3d(&numbers[1]);
  state.joints = Eigen::Vector3d(&numbers[4]);
  state.delivered_force = Eigen::Vector3d(&numbers[7]);
  state.heat = Eigen::Vector3d(&numbers[10]);
  state.reference_force = Eigen::Vector3d(&numbers[13]);
  return state;
}

CommandNumbers numbers_of(const DeviceCommand& command) {
  return {command.force.x(), command.force.y(), command.force.z(), command.lease};
}

/// [bytes] Size of an event after its letter; negative for an unknown letter.
int size_of_event(char letter, std::size_t state_numbers) {
  constexpr int kNumber = 8;
  switch (letter) {
    case 'N':
    case 'T':
      return kNumber;
    case 'R':
      return kNumber * static_cast<int>(state_numbers);
    case 'W':
    case 'V':
      return kNumber * static_cast<int>(kCommandNumbers);
    case 'A':
    case 'F':
    case 'S':
      return 0;
    default:
      return -1;
  }
}

}  // namespace

struct RecordingDevice::File {
  explicit File(const std::filesystem::path& where) : path(where), buffer(std::size_t{1} << 20) {
    file = std::fopen(path.c_str(), "wb");
    if (file == nullptr)
      throw OutputError(path.string() + ": cannot be written: " + std::strerror(errno));
    std::setvbuf(file, buffer.data(), _IOFBF, buffer.size());
  }
  ~File() {
    if (file != nullptr) std::fclose(file);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void put(const void* bytes, std::size_t size) noexcept {
    if (std::fwrite(bytes, 1, size, file) != size) complete = false;
  }
  void event(char letter) noexcept { put(&letter, 1); }
  template <typename Numbers>
  void event(char letter, const Numbers& numbers) noexcept {
    event(letter);
    put(&numbers, sizeof(numbers));
  }

  std::filesystem::path path;
  std::vector<char> buffer;
  std::FILE* file = nullptr;
  // The thread that holds a device between trials writes too, while another one flushes.
  std::atomic<bool> complete = true;
};

RecordingDevice::RecordingDevice(Device& device, const std::filesystem::path& path,
                                 const std::string& session)
    : device_(device), file_(std::make_unique<File>(path)) {
  nlohmann::ordered_json members{
      {"format", kRecordFormat}, {"version", kRecordVersion}, {"byte_order", "little"}};
  members.update(nlohmann::ordered_json::parse(to_json(device.description())));
  members["session"] = session;
  const std::string head = members.dump() + "\n";
  file_->put(head.data(), head.size());
}

RecordingDevice::~RecordingDevice() = default;

const DeviceDescription& RecordingDevice::description() const noexcept {
  return device_.description();
}

double RecordingDevice::now() const noexcept {
  const double time = device_.now();
  file_->event('N', time);
  return time;
}

void RecordingDevice::activate() {
  device_.activate();
  file_->event('A');
}

void RecordingDevice::begin_trial(long long trial) noexcept {
  file_->event('T', static_cast<std::int64_t>(trial));
  device_.begin_trial(trial);
}

bool RecordingDevice::read(DeviceState& state) noexcept {
  if (!device_.read(state)) {
    file_->event('F');
    return false;
  }
  file_->event('R', numbers_of(state));
  return true;
}

bool RecordingDevice::write(const DeviceCommand& command) noexcept {
  const bool taken = device_.write(command);
  file_->event(taken ? 'W' : 'V', numbers_of(command));
  return taken;
}

void RecordingDevice::stop() noexcept {
  device_.stop();
  file_->event('S');
}

std::string RecordingDevice::last_error() const { return device_.last_error(); }

void RecordingDevice::flush() {
  if (std::fflush(file_->file) != 0) file_->complete = false;
  if (!file_->complete)
    throw OutputError(file_->path.string() + ": could not be written completely; free some space");
}

struct ReplayDevice::Tape {
  explicit Tape(const std::filesystem::path& where) : path(where.string()) {
    file = std::fopen(path.c_str(), "rb");
    if (file == nullptr)
      throw FileError(path + ": cannot be read: " + std::strerror(errno) + kRecordExpected);
    read_head();
    begin = std::ftell(file);
  }
  ~Tape() {
    if (file != nullptr) std::fclose(file);
  }
  Tape(const Tape&) = delete;
  Tape& operator=(const Tape&) = delete;

  void read_head() {
    constexpr std::size_t kLongest = std::size_t{1} << 20;  // [bytes]
    std::string head;
    for (int c = std::fgetc(file); c != EOF && c != '\n' && head.size() < kLongest;
         c = std::fgetc(file))
      head += static_cast<char>(c);
    const json members = json::parse(head, nullptr, false);
    if (!members.is_object() || !members.contains("format") || members["format"] != kRecordFormat)
      throw FileError(path + ": is no record of an arm" + kRecordExpected);
    const json version = members.value("version", json(0));
    if (version != kRecordVersion && version != 1) {
      throw FileError(path + ": is a record of version " + version.dump() +
                      "; this program reads 1 to " + std::to_string(kRecordVersion));
    }
    if (version == 1) state_numbers = kStateNumbersOfVersion1;
    try {
      description = device_description_of(head);
      members.at("session").get_to(session);
    } catch (const InvalidInput& wrong) {
      throw FileError(path + ": its first line is damaged: " + wrong.what());
    } catch (const json::exception& wrong) {
      throw FileError(path + ": its first line is damaged: " + wrong.what());
    }
    description.real_time = false;
  }

  /// Reads the letter of an event and its numbers if it has this letter; otherwise the position in
  /// the file does not change.
  bool take(char letter, void* numbers = nullptr, std::size_t size = 0) noexcept {
    if (broken != nullptr) return false;
    const int found = std::fgetc(file);
    if (found != letter) {
      if (found != EOF) std::ungetc(found, file);
      ended = found == EOF;
      return false;
    }
    if (size == 0) return true;
    ended = std::fread(numbers, size, 1, file) != 1;
    return !ended;
  }
  void depart(const char* from) noexcept {
    if (broken == nullptr) broken = ended ? "the record ends here" : from;
  }

  /// Moves behind the next beginning of the trial after this position. False if there is none.
  bool seek_from(long place, std::int64_t trial) noexcept {
    std::fseek(file, place, SEEK_SET);
    std::array<char, sizeof(StateNumbers)> numbers{};
    for (int letter = std::fgetc(file); letter != EOF; letter = std::fgetc(file)) {
      const int size = size_of_event(static_cast<char>(letter), state_numbers);
      if (size < 0 || std::fread(numbers.data(), 1, static_cast<std::size_t>(size), file) !=
                          static_cast<std::size_t>(size))
        return false;
      std::int64_t number = 0;
      std::memcpy(&number, numbers.data(), sizeof(number));
      if (letter == 'T' && number == trial) return true;
    }
    return false;
  }
  void seek(std::int64_t trial) noexcept {
    const long place = std::ftell(file);
    if (!seek_from(place, trial) && !seek_from(begin, trial)) std::fseek(file, place, SEEK_SET);
  }

  std::string path;
  std::FILE* file = nullptr;
  long begin = 0;  // [bytes] of the first event
  std::size_t state_numbers = kStateNumbers;
  std::string session;
  DeviceDescription description;
  double time = 0;  // latest reading of the clock
  bool ended = false;
  const char* broken = nullptr;  // why the replay has ended
};

ReplayDevice::ReplayDevice(const std::filesystem::path& path)
    : tape_(std::make_unique<Tape>(path)) {}

ReplayDevice::~ReplayDevice() = default;

const std::string& ReplayDevice::session() const noexcept { return tape_->session; }

const DeviceDescription& ReplayDevice::description() const noexcept { return tape_->description; }

double ReplayDevice::now() const noexcept {
  double time = 0;
  if (tape_->take('N', &time, sizeof(time))) tape_->time = time;
  return tape_->time;
}

void ReplayDevice::activate() {
  if (!tape_->take('A')) tape_->depart("the motors were not switched on here");
}

void ReplayDevice::begin_trial(long long trial) noexcept { tape_->seek(trial); }

bool ReplayDevice::read(DeviceState& state) noexcept {
  StateNumbers numbers{};
  std::fill(numbers.begin() + kStateNumbersOfVersion1, numbers.end(), DeviceState::kNotMeasured);
  if (tape_->take('R', numbers.data(), tape_->state_numbers * sizeof(double))) {
    state = state_of(numbers);
    return true;
  }
  if (!tape_->take('F')) tape_->depart("no state was read here");
  return false;
}

bool ReplayDevice::write(const DeviceCommand& command) noexcept {
  CommandNumbers numbers{};
  const bool taken = tape_->take('W', numbers.data(), sizeof(numbers));
  if (!taken && !tape_->take('V', numbers.data(), sizeof(numbers))) {
    tape_->depart("nothing was commanded here");
    return false;
  }
  if (numbers != numbers_of(command)) {
    tape_->depart("another force was commanded here");
    return false;
  }
  return taken;
}

void ReplayDevice::stop() noexcept { static_cast<void>(tape_->take('S')); }

std::string ReplayDevice::last_error() const {
  if (tape_->broken == nullptr) return {};
  return tape_->path + " at " + std::to_string(tape_->time) + " s: " + tape_->broken;
}

}  // namespace palpate::devices
