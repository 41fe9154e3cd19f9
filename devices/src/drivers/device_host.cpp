// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/device_host.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "drivers/device_structs.h"
#include "drivers/host_messages.h"
#include "palpate/core/error.h"
#include "palpate/devices/plugin_device.h"
#include "palpate/devices/real_time.h"

namespace palpate::devices {
namespace {

using HostTime = std::chrono::steady_clock;

using HostWords = char[sizeof(HostAnswer::words)];

void say(HostWords& to, const std::string& words) {
  to[words.copy(static_cast<char*>(to), sizeof(to) - 1)] = '\0';
}

/// The device while it is open, for the thread that ends the process.
struct OpenDevice {
  std::mutex mutex;
  PluginDevice* device = nullptr;
};

/// Ends the process soon after the other end has gone, even if the driver does not return from a
/// call. Its stop is called before, in a thread of its own, since that may hang as well.
void end_without_client(int socket, const std::shared_ptr<OpenDevice>& open) {
  std::thread([socket, open] {
    pollfd watched{.fd = socket, .events = POLLRDHUP, .revents = 0};
    while (poll(&watched, 1, -1) < 0 && errno == EINTR) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    std::thread([open] {
      const std::lock_guard lock(open->mutex);
      if (open->device != nullptr) open->device->stop();
    }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    _exit(1);
  }).detach();
}

/// Shows an open device to that thread for as long as it exists.
class ShownDevice {
 public:
  ShownDevice(OpenDevice& open, PluginDevice& device) : open_(open) { show(&device); }
  ~ShownDevice() { show(nullptr); }
  ShownDevice(const ShownDevice&) = delete;
  ShownDevice& operator=(const ShownDevice&) = delete;

 private:
  void show(PluginDevice* device) {
    const std::lock_guard lock(open_.mutex);
    open_.device = device;
  }
  OpenDevice& open_;
};

class Host {
 public:
  Host(int socket, PluginDevice& device) : socket_(socket), device_(device) {}

  void serve() {
    HostRequest request;
    while (true) {
      if (!wait()) {
        drop_force();
        continue;
      }
      const ssize_t size = recv(socket_, &request, sizeof(request), 0);
      if (size < 0 && errno == EINTR) continue;
      if (size != sizeof(request)) return;
      if (request.kind == HostRequest::write) {
        take(command_of(request.command));
      } else if (!answer(request)) {
        return;
      }
    }
  }

 private:
  /// False if the lease ends before a request comes.
  bool wait() {
    pollfd watched{.fd = socket_, .events = POLLIN, .revents = 0};
    while (true) {
      int milliseconds = -1;
      if (lease_end_) {
        const auto left = *lease_end_ - HostTime::now();
        milliseconds = static_cast<int>(
            std::chrono::ceil<std::chrono::milliseconds>(std::max(left, HostTime::duration(0)))
                .count());
      }
      const int ready = poll(&watched, 1, milliseconds);
      if (ready >= 0 || errno != EINTR) return ready != 0;
    }
  }

  void take(const DeviceCommand& command) {
    if (!device_.write(command)) {
      ++refused_;
      say(refusal_, device_.last_error());
      return;  // the force before may act still, until its lease ends
    }
    lease_end_.reset();
    if (command.force.isZero(0) && command.torque.isZero(0)) return;
    lease_end_ = HostTime::now() + std::chrono::duration_cast<HostTime::duration>(
                                       std::chrono::duration<double>(command.lease));
  }

  void drop_force() {
    lease_end_.reset();
    if (!device_.write({})) device_.stop();
  }

  bool answer(const HostRequest& request) {
    HostAnswer answer{.number = request.number, .done = 1};
    DeviceState state;
    if (request.kind == HostRequest::read) {
      if (device_.read(state)) {
        answer.state = struct_of(state);
      } else {
        answer.done = 0;
      }
    } else if (request.kind == HostRequest::activate) {
      // As the thread of the loop does. It is no failure if that is not allowed: the loop says so.
      if (request.real_time != 0) static_cast<void>(ask_for_real_time());
      try {
        device_.activate();
      } catch (const Error&) {
        answer.done = 0;
      }
    } else {
      device_.stop();
      lease_end_.reset();
    }
    if (answer.done == 0) {
      say(answer.words, device_.last_error());
    } else {
      std::copy(std::begin(refusal_), std::end(refusal_), std::begin(answer.words));
    }
    answer.refused = refused_;
    answer.now = device_.now();
    return send(socket_, &answer, sizeof(answer), MSG_NOSIGNAL) == sizeof(answer);
  }

  int socket_;
  PluginDevice& device_;
  std::uint32_t refused_ = 0;
  HostWords refusal_ = {};                         // why the latest of them was refused
  std::optional<HostTime::time_point> lease_end_;  // of a force that acts
};

}  // namespace

int serve_device(int socket, const std::filesystem::path& library,
                 const std::map<std::string, std::string>& options, unsigned number) {
  const auto open = std::make_shared<OpenDevice>();
  end_without_client(socket, open);
  HostAnswer greeting;
  try {
    PluginDevice device(library, options, number);
    const ShownDevice shown(*open, device);
    greeting.done = 1;
    greeting.has_clock = device.description().real_time ? 0 : 1;
    greeting.now = device.now();
    greeting.info = struct_of(device.description());
    if (send(socket, &greeting, sizeof(greeting), MSG_NOSIGNAL) < 0) return 1;
    Host(socket, device).serve();
    return 0;
  } catch (const Error& wrong) {
    greeting.invalid = dynamic_cast<const InvalidInput*>(&wrong) != nullptr ? 1 : 0;
    say(greeting.words, wrong.what());
    static_cast<void>(send(socket, &greeting, sizeof(greeting), MSG_NOSIGNAL));
    return 1;
  }
}

}  // namespace palpate::devices
