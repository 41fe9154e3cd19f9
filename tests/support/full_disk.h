// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "scratch_folder.h"

namespace palpate {

/// While it lives, no file of this process can grow beyond `bytes`: the next write fails as it
/// would on a full disk, only with another reason.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit small{bytes, limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit limit_{};
  void (*handler_)(int);
};

/// Overwrites a file that is there already. It is removed first: ext4 would write every one that
/// was cut off to the disk at once, which takes a millisecond.
inline void overwrite(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::remove(path);
  write_text(path, text);
}

}  // namespace palpate
