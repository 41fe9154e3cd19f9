// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/projector_window.h"

#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <vector>

#include "palpate/core/error.h"
#include "shared/program.h"

extern char** environ;

namespace palpate::apps {
namespace {

constexpr const char* kProgram = "palpate-project";
constexpr const char* kRefused = "refused: ";

DeviceError no_window(const std::string& reason) {
  return DeviceError("the window on the projector: " + reason);
}

/// Starts the program with both of its ends at `socket`.
pid_t start(const fs::path& program, const std::string& monitor, int socket) {
  std::vector<std::string> words{program.string(), "--follow"};
  if (!monitor.empty()) words.insert(words.end(), {"--monitor", monitor});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, socket, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, socket, STDOUT_FILENO);
  pid_t child = -1;
  const int failed =
      posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    throw no_window(program.string() + " cannot be started: " +
                    std::generic_category().message(failed) + ". It is installed with palpate.");
  }
  return child;
}

}  // namespace

ProjectorWindow::ProjectorWindow(const std::string& monitor) {
  std::array<int, 2> ends{};
  // A socket and not a pipe: writing to a program that has ended is then no signal.
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw no_window(std::generic_category().message(errno));
  socket_ = ends[0];
  try {
    program_ = start(program_folder() / kProgram, monitor, ends[1]);
  } catch (...) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw;
  }
  ::close(ends[1]);
  try {
    static_cast<void>(answer());  // it is open
  } catch (...) {
    ::close(socket_);
    ::waitpid(program_, nullptr, 0);
    throw;
  }
}

ProjectorWindow::~ProjectorWindow() {
  ::close(socket_);  // which ends it
  ::waitpid(program_, nullptr, 0);
}

void ProjectorWindow::show(const fs::path& image) {
  const std::string line = fs::absolute(image).string() + "\n";
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t now = ::send(socket_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (now == -1 && errno == EINTR) continue;
    if (now == -1) break;  // the answer says that it has ended
    sent += static_cast<std::size_t>(now);
  }
  const std::string said = answer();
  if (said.starts_with(kRefused)) throw InvalidInput(said.substr(std::string(kRefused).size()));
}

std::string ProjectorWindow::answer() {
  for (std::size_t end = 0; true;) {
    end = received_.find('\n');
    if (end != std::string::npos) {
      const std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      return line;
    }
    std::array<char, 512> buffer{};
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (count == -1 && errno == EINTR) continue;
    if (count <= 0) throw no_window("it was closed, or could not be opened");
    received_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace palpate::apps
