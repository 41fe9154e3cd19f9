// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/output_file.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <fstream>
#include <locale>
#include <string>
#include <system_error>

#include "palpate/error.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // of symbolic links in a row, as in the kernel

OutputError output_error(const fs::path& path, const std::string& reason) {
  return OutputError(path.string() + ": cannot be written: " + reason +
                     ". What was there before is unchanged.");
}

/// The place that is to be replaced: `path` without trailing separators and symbolic links. A link
/// may point to something that does not exist yet, so fs::canonical will not do.
fs::path replaced_place(const fs::path& path) {
  fs::path place = fs::absolute(path).lexically_normal();
  if (!place.has_filename()) place = place.parent_path();
  for (int link = 0; fs::is_symlink(place); ++link) {
    if (link == kMaxLinks) throw output_error(path, "its symbolic links form a circle");
    place = (place.parent_path() / fs::read_symlink(place)).lexically_normal();
  }
  return place;
}

/// A name beside `place` that nobody else has: other processes differ in the number of the process,
/// other threads in the counter. The extension stays, as libraries choose the format by it.
fs::path temporary_beside(const fs::path& place) {
  static std::atomic<unsigned> counter{0};
  fs::path temporary;
  do {
    temporary =
        place.parent_path() / (place.stem().string() + ".tmp-" + std::to_string(::getpid()) + "-" +
                               std::to_string(counter++) + place.extension().string());
  } while (fs::exists(fs::symlink_status(temporary)));
  return temporary;
}

/// Removes the temporary on every way out; after a rename there is nothing left to remove.
class Temporary {
 public:
  explicit Temporary(fs::path path) : path_(std::move(path)) {}
  ~Temporary() {
    std::error_code ignored;  // already failing, or already renamed
    fs::remove_all(path_, ignored);
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Turns what the file system reports on the way into an OutputError that names `path`. Calls of
/// the user's `write` must stay outside: its errors may be about other files.
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
  stream.exceptions(std::ios::badbit);  // stops `write` at the first byte that finds no room
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

/// Two renames, as a folder that is not empty cannot be renamed onto.
void swap_in(const fs::path& temporary, const fs::path& place) {
  if (!fs::exists(place)) {
    fs::rename(temporary, place);
    return;
  }
  const fs::path old = temporary_beside(place);
  fs::rename(place, old);
  try {
    fs::rename(temporary, place);
  } catch (const fs::filesystem_error&) {
    fs::rename(old, place);
    throw;
  }
  std::error_code ignored;  // the result is in its place; what is left of the old one does no harm
  fs::remove_all(old, ignored);
}

}  // namespace

void write_file_by_path(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path place = on_file_system(path, [&] {
    fs::path resolved = replaced_place(path);
    check_replaceable_file(path, resolved);
    fs::create_directories(resolved.parent_path());
    return resolved;
  });
  const Temporary temporary(temporary_beside(place));
  write(temporary.path());
  on_file_system(path, [&] {
    if (fs::exists(place)) fs::permissions(temporary.path(), fs::status(place).permissions());
    fs::rename(temporary.path(), place);
  });
}

void write_file(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  write_file_by_path(path, [&](const fs::path& temporary) { fill_stream(path, temporary, write); });
}

void check_replaceable(const fs::path& path, const std::vector<fs::path>& entries) {
  on_file_system(path, [&] { check_replaceable_folder(path, replaced_place(path), entries); });
}

void write_folder(const fs::path& path, const std::vector<fs::path>& entries,
                  const std::function<void(const fs::path&)>& write) {
  const fs::path place = on_file_system(path, [&] {
    fs::path resolved = replaced_place(path);
    check_replaceable_folder(path, resolved, entries);
    fs::create_directories(resolved.parent_path());
    return resolved;
  });
  const Temporary temporary(temporary_beside(place));
  on_file_system(path, [&] { fs::create_directory(temporary.path()); });
  try {
    write(temporary.path());
  } catch (const OutputError& error) {
    // The user knows the folder, not the temporary.
    std::string message = error.what();
    const std::string name = temporary.path().string();
    if (const auto at = message.find(name); at != std::string::npos)
      message.replace(at, name.size(), path.string());
    throw OutputError(message);
  }
  on_file_system(path, [&] { swap_in(temporary.path(), place); });
}

}  // namespace palpate
