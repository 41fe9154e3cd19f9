// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

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

/// The folder into which a command writes many files, one after the other.
///
/// Results of an earlier run stay as a whole until those of this run are complete: this run then
/// writes into a hidden folder beside them, and `finish` puts its files in their place. If there
/// are none, or the earlier run is resumed, it writes into the folder itself. So a folder never
/// holds files of two runs.
///
/// Only one run at a time may write into a folder.
class ResultFolder {
 public:
  /// Lists the results of a finished run in a folder, relative to it. May throw InvalidInput if
  /// there are files that the command must not replace.
  using List = std::function<std::vector<fs::path>(const fs::path&)>;

  /// What becomes of a run that does not finish while earlier results are in the folder.
  enum class Unfinished {
    dropped,
    kept,     ///< for a run with `resumed`
    resumed,  ///< kept, and continues what an earlier run kept
  };

  /// Locks the folder, which is made if it is missing. If an earlier run was killed while it put
  /// its results in their place, that is completed.
  /// \throws OutputError if another run writes into the folder.
  ResultFolder(fs::path folder, List list, Unfinished unfinished);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// The folder into which this run writes its files.
  [[nodiscard]] const fs::path& place() const { return place_; }

  /// True if the folder has results of an earlier run, which `finish` replaces.
  [[nodiscard]] bool replaces() const { return place_ != folder_; }

  /// What the folder holds if this run ends now, for a message: "12 of 60 frames are finished and
  /// kept; continue with --resume".
  [[nodiscard]] std::string what_is_kept(std::size_t frames, std::size_t all) const;

  /// To be called before the first file is written: forgets an unfinished run that is not resumed.
  void begin() const;

  /// To be called when all files are written: puts them in their place and removes the results of
  /// the earlier run of which there is no new version. If the run wrote into the folder itself,
  /// results that are not among `mine` are removed; `mine` gets their paths relative to the folder.
  /// \throws OutputError if that is not possible.
  void finish(const std::function<bool(const fs::path&)>& mine);

 private:
  void put_in_place() const;

  fs::path folder_;
  List list_;
  Unfinished unfinished_;
  fs::path place_;
  bool is_new_ = false;  ///< made by this run
  std::optional<FolderLock> lock_;
};

/// Where an unfinished run into a folder that is kept has written: into a hidden folder in it, or
/// into the folder itself.
[[nodiscard]] std::filesystem::path unfinished_place(const std::filesystem::path& folder);

/// Checks, for readers, that the results in `folder` are those of one run.
/// \throws FileError if a run puts its results in their place, or was killed while it did.
void check_is_of_one_run(const fs::path& folder);

}  // namespace palpate::apps
