// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "shared/command_line.h"
#include "shared/interrupts.h"
#include "shared/project_file.h"
#include "shared/result_folder.h"
#include "shared/words.h"
#include "whole/project_record.h"
#include "whole/run_calls.h"
#include "whole/run_plan.h"

namespace palpate::apps {
namespace {

struct RunProjectCall {
  fs::path project, output;
  bool dry_run = false, status = false;
};

/// What became of a step.
struct StepOutcome {
  std::string step;
  /// done, unchanged, failed; of a dry run due, depends, unchanged; of a look at the status done,
  /// failed, running, interrupted, missing
  std::string status;
  std::string reason = {};  ///< why it is, or was, to be done
  double seconds = 0;       ///< in which it was done; 0 if it was not
  Json figures = {};        ///< of its command; null if there are none
};

/// Says what becomes of the steps: in text, a line when each has ended; in JSON, all at the end.
class RunReport {
 public:
  explicit RunReport(const Settings& settings) : settings_(settings) {}

  /// \param figure in words.
  void add(StepOutcome outcome, const std::string& figure) {
    if (!settings_.json && !settings_.quiet) {
      std::string line = fmt::format("{:<9} {:<9}", outcome.step, outcome.status);
      if (outcome.seconds > 0) line += fmt::format(" {:>6.1f} s", outcome.seconds);
      if (!figure.empty()) line += "  " + figure;
      if (!outcome.reason.empty()) line += "  (" + outcome.reason + ")";
      std::cout << line << std::endl;
    }
    outcomes_.push_back(std::move(outcome));
  }

  void finish() const {
    Json steps = Json::array();
    for (const StepOutcome& outcome : outcomes_) {
      steps.push_back({{"step", outcome.step},
                       {"status", outcome.status},
                       {"reason", outcome.reason.empty() ? Json() : Json(outcome.reason)},
                       {"seconds", outcome.seconds},
                       {"figures", outcome.figures}});
    }
    print(settings_, {{"steps", steps}}, in_words());
  }

 private:
  /// "5 steps: 2 done, 3 unchanged"
  [[nodiscard]] std::string in_words() const {
    std::vector<std::string> counts;
    for (const char* status :
         {"done", "due", "depends", "failed", "unchanged", "running", "interrupted", "missing"}) {
      const auto count = std::ranges::count(outcomes_, status, &StepOutcome::status);
      if (count > 0) counts.push_back(fmt::format("{} {}", count, status));
    }
    return fmt::format("{}: {}", counted(outcomes_.size(), "step"), fmt::join(counts, ", "));
  }

  const Settings& settings_;
  std::vector<StepOutcome> outcomes_;
};

std::string figure_in_words(const ProjectStep& step, const Json& figures) {
  try {
    return step.main_figure(figures);
  } catch (const Json::exception&) {
    return {};  // the record does not have it
  }
}

/// The folder for the results, relative to the current one; empty if it is that.
fs::path results_of(const RunProjectCall& call, const Project& project) {
  const fs::path output = call.output.empty() ? project.output : call.output;
  const fs::path results = output.empty() ? output : fs::proximate(output).lexically_normal();
  return results == "." ? fs::path() : results;
}

/// Calls the command of a step, or goes on with it where it was interrupted.
Json call_step(const StepCall& call, bool goes_on) {
  const auto run = [](const std::vector<std::string>& words) {
    spdlog::info("palpate {}", fmt::join(words, " "));
    return run_call(words);
  };
  if (!goes_on || call.resuming_words.empty()) return run(call.words);
  if (call.step->measures)
    return run(fingerprints_of(call.outputs).empty() ? call.words : call.resuming_words);
  try {
    return run(call.resuming_words);
  } catch (const InvalidInput& refusal) {
    // The step ended before its command kept anything; what is kept is of an older run.
    spdlog::info("{}: starts from the beginning: {}", call.step->name, refusal.what());
    return run(call.words);
  }
}

/// Does a step, and keeps in the record that it was begun and how it ended.
StepOutcome do_step(const StepCall& call, const std::string& reason, StepRecord now,
                    ProjectRecord& record) {
  const std::string& name = call.step->name;
  const StepRecord* const before = record.find(name);
  const bool goes_on = before != nullptr && can_be_resumed(*before, now);
  record.put(name, now);
  const auto put = [&](StepState state) {
    now.state = state;
    now.outputs = fingerprints_of(call.outputs);
    record.put(name, now);
  };
  const auto start = std::chrono::steady_clock::now();
  try {
    now.figures = call_step(call, goes_on);
  } catch (...) {
    put(StepState::failed);
    throw;
  }
  now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  put(StepState::done);
  return {.step = name,
          .status = "done",
          .reason = reason,
          .seconds = now.seconds,
          .figures = now.figures};
}

/// What becomes of a step that is planned like this, once all earlier ones are done.
/// \param plan gets the reason, also if the step fails.
StepOutcome settle(const StepCall& call, StepPlan& plan, ProjectRecord& record) {
  const std::string& name = call.step->name;
  if (plan.need != StepNeed::none) {
    const StepRecord now = now_of(call);
    plan = plan_step(call, record.find(name), now);
    if (plan.need != StepNeed::none) return do_step(call, plan.reason, now, record);
  }
  return {.step = name, .status = "unchanged", .figures = record.find(name)->figures};
}

void do_steps(const std::vector<StepCall>& calls, std::vector<StepPlan> plans,
              ProjectRecord& record, RunReport& report) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const ProjectStep& step = *calls[i].step;
    try {
      StepOutcome outcome = settle(calls[i], plans[i], record);
      const std::string figure = figure_in_words(step, outcome.figures);
      report.add(std::move(outcome), figure);
    } catch (...) {
      report.add({.step = step.name, .status = "failed", .reason = plans[i].reason}, {});
      report.finish();
      throw;
    }
  }
  report.finish();
}

