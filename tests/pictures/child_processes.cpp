// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "child_processes.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace palpate::pictures {
namespace {

/// The first two words of /proc/PID/stat after the name: state and parent.
struct Status {
  char state = '\0';  // that if there is no such process
  pid_t parent = 0;
};

Status status_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  std::getline(file, line);
  // The name is in brackets and may hold anything, so its end is the last bracket.
  std::istringstream words(line.substr(std::min(line.size(), line.rfind(')') + 1)));
  Status status;
  words >> status.state >> status.parent;
  return status;
}

}  // namespace

std::vector<pid_t> child_processes() {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const auto process = static_cast<pid_t>(std::atoi(entry.path().filename().c_str()));
    if (process > 0 && status_of(process).parent == getpid()) {
      found.push_back(process);
    }
  }
  return found;
}

bool has_ended(pid_t process) {
  const char state = status_of(process).state;
  return state == '\0' || state == 'Z';
}

}  // namespace palpate::pictures
