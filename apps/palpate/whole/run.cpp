// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/interrupts.h"
#include "shared/project_file.h"
#include "shared/result_folder.h"
#include "shared/words.h"
#include "whole/project_record.h"
#include "whole/run_calls.h"
#include "whole/run_plan.h"
#include "whole/run_shards.h"
#include "whole/shard_progress.h"
#include "whole/slurm.h"

namespace palpate::apps {
namespace {

struct RunProjectCall {
  fs::path project, output;
  bool dry_run = false, status = false;
  ShardOptions shards;
};

/// The outcome of a step.
struct StepOutcome {
  std::string step;
  /// done, unchanged, failed; of a dry run due, depends, unchanged; of a look at the status done,
  /// failed, running, interrupted, missing
  std::string status;
  std::string reason = {};                   ///< the reason for doing it
  double seconds = 0;                        ///< in which it was done; 0 if it was not
  Json figures = {};                         ///< of its command; null if there are none
  std::optional<ShardProgress> shards = {};  ///< of a look at the status
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
      if (outcome.shards) line += "  " + apps::in_words(*outcome.shards);
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
      if (outcome.shards) steps.back()["shards"] = json_of(*outcome.shards);
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

/// Decides into how many shards the work of a step is divided, and makes place for them.
/// \param before the record of the step; null if there is none.
/// \param now gets the number of shards, and the jobs that do some of them.
/// \return whether the step goes on where an earlier run was interrupted.
bool begin_step(const StepCall& call, const StepRecord* before, StepRecord& now,
                const ShardOptions& options) {
  const bool is_same = before != nullptr && can_be_resumed(*before, now);
  const bool had_shards =
      before != nullptr && before->shards > 0 && before->state != StepState::done;
  now.shards = count_shards(call, is_same ? before : nullptr, options.count);
  if (had_shards) {
    const bool goes_on = is_same && now.shards == before->shards;
    if (!goes_on)
      check_no_jobs(call.step->name, *before, "Wait until they have ended");
    else if (options.executor == ShardExecutor::local)
      check_no_jobs(call.step->name, *before, "Wait for them with --executor slurm");
    if (goes_on) {
      now.jobs = before->jobs;
      return true;
    }
    if (now.shards == 0) drop_shards(call, before->shards);
  }
  if (now.shards > 0) begin_shards(call);
  return is_same && !had_shards && now.shards == 0;
}

/// Does a step, and keeps in the record that it was begun and how it ended.
StepOutcome do_step(const StepCall& call, const std::string& reason, StepRecord now,
                    ProjectRecord& record, const ShardOptions& options) {
  const std::string& name = call.step->name;
  const bool goes_on = begin_step(call, record.find(name), now, options);
  record.put(name, now);
  const auto put = [&](StepState state) {
    now.state = state;
    now.outputs = fingerprints_of(call.outputs);
    record.put(name, now);
  };
  const auto start = std::chrono::steady_clock::now();
  const auto submitted = [&](const std::vector<std::string>& jobs) {
    now.jobs.insert(now.jobs.end(), jobs.begin(), jobs.end());
    record.put(name, now);
  };
  try {
    now.figures = now.shards > 0 ? do_shards(call, now.shards, options, now.jobs, submitted)
                                 : call_step(call, goes_on);
  } catch (const Interrupted&) {
    if (now.jobs.empty()) put(StepState::failed);  // otherwise, the jobs go on writing
    throw;
  } catch (...) {
    put(StepState::failed);
    throw;
  }
  now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  now.jobs.clear();
  put(StepState::done);
  return {.step = name,
          .status = "done",
          .reason = reason,
          .seconds = now.seconds,
          .figures = now.figures};
}

/// Settles a step that is planned like this, once all earlier ones are done.
/// \param plan gets the reason, also if the step fails.
StepOutcome settle(const StepCall& call, StepPlan& plan, ProjectRecord& record,
                   const ShardOptions& options) {
  const std::string& name = call.step->name;
  if (plan.need != StepNeed::none) {
    const StepRecord now = now_of(call);
    plan = plan_step(call, record.find(name), now);
    if (plan.need != StepNeed::none) return do_step(call, plan.reason, now, record, options);
  }
  return {.step = name, .status = "unchanged", .figures = record.find(name)->figures};
}

void do_steps(const std::vector<StepCall>& calls, std::vector<StepPlan> plans,
              ProjectRecord& record, const ShardOptions& options, RunReport& report) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const ProjectStep& step = *calls[i].step;
    try {
      StepOutcome outcome = settle(calls[i], plans[i], record, options);
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

/// Prints the state of the steps, by the record alone.
/// \param at_work whether a run is doing one of them, \param logs see `ShardOptions`.
void tell_status(const std::vector<StepCall>& calls, const ProjectRecord& record, bool at_work,
                 const fs::path& logs, RunReport& report) {
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
    } else if (step != nullptr && step->shards > 0) {
      outcome.shards = shard_progress(call, *step, logs);
    }
    const std::string figure = figure_in_words(*call.step, outcome.figures);
    report.add(std::move(outcome), figure);
  }
  report.finish();
}

/// \throws InvalidInput if the work of no step can be divided.
void check_divisible(const fs::path& project, const std::vector<StepCall>& calls) {
  if (std::ranges::any_of(calls, &StepCall::takes_shard)) return;
  std::vector<std::string> names;
  for (const ProjectStep& step : project_steps())
    if (!step.items.empty()) names.push_back(step.name);
  throw InvalidInput(fmt::format(
      "--shards: {} has no step whose work can be divided ({}, without options that exclude "
      "--shard). Leave out --shards.",
      project.string(), fmt::join(names, " or ")));
}

void run_project(const Settings& settings, RunProjectCall call) {
  const Project project = read_project(call.project);
  const fs::path file = fs::absolute(call.project);
  if (!call.output.empty()) call.output = fs::absolute(call.output);
  if (call.shards.executor == ShardExecutor::slurm && !call.dry_run)
    call.shards.job = check_slurm();
  fs::current_path(file.parent_path());
  const fs::path results = results_of(call, project);
  const std::vector<StepCall> calls = calls_of(call.project, project, results);
  const fs::path record_file = results / file.filename().replace_extension(kProjectRecordEnding);
  // Slurm puts the logs where they are, also from another directory.
  call.shards.logs = fs::absolute(record_file).replace_extension(".logs");
  if (call.shards.count) check_divisible(call.project, calls);
  RunReport report(settings);
  if (call.dry_run) {
    tell_plans(calls, plan_steps(calls, ProjectRecord(record_file)), report);
    return;
  }
  const fs::path folder = results.empty() ? fs::path(".") : results;
  if (call.status) {
    tell_status(calls, ProjectRecord(record_file), is_locked(folder), call.shards.logs, report);
    return;
  }
  std::error_code failed;  // is told by the lock
  fs::create_directories(folder, failed);
  const FolderLock lock(folder);
  ProjectRecord record(record_file);
  const InterruptMessage message({}, "to continue, call palpate run again");
  do_steps(calls, plan_steps(calls, record), record, call.shards, report);
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
  CLI::Option* const shards =
      command
          ->add_option(
              "--shards", call->shards.count,
              "Divide the work of decode and mesh into this many parts; one that fails does not "
              "stop the others, and the next call does only what is missing (docs/projects.md)")
          ->check(within(at_least(1)));
  add_choice<ShardExecutor>(
      *command, "--executor", call->shards.executor,
      {{"local", ShardExecutor::local}, {"slurm", ShardExecutor::slurm}},
      "Where the parts are done: one after the other on this computer (local, default), or as jobs "
      "of Slurm (docs/clusters.md)")
      ->needs(shards);
  command->add_flag("--dry-run", call->dry_run,
                    "Only say which steps are to be done, and why; with -v, by which calls");
  command
      ->add_flag("--status", call->status,
                 "Only say which steps are done, running, interrupted, failed or missing; also "
                 "while another call runs the project")
      ->excludes("--dry-run")
      ->excludes(shards);
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
      "  palpate run project.yaml --shards 100 --executor slurm\n"
      "  palpate run project.yaml --status",
      fmt::join(names, ", ")));
  command->callback([call, &settings] { run_project(settings, *call); });
}

}  // namespace palpate::apps
