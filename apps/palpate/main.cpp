// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/program.h"
#include "shared/wrong_call.h"
#include "whole/all_commands.h"
#include "whole/version.h"

namespace palpate::apps {
namespace {

Json describe_option(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  if (option.get_positional()) names = {option.get_name(true)};
  Json described = {{"names", names},
                    {"meaning", option.get_description()},
                    {"group", option.get_group()},
                    {"positional", option.get_positional()},
                    {"required", option.get_required()},
                    {"values", option.get_items_expected_max()}};
  // A flag has a type too, that of the variable it sets.
  if (option.get_items_expected_max() > 0) described["type"] = option.get_type_name();
  if (!option.get_default_str().empty()) described["default"] = option.get_default_str();
  return described;
}

/// A group of options is, to CLI11, a command without a name.
void describe_options(const CLI::App& command, Json& described) {
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty()) described.push_back(describe_option(*option));
  }
  for (const CLI::App* group :
       command.get_subcommands([](const CLI::App* part) { return part->get_name().empty(); }))
    describe_options(*group, described);
}

/// Returns the output of `palpate --help-all --json`: a command with its options, and in "commands"
/// its subcommands in the same form. Manual pages and completions are made from it.
Json describe_commands(const CLI::App& command) {
  Json described = {{"name", command.get_name()},   {"meaning", command.get_description()},
                    {"group", command.get_group()}, {"more", command.get_footer()},
                    {"options", Json::array()},     {"commands", Json::array()}};
  describe_options(command, described["options"]);
  for (const CLI::App* part :
       command.get_subcommands([](const CLI::App* part) { return !part->get_name().empty(); }))
    described["commands"].push_back(describe_commands(*part));
  return described;
}

int run(int argc, char** argv) {
  CLI::App app("Palpate turns real deformable objects into models that can be seen and felt.",
               "palpate");
  app.footer("Start with:  palpate demo\nHelp for a command:  palpate COMMAND --help");
  app.fallthrough();

  Settings settings;
  std::optional<int> threads;
  int verbosity = 0;
  show_shared_options(app);
  app.set_help_all_flag(
      "--help-all", "Also list the options that few users set; with --json, describe all commands");
  app.add_flag("--json", settings.json, "Print the results as one JSON object instead of text")
      ->group(kSharedOptions);
  // After --json, whose value it reads.
  app.set_version_flag(
      "--version", [&settings] { return version_text(settings.json); },
      "Print version, commit, licence, compiler and libraries");
  add_number(app, "--threads", threads, above(0), "Number of threads (default: all cores)")
      ->group(kSharedOptions);
  CLI::Option* verbose = app.add_flag("-v", verbosity, "Print what is being done; -vv prints more")
                             ->group(kSharedOptions);
  app.add_flag("-q,--quiet", settings.quiet,
               "Print errors only: no results (except with --json), warnings or progress")
      ->excludes(verbose)
      ->group(kSharedOptions);

  std::optional<tbb::global_control> limit;
  app.parse_complete_callback([&] {
    if (threads)
      limit.emplace(tbb::global_control::max_allowed_parallelism,
                    static_cast<std::size_t>(*threads));
    spdlog::set_level(settings.quiet   ? spdlog::level::err
                      : verbosity == 0 ? spdlog::level::warn
                      : verbosity == 1 ? spdlog::level::info
                                       : spdlog::level::debug);
  });

  add_commands(app, settings);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (settings.json && dynamic_cast<const CLI::CallForAllHelp*>(&e) != nullptr) {
      std::cout << describe_commands(app).dump(1) << '\n';
      return kProgramDone;
    }
    if (e.get_exit_code() == 0) return app.exit(e);  // help or version
    spdlog::error("{}", describe_wrong_call(app, e));
    return kProgramWrongCall;
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(with_option_names(error, app));
  }
  std::cout.flush();
  if (!std::cout)
    throw OutputError("standard output cannot be written: the results are incomplete.");
  return kProgramDone;
}

}  // namespace
}  // namespace palpate::apps

int main(int argc, char** argv) {
  using namespace palpate::apps;
  // FFmpeg, inside OpenCV, prints its own messages about damaged videos; this program reports such
  // damage itself. OpenCV needs both variables; a user who has set either wants FFmpeg's messages.
  if (std::getenv("OPENCV_FFMPEG_DEBUG") == nullptr &&
      std::getenv("OPENCV_FFMPEG_LOGLEVEL") == nullptr) {
    setenv("OPENCV_FFMPEG_DEBUG", "1", 0);
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  }
  return run_program("palpate", [&] { return run(argc, argv); });
}
