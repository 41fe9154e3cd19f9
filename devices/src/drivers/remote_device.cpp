// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/remote_device.h"

#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>
#include <vector>

#include "drivers/device_structs.h"
#include "drivers/host_messages.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

extern char** environ;

namespace palpate::devices {
namespace {

using RemoteTime = std::chrono::steady_clock;
constexpr int kSocketOfHost = 3;
constexpr const char* kHostProgram = "palpate-device-host";

/// The host beside this program, or its name, which is then looked up on the path.
std::filesystem::path find_host() {
  std::error_code ignored;
  const std::filesystem::path beside =
      std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / kHostProgram;
  return std::filesystem::exists(beside, ignored) ? beside : std::filesystem::path(kHostProgram);
}

}  // namespace

struct RemoteDevice::Process {
  ~Process() {
    if (socket >= 0) close(socket);
    if (pid <= 0 || status) return;
    constexpr std::chrono::seconds kPatience(1);
    if (!wait_for_end(kPatience)) {
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
  }

  void spawn(const std::filesystem::path& host, const std::vector<std::string>& words) {
    int pair[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, static_cast<int*>(pair)) != 0) {
      throw DeviceError(name + ": no socket for its process: " + std::strerror(errno));
    }
    socket = pair[0];
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pair[1], kSocketOfHost);
    // In a process group of its own: Ctrl-C must not end it before the loop has stopped the device.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int not_spawned =
        posix_spawnp(&pid, host.c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(pair[1]);
    if (not_spawned != 0) {
      pid = 0;
      throw FileError(host.string() + ": the host of drivers cannot be started: " +
                      std::strerror(not_spawned) + "; RemoteDeviceOptions::host names the program");
    }
  }

  /// Returns true if the process has ended within this time.
  bool wait_for_end(std::chrono::milliseconds patience) {
    constexpr std::chrono::milliseconds kPause(2);
    const auto end = RemoteTime::now() + patience;
    while (!status) {
      int found = 0;
      const pid_t ended = waitpid(pid, &found, WNOHANG);
      if (ended == pid) status = found;
      if (ended < 0) status = 0;  // another part of the program waited for it
      if (status || RemoteTime::now() > end) break;
      std::this_thread::sleep_for(kPause);
    }
    return status.has_value();
  }

