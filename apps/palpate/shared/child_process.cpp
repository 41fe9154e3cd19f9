// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "palpate/core/error.h"

extern char** environ;

namespace palpate::apps {
namespace {

OutputError not_started(const std::string& program, int reason) {
  return OutputError(program + ": cannot be started: " + std::generic_category().message(reason) +
                     ".");
}

/// A pipe whose ends are closed with it.
class Pipe {
 public:
  explicit Pipe(const std::string& program) {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) throw not_started(program, errno);
  }
  ~Pipe() {
    close_writer();
    ::close(ends_[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] int reader() const { return ends_[0]; }
  [[nodiscard]] int writer() const { return ends_[1]; }
  void close_writer() {
    if (ends_[1] != -1) ::close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

pid_t start(std::vector<std::string>& words, const Pipe& out, const Pipe& err) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.writer(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.writer(), STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = -1;
  const int failed =
      ::posix_spawnp(&child, arguments.front(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw not_started(words.front(), failed);
  return child;
}

/// Adds what there is to read; false at the end.
bool read_some(int reader, std::string& text) {
  std::array<char, 4096> buffer{};
  const ssize_t count = ::read(reader, buffer.data(), buffer.size());
  if (count < 0) return errno == EINTR;
  text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

/// Reads both until they end, whichever has something first: a full pipe would stop the program.
void read_all(const Pipe& out, const Pipe& err, ChildResult& result) {
  std::array<pollfd, 2> waiting{pollfd{.fd = out.reader(), .events = POLLIN, .revents = 0},
                                pollfd{.fd = err.reader(), .events = POLLIN, .revents = 0}};
  const std::array<std::string*, 2> texts{&result.out, &result.err};
  while (waiting[0].fd != -1 || waiting[1].fd != -1) {
    if (::poll(waiting.data(), waiting.size(), -1) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (waiting.at(i).fd == -1 || waiting.at(i).revents == 0) continue;
      if (!read_some(waiting.at(i).fd, *texts.at(i))) waiting.at(i).fd = -1;
    }
  }
}

}  // namespace

ChildResult run_child(std::vector<std::string> words) {
  Pipe out(words.front()), err(words.front());
  const pid_t child = start(words, out, err);
  out.close_writer();
  err.close_writer();
  ChildResult result;
  read_all(out, err, result);
  int status = 0;
  while (::waitpid(child, &status, 0) == -1 && errno == EINTR) continue;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace palpate::apps
