// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate::probing {

/// Ensures that only one process writes into a file. Let go of it after the database is closed,
/// because closing any descriptor of a file drops the locks that SQLite holds on it.
class WriterLock {
 public:
  /// \throws OutputError if the file cannot be written, or is locked by another one.
  explicit WriterLock(const std::filesystem::path& path);
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

 private:
  int file_;
};

}  // namespace palpate::probing
