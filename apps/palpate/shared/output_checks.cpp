// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/output_checks.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/model_io.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

/// Canonical form of a path. A path that cannot be resolved is returned unchanged, so that its
/// reader or writer reports the error.
fs::path place_of(const fs::path& path) {
  std::error_code cannot_look;
  const fs::path place = fs::weakly_canonical(path, cannot_look);
  if (cannot_look) return path;
  return place.has_filename() ? place : place.parent_path();  // without a trailing slash
}

bool is_or_lies_in(const fs::path& path, const fs::path& folder) {
  const fs::path inside = place_of(path).lexically_relative(place_of(folder));
  return !inside.empty() && *inside.begin() != "..";
}

/// \throws OutputError if nothing can be written at `path`, or in the folder of that name.
void check_writable(const fs::path& path) {
  fs::path folder = fs::absolute(path);
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) folder = folder.parent_path();
  while (!is_there(folder) && folder.has_relative_path()) folder = folder.parent_path();
  if (!fs::is_directory(folder, ignored))
    throw OutputError(path.string() + ": cannot be written: " + folder.string() + " is a file.");
  // Permissions alone are not enough: the superuser has them in folders of the kernel too. A file
  // without a name leaves nothing behind if the program is killed here.
  if (const int file = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600); file >= 0) {
    ::close(file);
    return;
  }
  // Not all file systems have such files.
  std::string trial = (folder / ".palpate-trial-XXXXXX").string();
  if (::mkdtemp(trial.data()) != nullptr) {
    ::rmdir(trial.c_str());
    return;
  }
  throw OutputError(path.string() + ": cannot be written: " + folder.string() + ": " +
                    std::generic_category().message(errno) + ".");
}

}  // namespace

void check_outputs(const std::vector<fs::path>& inputs, const std::vector<fs::path>& outputs) {
  std::vector<fs::path> taken = inputs;
  for (const fs::path& output : outputs) {
    if (output.empty()) continue;
    for (const fs::path& other : taken) {
      if (other.empty() || !is_or_lies_in(output, other)) continue;
      throw InvalidInput(
          output.string() + ": " +
          (place_of(output) == place_of(other) ? "is"
                                               : "lies in " + other.string() + ", which is") +
          " already used in this call; an output never overwrites an input or another output. "
          "Choose another name.");
    }
    check_writable(output);
    taken.push_back(output);
  }
}

void check_output_folder(const std::vector<fs::path>& inputs, const fs::path& folder) {
  check_outputs(inputs, {folder});
  for (const fs::path& input : inputs) {
    if (input.empty() || !is_or_lies_in(input, folder)) continue;
    throw InvalidInput(input.string() + ": lies in " + folder.string() +
                       ", which would be replaced; copy it elsewhere, or choose another output.");
  }
}

void check_model_output(const std::vector<fs::path>& inputs, const fs::path& folder) {
  check_output_folder(inputs, folder);
  check_replaceable(folder, haptics::model_entries());
}

void check_pictures(const std::vector<fs::path>& pictures) {
  for (const fs::path& picture : pictures) {
    if (picture.empty() || (is_image(picture) && !is_range_map(picture))) continue;
    throw InvalidInput(picture.string() +
                       ": pictures are PNG files; choose a name that ends in .png");
  }
}

std::vector<fs::path> own_entries(const fs::path& folder, const std::string& mark,
                                  const std::regex& own) {
  std::vector<fs::path> entries;
  if (!is_there(folder)) return entries;
  if (!is_folder(folder)) throw InvalidInput(folder.string() + ": is a file; expected a folder.");
  const auto refusal = [&](const std::string& reason) {
    return InvalidInput(folder.string() + ": holds " + reason +
                        ", which would be lost, so the folder is not replaced; choose a new or an "
                        "empty folder.");
  };
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_symlink() && entry.is_directory()) continue;
    const std::string name = entry.path().lexically_relative(folder).generic_string();
    if (!std::regex_match(name, own)) throw refusal(name);
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    entries.push_back(entry.path().filename());
  if (!entries.empty() && !is_there(folder / mark))
    throw refusal(entries.front().string() + " and no " + mark);
  return entries;
}

}  // namespace palpate::apps
