// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/run_calls.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>

#include "palpate/core/error.h"
#include "shared/wrong_call.h"
#include "whole/all_commands.h"

namespace palpate::apps {
namespace {

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::ranges::find(words, word) != words.end();
}

/// ": is unknown; did you mean decode?"
std::string unknown(const std::string& word, const std::vector<std::string>& known) {
  const std::optional<std::string> nearest = nearest_word(word, known);
  return nearest ? fmt::format("{}: is unknown; did you mean {}?", word, *nearest)
                 : fmt::format("{}: is unknown; expected {}", word, fmt::join(known, ", "));
}

/// Returns true if a message names an option, and not one with a longer name.
bool names_option(const std::string& message, const std::string& option) {
  const std::size_t at = message.find(option);
  if (at == std::string::npos) return false;
  const std::string after = message.substr(at + option.size(), 1);
  return after.empty() || after.find_first_of("-abcdefghijklmnopqrstuvwxyz") == std::string::npos;
}

/// CLI11 takes the words of a call from the end.
std::vector<std::string> reversed(std::vector<std::string> words) {
  std::ranges::reverse(words);
  return words;
}

/// The options of a call, as words. An option that takes one value each time is repeated.
void add_words(std::vector<std::string>& words, const CLI::Option& option,
               const std::vector<std::vector<std::string>>& values) {
  for (const std::vector<std::string>& given : values) {
    if (option.get_positional()) {
      words.insert(words.end(), given.begin(), given.end());
      continue;
    }
    const std::string name = "--" + option.get_single_name();
    if (option.get_items_expected_max() == 0) {
      words.push_back(name);
      continue;
    }
    const bool repeated = !option.get_allow_extra_args() && option.get_items_expected_min() == 1;
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (i == 0 || repeated)
        words.push_back(name + "=" + given[i]);  // so that it may begin with a dash
      else
        words.push_back(given[i]);
    }
  }
}

/// Thrown when the words of a call have been parsed, so that the command itself is not run.
struct CallIsRight {};

/// The calls of a project while they are made, one after the other.
class CallMaker {
 public:
  CallMaker(fs::path file, fs::path results)
      : file_(std::move(file)), results_(std::move(results)) {
    add_commands(program_, settings_);
    program_.parse_complete_callback([] { throw CallIsRight(); });
  }

  StepCall make(const ProjectStep& step, const ProjectSection& section) {
    CLI::App& command = *command_of(step.command, program_);
    Values values;
    for (const ProjectEntry& entry : section.entries) take(command, section, entry, values);
    check_formats(step, section, values);
    feed(step, values);
    require_all(command, section, values);
    StepCall call{.step = &step};
    for (const auto& [name, given] : values) call.entries[name] = given;
    std::vector<std::string> order;
    if (step.ordered) {
      for (const ProjectEntry& entry : section.entries) order.push_back(entry.name);
      call.entries["order of entries"] = {order};
    }
    call.words = words_of(step.command, command, values, order);
    check(call.words, section);
    call.resuming_words = resuming_words(step, command, call.words, values);
    call.takes_shard = takes_shard(call);
    for (const std::string& name : step.inputs) add_paths(values, name, call.inputs);
    for (const std::string& name : step.outputs) add_paths(values, name, call.outputs);
    std::map<std::string, fs::path> beside;
    for (const auto& [name, needs] : step.beside) {
      if (!values.contains(needs)) continue;
      beside[name] = main_output(step, values).replace_filename(name);
      call.outputs.push_back(beside[name]);
    }
    check_inputs(call, section);
    check_outputs_apart(call, section);
    made_.push_back({step.name, std::move(values), std::move(beside), call.inputs, call.outputs});
    return call;
  }

 private:
  using Values = std::map<std::string, std::vector<std::vector<std::string>>>;
  struct Made {
    std::string step;
    Values values;
    std::map<std::string, fs::path> beside;  ///< folders beside the main output, by their names
    std::vector<fs::path> inputs, outputs;
  };

  [[noreturn]] void refuse(const ProjectSection& section, int line, const std::string& what) const {
    refuse_in_project(file_, line, section.name + ": " + what);
  }

  /// Puts what the section says of an entry into `values`; false leaves it out.
  void take(const CLI::App& command, const ProjectSection& section, const ProjectEntry& entry,
            Values& values) const {
    const CLI::Option* option = option_of(command, entry.name);
    if (option == nullptr) refuse(section, entry.line, unknown(entry.name, entry_names(command)));
    const std::string& first = entry.values.front().front();
    const bool is_one = entry.values.size() == 1 && entry.values.front().size() == 1;
    if (is_one && first == "false") {
      values[entry.name] = {};
      return;
    }
    if (option->get_items_expected_max() == 0 && !(is_one && first == "true"))
      refuse(section, entry.line,
             fmt::format("{}: is {}; expected true or false", entry.name, first));
    values[entry.name] = entry.values;
  }

  /// One section has one main output.
  void check_formats(const ProjectStep& step, const ProjectSection& section,
                     const Values& values) const {
    const auto given = std::ranges::count_if(step.formats, [&](const std::string& format) {
      const auto value = values.find(format);
      return value != values.end() && !value->second.empty();
    });
    if (given > 1) {
      refuse(section, section.line, fmt::format("has {} formats; a project exports one", given));
    }
  }

