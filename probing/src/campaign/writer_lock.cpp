// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "campaign/writer_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "palpate/core/error.h"

namespace palpate::probing {

WriterLock::WriterLock(const std::filesystem::path& path)
    : file_(::open(path.c_str(), O_RDWR | O_CLOEXEC)) {
  if (file_ < 0) throw OutputError(path.string() + ": cannot be written: " + std::strerror(errno));
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    ::close(file_);
    throw OutputError(path.string() +
                      ": another process writes into it; wait for it, or end it first");
  }
}

WriterLock::~WriterLock() { ::close(file_); }

}  // namespace palpate::probing
