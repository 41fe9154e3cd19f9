// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "offscreen_display.h"

#include <X11/Xlib.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <optional>
#include <semaphore>
#include <sstream>
#include <string>
#include <thread>

#include "palpate/core/error.h"

namespace palpate::pictures {
namespace {

/// [ms] that Xvfb may take to say its number; it takes about 200 on an idle machine.
constexpr int kStartTimeout = 30'000;

/// [ms] That Xvfb may take to end, and after which it is asked again; it takes a few.
constexpr int kEndTimeout = 3'000;
constexpr int kEndStep = 100;

/// The first file descriptor after the standard ones; Xvfb is told of it as kFreeNumberText.
constexpr int kFreeNumber = 3;
constexpr const char* kFreeNumberText = "3";

std::optional<std::string> find_program(const char* name) {
  const char* search = std::getenv("PATH");
  std::istringstream folders(search != nullptr ? search : "/usr/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string candidate = (std::filesystem::path(folder) / name).string();
    if (access(candidate.c_str(), X_OK) == 0) {
      return candidate;
    }
  }
  return std::nullopt;
}

/// In the new process: becomes Xvfb, which writes its display number to `number_fd`. Between fork
/// and exec only system calls are allowed, because another thread may hold any lock.
[[noreturn]] void become_xvfb(const char* program, int number_fd, pid_t parent) {
  // The server goes even if this process is killed; if it already was, the signal would never come.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  setsid();  // a Ctrl-C in the terminal is for this process, which still has to draw
  const int number = fcntl(number_fd, F_DUPFD, kFreeNumber + 1);
  const int nowhere = open("/dev/null", O_RDWR);
  if (getppid() != parent || number < 0 || nowhere < 0) {
    _exit(EXIT_FAILURE);
  }
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    dup2(nowhere, standard);
  }
  dup2(number, kFreeNumber);
  // Nothing else stays open: a pipe that the server keeps would never end for its reader.
  close_range(kFreeNumber + 1, ~0U, 0);
  // Windows are never shown, so the screen can be small. Without -noreset the server starts afresh
  // after each picture and may refuse the next connection meanwhile.
  execl(program, "Xvfb", "-displayfd", kFreeNumberText, "-nolisten", "tcp", "-noreset", "-screen",
        "0", "64x64x24", static_cast<char*>(nullptr));
  _exit(EXIT_FAILURE);
}

/// Returns the output of Xvfb up to the end of the line; empty if it ended or stayed silent.
std::string read_display_number(int fd) {
  std::string number;
  for (char digit = 0; number.empty() || number.back() != '\n'; number += digit) {
    pollfd wanted{fd, POLLIN, 0};
    const int ready = poll(&wanted, 1, kStartTimeout);
    if (ready < 0 && errno == EINTR) {
      continue;
    }
    if (ready <= 0 || read(fd, &digit, 1) != 1) {
      return {};
    }
  }
  number.pop_back();
  return number;
}

struct Server {
  pid_t process = -1;
  std::string name;  // for XOpenDisplay
};

/// Xvfb removes its lock file and its socket when it is asked to end; waiting leaves no zombie. A
/// server that is asked just before it falls asleep notices only when it wakes: it is asked again,
/// and killed in the end.
void end_server(pid_t process) noexcept {
  for (int wait = 0; wait < kEndTimeout; wait += kEndStep) {
    kill(process, wait < kEndTimeout - kEndStep ? SIGTERM : SIGKILL);
    for (int step = 0; step < kEndStep; ++step) {
      if (waitpid(process, nullptr, WNOHANG) != 0) {
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

Server start_server() {
  const std::optional<std::string> program = find_program("Xvfb");
  if (!program) {
    throw OutputError(
        "pictures need an X server and there is neither one that DISPLAY names nor Xvfb: install "
        "the package xvfb (apt-get install xvfb)");
  }
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw OutputError("pictures: cannot make a pipe to Xvfb: too many open files");
  }
  const pid_t self = getpid();
  const pid_t child = fork();
  if (child == 0) {
    become_xvfb(program->c_str(), ends[1], self);
  }
  close(ends[1]);
  const std::string number = child > 0 ? read_display_number(ends[0]) : std::string();
  close(ends[0]);
  if (number.empty()) {
    if (child > 0) {
      end_server(child);
    }
    throw OutputError("pictures: " + *program +
                      " does not start; run 'Xvfb :99' to see why (it may need the package "
                      "xkb-data, or room in /tmp)");
  }
  return {child, ":" + number};
}

/// The X server in memory, one for the process: the static object in `memory_server` ends it.
class MemoryServer {
 public:
  MemoryServer() = default;
  MemoryServer(const MemoryServer&) = delete;
  MemoryServer& operator=(const MemoryServer&) = delete;
  ~MemoryServer() {
    if (owner_ == getpid()) {
      stop();
    } else if (keeper_.joinable()) {
      keeper_.detach();  // a copy that a fork made: neither the thread nor the server is its own
    }
  }

  /// Returns true if the server that was started still runs.
  [[nodiscard]] bool runs() {
    const bool has_ended =
        server_.process > 0 && waitpid(server_.process, nullptr, WNOHANG) == server_.process;
    if (has_ended) {
      server_.process = -1;
      stop();
    }
    return server_.process > 0;
  }

  /// The server's name, started now unless it runs.
  const std::string& name() {
    if (!runs()) {
      start();
    }
    return server_.name;
  }

 private:
  /// The server starts on a thread of its own that lives as long as it: "the parent's death", at
  /// which Linux ends the server, is that of the thread which forked, and the one that draws may
  /// end first.
  void start() {
    std::promise<Server> started;
    keeper_ = std::thread([this, &started] {
      try {
        started.set_value(start_server());
      } catch (...) {
        started.set_exception(std::current_exception());
      }
      no_longer_needed_.acquire();
    });
    try {
      server_ = started.get_future().get();
    } catch (...) {
      stop();
      throw;
    }
  }

  void stop() noexcept {
    if (server_.process > 0) {
      end_server(server_.process);
      server_.process = -1;
    }
    if (keeper_.joinable()) {
      no_longer_needed_.release();
      keeper_.join();
    }
  }

  pid_t owner_ = getpid();
  Server server_;
  std::thread keeper_;
  std::binary_semaphore no_longer_needed_{0};
};

bool has_opengl(Display* connection) {
  int opcode = 0;
  int event = 0;
  int error = 0;
  return XQueryExtension(connection, "GLX", &opcode, &event, &error) != 0;
}

MemoryServer& memory_server() {
  static MemoryServer server;
  return server;
}

Display* connect_to_desktop() {
  Display* desktop = XOpenDisplay(nullptr);
  if (desktop != nullptr && !has_opengl(desktop)) {
    XCloseDisplay(desktop);
    return nullptr;
  }
  return desktop;
}

Display* connect_to_memory() {
  const std::string& name = memory_server().name();
  Display* memory = XOpenDisplay(name.c_str());
  if (memory == nullptr) {
    throw OutputError("pictures: Xvfb runs as " + name + " but refuses the connection");
  }
  if (!has_opengl(memory)) {
    XCloseDisplay(memory);
    throw OutputError(
        "pictures: Xvfb has no OpenGL: install the package libgl1-mesa-dri (apt-get install "
        "libgl1-mesa-dri)");
  }
  return memory;
}

/// The connection of the process. One to a server in memory that has ended is left as it is, since
/// Xlib ends the process that closes it.
Display* connection() {
  static Display* kept = nullptr;
  static bool in_memory = false;
  if (kept == nullptr || (in_memory && !memory_server().runs())) {
    kept = connect_to_desktop();
    in_memory = kept == nullptr;
    if (in_memory) {
      kept = connect_to_memory();
    }
  }
  return kept;
}

std::mutex& drawing() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

OffscreenDisplay::OffscreenDisplay() : turn_(drawing()), connection_(connection()) {}

}  // namespace palpate::pictures
