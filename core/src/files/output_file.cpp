// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <initializer_list>
#include <locale>
#include <mutex>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <system_error>

#include "palpate/core/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // longest chain of symbolic links, as in the kernel

OutputError output_error(const fs::path& path, const std::string& reason) {
  return OutputError(path.string() + ": cannot be written: " + reason +
                     ". What was there before is unchanged.");
}

/// The path that is replaced: `path` without trailing separators and symbolic links. A link may
/// point to something that does not exist yet, so `fs::canonical` cannot be used.
fs::path replaced_place(const fs::path& path) {
  fs::path place = fs::absolute(path).lexically_normal();
  if (!place.has_filename()) place = place.parent_path();
  for (int link = 0; fs::is_symlink(place); ++link) {
    if (link == kMaxLinks) throw output_error(path, "its symbolic links form a circle");
    place = (place.parent_path() / fs::read_symlink(place)).lexically_normal();
  }
  return place;
}

/// The host name with letters, digits and hyphens only.
std::string host_name() {
  constexpr std::size_t kLongest = 64;  // on Linux
  std::array<char, kLongest + 1> name{};
  if (::gethostname(name.data(), kLongest) != 0) return "unknown";
  std::string text = name.data();
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '-');
  return text;
}

/// Prefix of the names of all temporaries of this host. Readers of folders skip hidden files.
std::string temporary_mark() { return ".palpate-tmp-" + host_name() + "-"; }

/// A name beside `place` that nobody else chooses: the host, the process and the counter tell most
/// writers apart; random bits tell apart containers that share all three. The extension is kept,
/// because libraries choose the format by it.
fs::path unique_name(const fs::path& place, const std::string& mark) {
  static std::atomic<unsigned> counter{0};
  std::ostringstream name;
  name.imbue(std::locale::classic());
  name << mark << ::getpid() << '-' << counter++ << '-' << std::hex << std::random_device()();
  return place.parent_path() / (name.str() + place.extension().string());
}

/// Temporaries that this process is writing. Never destroyed: a thread may still write at exit.
struct LiveTemporaries {
  std::mutex mutex;
  std::set<fs::path> paths;
};
LiveTemporaries& live_temporaries() {
  static auto* const live = new LiveTemporaries;
  return *live;
}

