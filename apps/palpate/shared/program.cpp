// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/program.h"

#include <malloc.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <new>
#include <regex>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "shared/interrupts.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// Writes the word that distinguishes errors and warnings from other messages.
class Severity : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/,
              spdlog::memory_buf_t& line) override {
    const std::string_view word = message.level == spdlog::level::err    ? "error: "
                                  : message.level == spdlog::level::warn ? "warning: "
                                                                         : "";
    line.append(word.data(), word.data() + word.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<Severity>();
  }
};

/// Keeps memory that was freed until the program ends, up to 1 GiB, because the next step of the
/// work needs as much: otherwise the heap shrinks and grows again all the time, and the system
/// clears each page each time. Blocks above 32 MiB, the most that glibc accepts, are still returned
/// at once.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  constexpr int kHeapOfAThread = 64 * kMiB;  // the most that the heap of a thread grows by
  mallopt(M_TRIM_THRESHOLD, 1024 * kMiB);
  mallopt(M_TOP_PAD, kHeapOfAThread);
  mallopt(M_MMAP_THRESHOLD, 32 * kMiB);
#endif
}

/// A message of the libraries without their names of types: "RemeshingOptions::max_triangles" is
/// "max_triangles" to users of the programs.
std::string without_type_names(const std::string& message) {
  static const std::regex type_name(R"(\b[A-Z]\w*(Options|Method|Mapping|Limits)::(?=[a-z]))");
  return std::regex_replace(message, type_name, "");
}

/// Returns the exit status of `run`; prints the message of its exception.
int status_of(const std::function<int()>& run) {
  try {
    watch_for_interrupts();
    return run();
  } catch (const InvalidInput& e) {
    spdlog::error("{}", without_type_names(e.what()));
    return kProgramWrongCall;
  } catch (const Interrupted& interrupted) {
    stop_watching();
    spdlog::critical("{}", interrupted.message);
    return kInterruptedStatus;
  } catch (const std::bad_alloc&) {
    const std::string work = Progress::latest();
    spdlog::error(
        "there is not enough memory{}. Pass less at a time, or ask for less: a coarser spacing or "
        "resolution, a larger tolerance, or fewer --threads.",
        work.empty() ? "" : " for " + work);
    return kProgramFailed;
  } catch (const std::exception& e) {
    spdlog::error("{}", without_type_names(e.what()));
    return kProgramFailed;
  }
}

}  // namespace

int run_program(const char* name, const std::function<int()>& run) {
  keep_freed_memory();
  spdlog::set_default_logger(spdlog::stderr_color_mt(name));
  auto form = std::make_unique<spdlog::pattern_formatter>();
  form->add_flag<Severity>('*').set_pattern("%n: %*%v");
  spdlog::set_formatter(std::move(form));
  const int status = status_of(run);
  stop_watching();
  return status;
}

fs::path program_file() {
  constexpr const char* kProgram = "/proc/self/exe";
  std::error_code error;
  fs::path program = fs::read_symlink(kProgram, error);
  if (error) {
    throw FileError(std::string(kProgram) + ": cannot be read (" + error.message() +
                    "); mount /proc, so that Palpate finds its files");
  }
  return program;
}

fs::path program_folder() { return program_file().parent_path(); }

fs::path bundled(const fs::path& installed, const fs::path& in_build) {
  const fs::path path = program_folder() / installed;
  if (fs::exists(path)) return fs::canonical(path);
  if (fs::exists(in_build)) return in_build;
  throw FileError(path.string() + ": this part of the installation is missing; install it again");
}

}  // namespace palpate::apps
