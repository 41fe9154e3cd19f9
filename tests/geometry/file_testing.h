// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <csignal>
#include <exception>
#include <filesystem>
#include <string>
#include <typeinfo>
#include <vector>

#include "scratch_folder.h"

namespace palpate::geometry {

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

/// Appends a number as a file of the given byte order holds it.
template <typename Number>
void put(std::string& bytes, Number value, std::endian order = std::endian::little) {
  auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// A unit tetrahedron's faces, counter-clockwise from outside.
inline const std::vector<Eigen::Vector3d> kTetrahedronCorners{
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline const std::vector<Eigen::Vector3i> kTetrahedronFaces{
    {0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

/// Checks that `statement` throws `Exception` (not one derived from it) and that its message has
/// `words`: what it tells the user to do.
#define EXPECT_THROWS_MESSAGE(statement, Exception, words)                               \
  try {                                                                                  \
    statement;                                                                           \
    ADD_FAILURE() << "nothing was thrown";                                               \
  } catch (const std::exception& error) {                                                \
    EXPECT_EQ(typeid(error), typeid(Exception)) << error.what();                         \
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what(); \
  }

}  // namespace palpate::geometry