  /// Takes the paths that a section names to where they are; adds what earlier steps make, and the
  /// names of outputs.
  void feed(const ProjectStep& step, Values& values) const {
    take_to(step.inputs, values, [this](const fs::path& path) { return place_of_input(path); });
    for (const Feed& feed : step.feeds) {
      const bool is_replaced = std::ranges::any_of(feed.unless, [&](const std::string& other) {
        return values.contains(other) && !values.at(other).empty();
      });
      if (!values.contains(feed.entry) && !is_replaced) feed_from(feed, values);
    }
    if (!step.result_entry.empty() && !values.contains(step.result_entry))
      if (const std::string name = usual_result(step, values); !name.empty())
        values[step.result_entry] = {{name}};
    take_to(step.outputs, values, [this](const fs::path& path) { return results_ / path; });
    std::erase_if(values, [](const auto& value) { return value.second.empty(); });
  }

  template <typename Place>
  static void take_to(const std::vector<std::string>& entries, Values& values, Place&& place) {
    for (auto& [name, value] : values) {
      if (!has(entries, name)) continue;
      for (std::vector<std::string>& given : value)
        for (std::string& path : given) path = place(path).string();
    }
  }

  void feed_from(const Feed& feed, Values& values) const {
    for (const Feed::Source& source : feed.sources) {
      const auto made = std::ranges::find(made_, source.step, &Made::step);
      if (made == made_.end()) continue;
      const fs::path path = output_of(*made, source.entry);
      if (path.empty()) continue;
      values[feed.entry] = {{(source.file.empty() ? path : path / source.file).string()}};
      return;
    }
  }

  /// What a step has for an entry, or a folder of that name beside its main output; empty if there
  /// is neither.
  static fs::path output_of(const Made& made, const std::string& entry) {
    if (const auto folder = made.beside.find(entry); folder != made.beside.end())
      return folder->second;
    const auto value = made.values.find(entry);
    return value == made.values.end() ? fs::path() : fs::path(value->second.front().front());
  }

  static fs::path main_output(const ProjectStep& step, const Values& values) {
    return values.at(step.result_entry).front().front();
  }

  /// The results of an earlier step are in the folder of the results.
  [[nodiscard]] fs::path place_of_input(const fs::path& path) const {
    const fs::path in_results = (results_ / path).lexically_normal();
    return is_made(in_results) ? in_results : path;
  }

  [[nodiscard]] bool is_made(const fs::path& path) const {
    return std::ranges::any_of(made_, [&](const Made& made) {
      return std::ranges::any_of(made.outputs,
                                 [&](const fs::path& output) { return lies_in(path, output); });
    });
  }

  static std::string usual_result(const ProjectStep& step, const Values& values) {
    for (const std::string& format : step.formats) {
      const auto input = values.find(step.inputs.front());
      if (values.contains(format) && input != values.end() && !input->second.empty())
        return fs::path(input->second.front().front()).stem().string() + "." + format;
    }
    return step.result;
  }

  void require_all(const CLI::App& command, const ProjectSection& section,
                   const Values& values) const {
    for (const std::string& name : entry_names(command)) {
      const CLI::Option* option = option_of(command, name);
      if (!option->get_required() || values.contains(name)) continue;
      refuse(section, section.line,
             fmt::format("{} is missing ({})", name, option->get_description()));
    }
  }

  /// \param first entries whose options come first, in this order.
  static std::vector<std::string> words_of(std::vector<std::string> words, const CLI::App& command,
                                           const Values& values,
                                           const std::vector<std::string>& first = {}) {
    std::vector<std::string> names = first;
    std::ranges::copy_if(entry_names(command), std::back_inserter(names),
                         [&](const std::string& name) { return !has(first, name); });
    // Arguments come before all options, so that no option with several values takes them.
    for (const bool positional : {true, false}) {
      for (const std::string& name : names) {
        const CLI::Option* option = option_of(command, name);
        const auto value = values.find(name);
        if (value != values.end() && option->get_positional() == positional)
          add_words(words, *option, value->second);
      }
    }
    return words;
  }

  /// The words of the call that goes on with an interrupted one, if there can be one.
  std::vector<std::string> resuming_words(const ProjectStep& step, const CLI::App& command,
                                          std::vector<std::string> words, const Values& values) {
    if (step.measures) {
      Values of_resume = {{"acquisition", values.at(step.result_entry)}};
      if (const auto stop = values.find("stop-file"); stop != values.end()) of_resume.insert(*stop);
      return words_of(resume_, *command_of(resume_, program_), of_resume);
    }
    if (command.get_option_no_throw("--resume") == nullptr) return {};
    words.emplace_back("--resume");
    return refusal_of(words) ? std::vector<std::string>() : words;
  }

  bool takes_shard(const StepCall& call) {
    if (call.step->items.empty()) return false;
    std::vector<std::string> words = call.words;
    words.emplace_back("--shard=1/1");
    return !refusal_of(words);
  }

