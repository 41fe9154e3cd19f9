// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "palpate/core/error.h"

namespace palpate::apps {

FolderLock::FolderLock(const fs::path& folder, With with)
    : handle_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (handle_ == -1) {
    throw OutputError(folder.string() +
                      ": cannot be written: " + std::generic_category().message(errno) + ".");
  }
  const int kind = with == With::nobody ? LOCK_EX : LOCK_SH;
  if (::flock(handle_, kind | LOCK_NB) == -1 && errno == EWOULDBLOCK) {
    ::close(handle_);
    throw OutputError(folder.string() +
                      ": another run of palpate is writing into this folder. Wait until it has "
                      "ended, or choose another folder.");
  }
}

FolderLock::~FolderLock() { ::close(handle_); }

bool is_locked(const fs::path& folder) {
  const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle == -1) return false;
  const bool locked = ::flock(handle, LOCK_SH | LOCK_NB) == -1 && errno == EWOULDBLOCK;
  ::close(handle);
  return locked;
}

}  // namespace palpate::apps