/// Returns true if `handle` is open on the file or folder that is at `path` now.
bool is_at(const char* path, int handle) {
  struct stat opened {};
  struct stat there {};
  return ::fstat(handle, &opened) == 0 && ::stat(path, &there) == 0 &&
         opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

/// A temporary of this process. It is locked while its writer runs, which distinguishes it from one
/// that a killed process left. It is removed at the end of the scope, also by an exception; after a
/// rename there is nothing to remove.
class Temporary {
 public:
  /// Creates it beside `place`. `create` gets its path and returns a handle on it; as system calls
  /// do, it returns -1 and sets `errno` if it fails, with EEXIST if there is anything at the path.
  template <typename Create>
  Temporary(const fs::path& place, Create&& create) {
    LiveTemporaries& live = live_temporaries();
    const std::lock_guard lock(live.mutex);
    while (true) {
      path_ = unique_name(place, temporary_mark());
      handle_ = create(path_.c_str());
      if (handle_ != -1 && is_mine()) break;
      if (handle_ == -1 && errno != EEXIST) {
        throw fs::filesystem_error("temporary", path_,
                                   std::error_code(errno, std::generic_category()));
      }
      if (handle_ != -1) ::close(handle_);
    }
    live.paths.insert(path_);
  }
  ~Temporary() {
    std::error_code ignored;  // already failing, or already renamed
    fs::remove_all(path_, ignored);
    ::close(handle_);
    LiveTemporaries& live = live_temporaries();
    const std::lock_guard lock(live.mutex);
    live.paths.erase(path_);
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  /// Locks it. False if another process took it for a left-over before it was locked; that process
  /// removes it. Some file systems have no locks: there, nobody removes left-overs.
  [[nodiscard]] bool is_mine() const {
    if (::flock(handle_, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
    return is_at(path_.c_str(), handle_);
  }

  fs::path path_;
  int handle_ = -1;
};

Temporary temporary_file(const fs::path& place) {
  return {place, [](const char* path) {
            constexpr mode_t kAllThatUmaskAllows = 0666;
            return ::open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kAllThatUmaskAllows);
          }};
}

int make_folder(const char* path) {
  constexpr mode_t kAllThatUmaskAllows = 0777;
  return ::mkdir(path, kAllThatUmaskAllows);
}

Temporary temporary_folder(const fs::path& place) {
  return {place, [](const char* path) {
            if (make_folder(path) == -1) return -1;
            return ::open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
          }};
}

/// Removes a temporary unless its writer still runs.
void remove_if_left_over(const fs::path& path) {
  std::error_code ignored;  // another process may do the same
  const bool is_folder = fs::is_directory(fs::symlink_status(path, ignored));
  const int kind = is_folder ? O_RDONLY | O_DIRECTORY : O_RDWR;
  const int handle = ::open(path.c_str(), kind | O_NOFOLLOW | O_CLOEXEC);
  if (handle == -1) return;
  if (::flock(handle, LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, ignored);
  ::close(handle);
}

/// Waits until the content of a file, or the names in a folder, are on the disk.
/// \throws fs::filesystem_error if the disk reports an error, for example that it is full.
void flush_to_disk(const fs::path& path, int flags = 0) {
  const auto check = [&](int result, std::initializer_list<int> allowed) {
    if (result != -1 || std::find(allowed.begin(), allowed.end(), errno) != allowed.end()) return;
    throw fs::filesystem_error("flush", path, std::error_code(errno, std::generic_category()));
  };
  const int opened = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  check(opened, {EACCES});  // one may be allowed to write to a folder but not to read it
  if (opened == -1) return;
  const int flushed = ::fsync(opened);
  const int reason = errno;
  ::close(opened);
  errno = reason;
  check(flushed, {EINVAL, ENOTSUP});  // some network file systems do not flush folders
}

void flush_folder(const fs::path& folder) { flush_to_disk(folder, O_DIRECTORY); }

/// Flushes everything in a folder, and the folder itself.
void flush_tree(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_symlink()) continue;
    if (entry.is_directory()) flush_folder(entry.path());
    if (entry.is_regular_file()) flush_to_disk(entry.path());
  }
  flush_folder(folder);
}

/// Converts an error of the file system into an OutputError that names `path`. The user's `write`
/// must be called outside of this, because its errors may concern other files.
template <typename Action>
auto on_file_system(const fs::path& path, Action&& action) {
  try {
    return action();
  } catch (const fs::filesystem_error& error) {
    throw output_error(path, error.code().message());
  }
}

void check_replaceable_file(const fs::path& path, const fs::path& place) {
  const fs::file_status status = fs::status(place);
  if (fs::is_directory(status))
    throw InvalidInput(path.string() + ": is a folder; give the name of a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw InvalidInput(path.string() + ": is not a regular file; give the name of a file");
}

void check_replaceable_folder(const fs::path& path, const fs::path& place,
                              const std::vector<fs::path>& entries) {
  const fs::file_status status = fs::status(place);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status))
    throw InvalidInput(path.string() + ": is a file; give the name of a folder");
  for (const fs::directory_entry& entry : fs::directory_iterator(place)) {
    const fs::path name = entry.path().filename();
    if (std::find(entries.begin(), entries.end(), name) != entries.end()) continue;
    throw InvalidInput(
        path.string() + ": holds " + name.string() +
        ", which would be lost, so it is not replaced; give a new or an empty folder");
  }
}

void fill_stream(const fs::path& path, const fs::path& temporary,
                 const std::function<void(std::ostream&)>& write) {
  const auto reason = [] {
    return errno != 0 ? std::generic_category().message(errno) : std::string("write error");
  };
  std::ofstream stream;
  stream.imbue(std::locale::classic());
  errno = 0;
  stream.open(temporary, std::ios::binary);
  if (!stream) throw output_error(path, reason());
  stream.exceptions(std::ios::badbit);  // stop `write` at the first byte that does not fit
  errno = 0;
  try {
    write(stream);
  } catch (const std::ios_base::failure&) {
    if (!stream.bad()) throw;
  }
  if (!stream) throw output_error(path, reason());
  stream.exceptions(std::ios::goodbit);
  stream.close();
  if (!stream) throw output_error(path, reason());
}

/// Puts `temporary` in the place of what is at `place`. If the file system cannot exchange the two
/// in one step, a process that is killed between two renames leaves the old folder under a hidden
/// name that nobody removes.
void swap_in(const fs::path& temporary, const fs::path& place) {
  if (!fs::exists(place)) {
    fs::rename(temporary, place);
    return;
  }
  // The old folder is removed with the temporary.
  if (::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, place.c_str(), RENAME_EXCHANGE) == 0)
    return;
  const fs::path old = unique_name(place, ".palpate-old-");
  fs::rename(place, old);
  try {
    fs::rename(temporary, place);
  } catch (const fs::filesystem_error&) {
    fs::rename(old, place);
    throw;
  }
  std::error_code ignored;  // the result is in place; remains of the old one do no harm
  fs::remove_all(old, ignored);
}

