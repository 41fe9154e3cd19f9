// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <thread>
#include <utility>

namespace palpate::haptics {

/// A file that takes 64 kB and then nothing until it is told to: a pipe.
class SlowFile {
 public:
  explicit SlowFile(std::filesystem::path path) : path_(std::move(path)) {
    if (mkfifo(path_.c_str(), 0600) != 0) throw std::runtime_error("no pipe");
    end_ = open(path_.c_str(), O_RDONLY | O_NONBLOCK);
  }
  ~SlowFile() {
    if (reader_.joinable()) reader_.join();
    close(end_);
  }
  SlowFile(const SlowFile&) = delete;
  SlowFile& operator=(const SlowFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Takes all that is written from now on, in a thread of its own, until the writer closes it.
  void take_everything() {
    take_everything_once([] { return true; });
  }
  /// The same from when the condition holds.
  void take_everything_once(std::function<bool()> condition) {
    reader_ = std::thread([this, condition = std::move(condition)] {
      constexpr std::chrono::milliseconds kPause(1);
      std::array<char, 1 << 16> bytes;
      while (!condition()) std::this_thread::sleep_for(kPause);
      while (true) {
        const ssize_t size = read(end_, bytes.data(), bytes.size());
        if (size == 0) return;
        if (size < 0) std::this_thread::sleep_for(kPause);
      }
    });
  }

 private:
  std::filesystem::path path_;
  int end_ = -1;
  std::thread reader_;
};

}  // namespace palpate::haptics
