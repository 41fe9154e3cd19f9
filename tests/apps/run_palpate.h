// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::apps {

/// Exit statuses of `palpate`.
inline constexpr int kDone = 0;
inline constexpr int kWorkFailed = 1;
inline constexpr int kWrongCall = 2;
inline constexpr int kInterrupted = 130;

struct CommandResult {
  int status = -1;  ///< exit status; 128 + n after signal n
  std::string out;
  std::string err;
};

struct CommandOptions {
  /// Sends Ctrl-C, as a terminal does: also to the processes it started, as soon as this file
  /// exists.
  std::optional<std::filesystem::path> interrupt_when_there_is = {};
  /// The signal to send then in place of Ctrl-C.
  int signal = SIGINT;
  /// Limit of the file size [bytes], which looks like a full disk to the program.
  std::optional<unsigned long> max_file_size = {};
  std::string answers = {};  ///< what the program reads from its standard input
  /// Variables of the environment, NAME=VALUE.
  std::vector<std::string> environment = {};
};

/// Runs the `palpate` of this build and waits for it. Figures that it prints in JSON are compared
/// with docs/output.schema.json.
CommandResult run_palpate(const std::vector<std::string>& arguments,
                          const CommandOptions& options = {});

/// The subcommands that a help text lists.
std::vector<std::string> listed_commands(const std::string& help);

/// The bundled data.
std::filesystem::path demo_data();
/// The path of a file of it.
std::string demo(const std::string& name);

/// The file that `palpate calibrate colors` makes of the bundled training images; made once.
const std::string& trained_colors();

/// A folder for one test, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// A path in the folder.
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The header of a CSV file, and its lines whose integer in a column, from 0, is below a limit.
std::string lines_below(const std::string& csv, std::size_t column, int limit);

std::string read_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace palpate::apps