  /// The answer to a request in `answer`; false if none comes in time, or the process has ended.
  bool receive(std::uint32_t number, double timeout) noexcept {
    const auto end = RemoteTime::now() + std::chrono::duration_cast<RemoteTime::duration>(
                                             std::chrono::duration<double>(timeout));
    while (true) {
      const auto left = std::max(RemoteTime::duration(0), end - RemoteTime::now());
      const auto nanoseconds = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
      const timespec patience{.tv_sec = nanoseconds / 1'000'000'000,
                              .tv_nsec = nanoseconds % 1'000'000'000};
      pollfd watched{.fd = socket, .events = POLLIN, .revents = 0};
      const int ready = ppoll(&watched, 1, &patience, nullptr);
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0) return false;
      const ssize_t size = recv(socket, &answer, sizeof(answer), MSG_DONTWAIT);
      if (size < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (size != sizeof(answer)) {
        gone = true;
        return false;
      }
      if (answer.number == number) return true;
      // A late one to a request that was given up.
      if (open_read && answer.number == *open_read) open_read.reset();
    }
  }

  bool send_request(HostRequest& request) noexcept {
    if (gone) return false;
    request.number = ++last_number;
    const ssize_t size = send(socket, &request, sizeof(request), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (size < 0 && errno != EAGAIN) gone = true;
    return size == sizeof(request);
  }

  /// Returns how the process ended, or that it does not answer.
  [[nodiscard]] std::string end_in_words() {
    constexpr std::chrono::milliseconds kPatience(500);
    if (!gone) return "the driver's process does not answer";
    if (!wait_for_end(kPatience)) return "the driver's process closed its connection";
    if (WIFSIGNALED(*status)) {
      return "the driver's process crashed: signal " + std::to_string(WTERMSIG(*status)) + ", " +
             strsignal(WTERMSIG(*status));
    }
    return "the driver's process ended with status " + std::to_string(WEXITSTATUS(*status));
  }

  std::string name;  // of the driver's file
  RemoteDeviceOptions options;
  DeviceDescription description;
  bool has_clock = false;
  double clock = 0;  // [s] of a device with its own, at the latest answer
  pid_t pid = 0;
  std::optional<int> status;  // once it has ended
  int socket = -1;
  std::uint32_t last_number = 0;
  std::optional<std::uint32_t> open_read;  // a request that was not answered in time
  std::uint32_t refused = 0, reported_refused = 0;
  bool gone = false, failed = false;
  HostAnswer answer;
};

RemoteDevice::RemoteDevice(const std::filesystem::path& library, const RemoteDeviceOptions& options)
    : process_(std::make_unique<Process>()) {
  require("RemoteDeviceOptions::open_timeout", options.open_timeout, above(0).finite(), "s");
  require("RemoteDeviceOptions::read_timeout", options.read_timeout, above(0).finite(), "s");
  Process& p = *process_;
  p.name = library.string();
  p.options = options;
  const std::filesystem::path host = options.host.empty() ? find_host() : options.host;
  std::vector<std::string> words = {host.string(), std::to_string(kSocketOfHost),
                                    std::to_string(options.number), library.string()};
  for (const auto& [key, value] : options.driver) words.push_back(key + "=" + value);
  p.spawn(host, words);
  if (!p.receive(0, options.open_timeout)) {
    throw DeviceError(p.name + ": " + p.end_in_words() + " while the driver was loaded");
  }
  if (p.answer.done == 0) {
    const std::string reason = static_cast<const char*>(p.answer.words);
    if (p.answer.invalid != 0) throw FileError(reason);
    throw DeviceError(reason);
  }
  p.has_clock = p.answer.has_clock != 0;
  p.clock = p.answer.now;
  p.description = description_of(p.answer.info, !p.has_clock);
}

RemoteDevice::~RemoteDevice() = default;

const DeviceDescription& RemoteDevice::description() const noexcept {
  return process_->description;
}

double RemoteDevice::now() const noexcept {
  if (process_->has_clock) return process_->clock;
  return std::chrono::duration<double>(RemoteTime::now().time_since_epoch()).count();
}

void RemoteDevice::activate() {
  Process& p = *process_;
  HostRequest request{.kind = HostRequest::activate, .real_time = p.options.real_time ? 1U : 0U};
  if (!p.send_request(request) || !p.receive(request.number, p.options.open_timeout)) {
    throw DeviceError(p.name + ": " + p.end_in_words());
  }
  if (p.answer.done == 0) {
    throw DeviceError(p.name + ": " + static_cast<const char*>(p.answer.words));
  }
}

bool RemoteDevice::read(DeviceState& state) noexcept {
  constexpr double kPeriods = 20;
  Process& p = *process_;
  if (!p.open_read) {
    HostRequest request{.kind = HostRequest::read};
    if (!p.send_request(request)) return false;
    p.open_read = request.number;
  }
  const double timeout = std::max(p.options.read_timeout, kPeriods * p.description.period);
  if (!p.receive(*p.open_read, timeout)) return false;
  p.open_read.reset();
  p.failed = p.answer.done == 0;
  p.refused = p.answer.refused;
  p.clock = p.answer.now;
  if (p.failed) return false;
  state = state_of(p.answer.state, p.description);
  return true;
}

bool RemoteDevice::write(const DeviceCommand& command) noexcept {
  Process& p = *process_;
  HostRequest request{.kind = HostRequest::write, .command = struct_of(command)};
  const bool taken = p.send_request(request) && p.refused == p.reported_refused;
  p.reported_refused = p.refused;
  return taken;
}

void RemoteDevice::stop() noexcept {
  Process& p = *process_;
  HostRequest request{.kind = HostRequest::stop};
  if (p.send_request(request)) static_cast<void>(p.receive(request.number, 1));
}

std::string RemoteDevice::last_error() const {
  Process& p = *process_;
  if (p.gone || p.open_read) return p.end_in_words();
  return static_cast<const char*>(p.answer.words);
}

}  // namespace palpate::devices
