// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/result_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/output_file.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

// The name of a run's hidden folder states how far the run is. It is renamed atomically, so that a
// run that was killed can be continued from there.
constexpr const char* kWriting = ".palpate-unfinished";
constexpr const char* kFinished = ".palpate-finished";  // results without a new version are removed
constexpr const char* kPlacing = ".palpate-placing";    // its files are moved into place
constexpr const char* kDropped = ".palpate-dropped";    // of a run that is not resumed

/// All files in `folder`, relative to it, without left-over temporaries. Records come last, so that
/// whatever a record in place names is in place as well.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory() && !is_hidden(entry.path()))
      files.push_back(entry.path().lexically_relative(folder));
  }
  std::ranges::sort(files);
  std::stable_partition(files.begin(), files.end(),
                        [](const fs::path& file) { return file.extension() != ".jsonl"; });
  return files;
}

OutputError place_error(const fs::path& folder, const fs::filesystem_error& error) {
  return OutputError(
      folder.string() + ": the results cannot be put in their place: " + error.path1().string() +
      ": " + error.code().message() + ". The next run into this folder tries again.");
}

}  // namespace

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

ResultFolder::ResultFolder(fs::path folder, List list, Unfinished unfinished)
    : folder_(std::move(folder)),
      list_(std::move(list)),
      unfinished_(unfinished),
      is_new_(!is_there(folder_)) {
  std::error_code failed;
  fs::create_directories(folder_, failed);
  lock_.emplace(folder_);
  remove_left_overs(folder_);
  put_in_place();
  const bool has_results = !list_(folder_).empty();
  const bool goes_on = unfinished_ == Unfinished::resumed && is_there(folder_ / kWriting);
  const bool beside = goes_on || (has_results && unfinished_ != Unfinished::resumed);
  place_ = beside ? folder_ / kWriting : folder_;
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;
  if (replaces() && unfinished_ == Unfinished::dropped) fs::remove_all(place_, ignored);
  if (is_new_) fs::remove(folder_, ignored);  // if nothing was written
}

std::string ResultFolder::what_is_kept(std::size_t frames, std::size_t all) const {
  std::string words;
  if (replaces()) words = folder_.string() + " holds the results of the earlier run, unchanged; ";
  if (unfinished_ == Unfinished::dropped && replaces())
    return words + "those of this run are dropped";
  words += fmt::format("{} of {} frames are finished", frames, all);
  if (frames == 0 || unfinished_ == Unfinished::dropped) return words;
  return words + (replaces() ? " and kept apart" : " and kept") + "; continue with --resume";
}

void ResultFolder::begin() const {
  const bool goes_on = replaces() && unfinished_ == Unfinished::resumed;
  if (goes_on) return;
  try {
    fs::remove_all(folder_ / kDropped);
    if (is_there(folder_ / kWriting)) {
      fs::rename(folder_ / kWriting, folder_ / kDropped);
      fs::remove_all(folder_ / kDropped);
    }
    fs::create_directories(place_);
  } catch (const fs::filesystem_error& error) {
    throw OutputError(place_.string() + ": cannot be written: " + error.code().message() + ".");
  }
}

void ResultFolder::finish(const std::function<bool(const fs::path&)>& mine) {
  try {
    if (replaces()) {
      fs::rename(place_, folder_ / kFinished);
      put_in_place();
      place_ = folder_;
      return;
    }
    for (const fs::path& file : list_(folder_)) {
      if (!mine(file)) fs::remove(folder_ / file);
    }
  } catch (const fs::filesystem_error& error) {
    throw place_error(folder_, error);
  }
}

void ResultFolder::put_in_place() const {
  const fs::path finished = folder_ / kFinished;
  const fs::path placing = folder_ / kPlacing;
  try {
    if (is_there(finished)) {
      for (const fs::path& file : list_(folder_)) {
        if (!is_there(finished / file)) fs::remove(folder_ / file);
      }
      fs::rename(finished, placing);
    }
    if (!is_there(placing)) return;
    for (const fs::path& file : files_in(placing)) {
      fs::create_directories((folder_ / file).parent_path());
      fs::rename(placing / file, folder_ / file);
    }
    fs::remove_all(placing);
  } catch (const fs::filesystem_error& error) {
    throw place_error(folder_, error);
  }
}

fs::path unfinished_place(const fs::path& folder) {
  return is_there(folder / kWriting) ? folder / kWriting : folder;
}

void check_is_of_one_run(const fs::path& folder) {
  if (!is_there(folder / kFinished) && !is_there(folder / kPlacing)) return;
  throw FileError(folder.string() +
                  ": new results are being put in the place of earlier ones, so the folder holds "
                  "files of two runs. Try again; if the run was killed, the next run of palpate "
                  "into this folder completes it.");
}

}  // namespace palpate::apps
