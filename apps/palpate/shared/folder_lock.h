// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "shared/aliases.h"

namespace palpate::apps {

/// Lets only one run of the program at a time write into a folder, or only such that share it. The
/// lock ends with the process, however that ends.
class FolderLock {
 public:
  /// Whom the lock admits besides its holder.
  enum class With {
    nobody,
    others,  ///< that also admit others
  };

  /// On a file system without locks, concurrent runs are not detected.
  /// \throws OutputError if another run has the lock, or if there is no such folder.
  explicit FolderLock(const fs::path& folder, With with = With::nobody);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int handle_ = -1;
};

/// Whether another run of the program is writing into a folder; false if there is no such folder.
[[nodiscard]] bool is_locked(const fs::path& folder);

}  // namespace palpate::apps