void tell_plans(const std::vector<StepCall>& calls, const std::vector<StepPlan>& plans,
                RunReport& report) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const char* const status = plans[i].need == StepNeed::due       ? "due"
                               : plans[i].need == StepNeed::depends ? "depends"
                                                                    : "unchanged";
    spdlog::info("palpate {}", fmt::join(calls[i].words, " "));
    report.add({.step = calls[i].step->name, .status = status, .reason = plans[i].reason}, {});
  }
  report.finish();
}

/// What has become of the steps so far, by the record alone.
/// \param at_work whether a run is doing one of them.
void tell_status(const std::vector<StepCall>& calls, const ProjectRecord& record, bool at_work,
                 RunReport& report) {
  const auto status_of = [&](const StepRecord* step) {
    if (step == nullptr) return "missing";
    if (step->state == StepState::done) return "done";
    if (step->state == StepState::failed) return "failed";
    return at_work ? "running" : "interrupted";
  };
  for (const StepCall& call : calls) {
    const StepRecord* const step = record.find(call.step->name);
    StepOutcome outcome{.step = call.step->name, .status = status_of(step)};
    if (outcome.status == "done") {
      outcome.seconds = step->seconds;
      outcome.figures = step->figures;
    }
    const std::string figure = figure_in_words(*call.step, outcome.figures);
    report.add(std::move(outcome), figure);
  }
  report.finish();
}

void run_project(const Settings& settings, RunProjectCall call) {
  const Project project = read_project(call.project);
  const fs::path file = fs::absolute(call.project);
  if (!call.output.empty()) call.output = fs::absolute(call.output);
  fs::current_path(file.parent_path());
  const fs::path results = results_of(call, project);
  const std::vector<StepCall> calls = calls_of(call.project, project, results);
  const fs::path record_file = results / file.filename().replace_extension(kProjectRecordEnding);
  RunReport report(settings);
  if (call.dry_run) {
    tell_plans(calls, plan_steps(calls, ProjectRecord(record_file)), report);
    return;
  }
  const fs::path folder = results.empty() ? fs::path(".") : results;
  if (call.status) {
    tell_status(calls, ProjectRecord(record_file), is_locked(folder), report);
    return;
  }
  std::error_code failed;  // is told by the lock
  fs::create_directories(folder, failed);
  const FolderLock lock(folder);
  ProjectRecord record(record_file);
  const InterruptMessage message({}, "to continue, call palpate run again");
  do_steps(calls, plan_steps(calls, record), record, report);
}

}  // namespace

void add_run(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<RunProjectCall>();
  CLI::App* command =
      app.add_subcommand("run", "Run a project; redo only steps whose inputs have changed");
  add_required(*command, "PROJECT", call->project,
               "Project file (project.yaml; docs/projects.md): a section for each step");
  command->add_option("-o,--output", call->output,
                      "Folder for all results (default: as the file says, or its own folder)");
  command->add_flag("--dry-run", call->dry_run,
                    "Only say which steps are to be done, and why; with -v, by which calls");
  command
      ->add_flag("--status", call->status,
                 "Only say which steps are done, running, interrupted, failed or missing; also "
                 "while another call runs the project")
      ->excludes("--dry-run");
  std::vector<std::string> names;
  for (const ProjectStep& step : project_steps()) names.push_back(step.name);
  command->footer(fmt::format(
      "The sections, in this order: {}. The entries of a section are the options of its command "
      "without dashes, and its arguments in small letters. Paths are relative to the folder of the "
      "file.\n"
      "A step is done again if its entries, the content of its input files or the version of "
      "palpate have changed since; project.run, a file beside the results, holds what is known of "
      "them. After Ctrl-C, a crash or an error, the same call goes on.\n"
      "Results that were changed since, and files that this command did not write, are never "
      "replaced.\n"
      "Examples:\n  palpate run project.yaml\n  palpate run project.yaml --dry-run\n"
      "  palpate run project.yaml --status",
      fmt::join(names, ", ")));
  command->callback([call, &settings] { run_project(settings, *call); });
}

}  // namespace palpate::apps