/// `write` gets the path of an empty temporary.
void replace_file(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path place = on_file_system(path, [&] {
    fs::path resolved = replaced_place(path);
    check_replaceable_file(path, resolved);
    fs::create_directories(resolved.parent_path());
    return resolved;
  });
  remove_left_overs(place.parent_path());
  const Temporary temporary(on_file_system(path, [&] { return temporary_file(place); }));
  write(temporary.path());
  on_file_system(path, [&] {
    flush_to_disk(temporary.path());
    if (fs::exists(place)) fs::permissions(temporary.path(), fs::status(place).permissions());
    fs::rename(temporary.path(), place);
    flush_folder(place.parent_path());
  });
}

}  // namespace

void write_file(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  replace_file(path, [&](const fs::path& temporary) { fill_stream(path, temporary, write); });
}

void write_file_by_path(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  replace_file(path, [&](const fs::path& temporary) {
    write(temporary);
    const bool has_content =
        on_file_system(path, [&] { return fs::exists(temporary) && !fs::is_empty(temporary); });
    if (!has_content) throw output_error(path, "nothing was written to it");
  });
}

void check_replaceable(const fs::path& path, const std::vector<fs::path>& entries) {
  on_file_system(path, [&] {
    const fs::path place = replaced_place(path);
    remove_left_overs(place);
    check_replaceable_folder(path, place, entries);
  });
}

void remove_left_overs(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> done;
  {
    const std::lock_guard lock(mutex);
    if (!done.insert(fs::absolute(folder).lexically_normal()).second) return;
  }
  std::error_code cannot_look;
  std::vector<fs::path> temporaries;
  for (fs::directory_iterator entry(folder, cannot_look); entry != fs::directory_iterator();
       entry.increment(cannot_look)) {
    if (entry->path().filename().string().starts_with(temporary_mark()))
      temporaries.push_back(entry->path());
  }
  for (const fs::path& temporary : temporaries) remove_if_left_over(temporary);
}

void abandon_temporaries() {
  LiveTemporaries& live = live_temporaries();
  live.mutex.lock();           // for ever
  constexpr int kTries = 100;  // a library may be adding a file to a folder
  for (const fs::path& path : live.paths) {
    std::error_code failed;
    for (int i = 0; i == 0 || (failed && i < kTries); ++i) fs::remove_all(path, failed);
  }
}

void write_folder(const fs::path& path, const std::vector<fs::path>& entries,
                  const std::function<void(const fs::path&)>& write) {
  const fs::path place = on_file_system(path, [&] {
    fs::path resolved = replaced_place(path);
    remove_left_overs(resolved);
    check_replaceable_folder(path, resolved, entries);
    fs::create_directories(resolved.parent_path());
    return resolved;
  });
  remove_left_overs(place.parent_path());
  const Temporary temporary(on_file_system(path, [&] { return temporary_folder(place); }));
  try {
    write(temporary.path());
  } catch (const OutputError& error) {
    // The user knows the folder, but not the temporary.
    std::string message = error.what();
    const std::string name = temporary.path().string();
    if (const auto at = message.find(name); at != std::string::npos)
      message.replace(at, name.size(), path.string());
    throw OutputError(message);
  }
  on_file_system(path, [&] {
    flush_tree(temporary.path());
    swap_in(temporary.path(), place);
    flush_folder(place.parent_path());
  });
}

}  // namespace palpate