  /// The reason for which the program would refuse these words, if any.
  std::optional<std::string> refusal_of(const std::vector<std::string>& words) {
    std::vector<std::string> left = reversed(words);
    try {
      program_.parse(left);
    } catch (const CallIsRight&) {
    } catch (const CLI::ParseError& error) {
      return describe_wrong_call(program_, error);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return std::nullopt;
  }

  void check(const std::vector<std::string>& words, const ProjectSection& section) {
    const std::optional<std::string> refusal = refusal_of(words);
    if (!refusal) return;
    for (const ProjectEntry& entry : section.entries)
      if (names_option(*refusal, "--" + entry.name)) refuse(section, entry.line, *refusal);
    refuse(section, section.line, *refusal);
  }

  static void add_paths(const Values& values, const std::string& name,
                        std::vector<fs::path>& paths) {
    const auto value = values.find(name);
    if (value == values.end()) return;
    for (const std::vector<std::string>& given : value->second)
      paths.insert(paths.end(), given.begin(), given.end());
  }

  void check_inputs(const StepCall& call, const ProjectSection& section) const {
    for (const fs::path& input : call.inputs) {
      if (is_made(input)) continue;
      std::error_code error;
      const fs::file_type type = fs::status(input, error).type();
      if (type == fs::file_type::regular || type == fs::file_type::directory) continue;
      refuse(section, line_of(section, input),
             input.string() + (type == fs::file_type::not_found
                                   ? ": there is no such file or folder" + hint_of(input)
                                   : ": is neither a file nor a folder"));
    }
  }

  /// "; did you mean rig.yaml?"
  static std::string hint_of(const fs::path& missing) {
    const fs::path folder = missing.has_parent_path() ? missing.parent_path() : fs::path(".");
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      names.push_back(entry.path().filename().string());
    const auto nearest = nearest_word(missing.filename().string(), names);
    return nearest ? "; did you mean " + (missing.parent_path() / *nearest).string() + "?" : "";
  }

  /// The line in which a section names a path.
  static int line_of(const ProjectSection& section, const fs::path& path) {
    for (const ProjectEntry& entry : section.entries)
      for (const std::vector<std::string>& given : entry.values)
        if (has(given, path.string())) return entry.line;
    return section.line;
  }

  /// Checks that no output is an input, or another output, or holds one or lies in one.
  void check_outputs_apart(const StepCall& call, const ProjectSection& section) const {
    std::vector<fs::path> taken;
    for (const fs::path& output : call.outputs) {
      const auto refuse_for = [&](const fs::path& other, const std::string& what) {
        refuse(section, line_of(section, output),
               fmt::format("{}: is, holds or lies in {}, {}; give one of them another name",
                           output.string(), other.empty() ? "." : other.string(), what));
      };
      if (lies_in(results_, output)) refuse_for(results_, "the folder of all results");
      for (const fs::path& other : taken)
        if (lies_in(output, other) || lies_in(other, output)) refuse_for(other, "which it writes");
      for (const fs::path& input : call.inputs)
        if (lies_in(output, input) || lies_in(input, output)) refuse_for(input, "which it reads");
      for (const Made& made : made_) {
        for (const fs::path& other : made.outputs)
          if (lies_in(output, other) || lies_in(other, output))
            refuse_for(other, "which " + made.step + " writes");
        for (const fs::path& input : made.inputs)
          if (lies_in(output, input)) refuse_for(input, "which " + made.step + " reads");
      }
      taken.push_back(output);
    }
  }

  fs::path file_, results_;
  /// Goes on with a campaign of 'probe run'.
  const std::vector<std::string> resume_ = {"probe", "resume"};
  Settings settings_;
  CLI::App program_{"", "palpate"};
  std::vector<Made> made_;
};

}  // namespace

bool lies_in(const fs::path& path, const fs::path& folder) {
  const auto place = [](const fs::path& name) {
    return (fs::current_path() / name).lexically_normal();
  };
  const fs::path relative = place(path).lexically_relative(place(folder));
  return !relative.empty() && *relative.begin() != "..";
}

std::vector<StepCall> calls_of(const fs::path& file, const Project& project,
                               const fs::path& results) {
  std::vector<std::string> names;
  std::ranges::transform(project_steps(), std::back_inserter(names), &ProjectStep::name);
  for (const ProjectSection& section : project.sections)
    if (!has(names, section.name))
      refuse_in_project(file, section.line, unknown(section.name, names));
  CallMaker maker(file, results);
  std::vector<StepCall> calls;
  for (const ProjectStep& step : project_steps()) {
    const auto section = std::ranges::find(project.sections, step.name, &ProjectSection::name);
    if (section != project.sections.end()) calls.push_back(maker.make(step, *section));
  }
  return calls;
}

Json run_call(const std::vector<std::string>& words) {
  Json figures = Json::object();
  const Settings settings{.json = true, .quiet = false, .figures = &figures};
  CLI::App program("", "palpate");
  add_commands(program, settings);
  std::vector<std::string> left = reversed(words);
  program.parse(left);
  return figures;
}

}  // namespace palpate::apps
