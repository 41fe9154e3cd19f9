// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_report.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/error_statistics.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

double median_of(const Outcomes& outcomes, double Outcome::*milliseconds) {
  std::vector<double> values;
  for (const auto& [number, outcome] : outcomes) {
    if (outcome.error.empty() && !outcome.kept) values.push_back(outcome.*milliseconds);
  }
  return geometry::error_statistics(values).median;
}

/// Warns of frames that do not fit, with one message for all.
void warn_of_misfits(const Outcomes& outcomes) {
  std::string first;
  std::size_t misfits = 0;
  for (const auto& [number, outcome] : outcomes) {
    if (!outcome.error.empty()) continue;
    const sensing::DecodeJudgement judgement = sensing::judge(outcome.frame.evidence);
    if (judgement.usable()) continue;
    if (misfits++ == 0) first = outcome.frame.name + ": " + judgement.reason;
  }
  if (misfits == 0) return;
  spdlog::warn("{} of {} frames do not fit rig, pattern and colours, although together they do; {}",
               misfits, outcomes.size(), first);
}

}  // namespace

std::string counts(const sensing::ReasonImage& reasons) {
  std::string text;
  for (int code = 0; code < sensing::kReasonCount; ++code) {
    const auto reason = static_cast<sensing::Reason>(code);
    text += fmt::format("{}{} {}", code > 0 ? ", " : "", sensing::count(reasons, reason),
                        sensing::name(reason));
  }
  return text;
}

sensing::DecodeJudgement judge_sequence(const Outcomes& outcomes) {
  sensing::DecodeEvidence all;
  for (const auto& [number, outcome] : outcomes) {
    if (outcome.error.empty()) all += outcome.frame.evidence;
  }
  return sensing::judge(all);
}

void report_decoding(const Settings& settings, const fs::path& output, const DecodeOutputs& outputs,
                     const Outcomes& outcomes, const sensing::DecodeJudgement& judgement,
                     double seconds) {
  nlohmann::ordered_json per_frame = nlohmann::ordered_json::array();
  std::vector<double> milliseconds;
  std::string prose;
  std::size_t decoded = 0;
  for (const auto& [number, outcome] : outcomes) {
    const FinishedFrame& frame = outcome.frame;
    if (!outcome.error.empty()) {
      per_frame.push_back({{"frame", frame.name}, {"error", outcome.error}});
      spdlog::error("{}", outcome.error);
      continue;
    }
    const fs::path map = numbered(output, number, ".tiff");
    ++decoded;
    milliseconds.push_back(frame.milliseconds);
    per_frame.push_back({{"frame", frame.name},
                         {"range_map", map.string()},
                         {"pixels", frame.pixels},
                         {"median_depth", frame.median_depth},
                         {"verdict", sensing::to_string(sensing::judge(frame.evidence).verdict)},
                         {"ms", frame.milliseconds},
                         {"kept", outcome.kept}});
    prose += fmt::format("{} -> {}: {} pixels, median depth {}, {}\n", frame.name, map.string(),
                         frame.pixels,
                         frame.pixels > 0 ? fmt::format("{:.1f} mm", frame.median_depth) : "none",
                         outcome.kept ? std::string("kept from an earlier run")
                                      : fmt::format("{:.0f} ms", frame.milliseconds));
  }
  if (judgement.usable()) warn_of_misfits(outcomes);
  const auto kept = std::count_if(outcomes.begin(), outcomes.end(),
                                  [](const auto& entry) { return entry.second.kept; });
  const double median_ms = geometry::error_statistics(milliseconds).median;
  const double rate = static_cast<double>(decoded - static_cast<std::size_t>(kept)) / seconds;
  const nlohmann::ordered_json figures = {
      {"frames", outcomes.size()},
      {"decoded", decoded},
      {"kept", kept},
      {"broken", outcomes.size() - decoded},
      {"verdict", sensing::to_string(judgement.verdict)},
      {"reason", judgement.reason},
      {"ms_per_frame", median_ms},
      {"read_ms_per_frame", median_of(outcomes, &Outcome::read_milliseconds)},
      {"write_ms_per_frame", median_of(outcomes, &Outcome::write_milliseconds)},
      {"frames_per_second", rate},
      {"sigma_includes_rig", outputs.noise},
      {"per_frame", per_frame}};
  print(settings, figures,
        prose + fmt::format("{} of {} frames decoded, {:.0f} ms of work per frame (median), "
                            "{:.1f} frames/s in total{}; {}.{}",
                            decoded, outcomes.size(), median_ms, rate,
                            kept > 0 ? fmt::format("; {} kept from an earlier run", kept) : "",
                            judgement.reason,
                            outputs.sigma && !outputs.noise
                                ? " The deviations hold the noise of the frames alone: the rig has "
                                  "no covariance and counts as exact."
                                : ""));
}

void refuse_misfit(const sensing::DecodeJudgement& judgement, bool force,
                   const std::string& remedy) {
  if (judgement.usable()) return;
  if (force) {
    spdlog::warn(
        "the frames do not fit rig, pattern or colours, so depths are likely to be wrong: {}.",
        judgement.reason);
    return;
  }
  throw Error(fmt::format(
      "the frames do not fit rig, pattern or colours, so depths are likely to be wrong: {}. {}",
      judgement.reason, remedy));
}

std::size_t count_broken(const Outcomes& outcomes) {
  const auto broken = static_cast<std::size_t>(
      std::count_if(outcomes.begin(), outcomes.end(),
                    [](const auto& entry) { return !entry.second.error.empty(); }));
  if (!outcomes.empty() && broken == outcomes.size())
    throw FileError(outcomes.begin()->second.error);
  return broken;
}

void refuse_broken(std::size_t broken, std::size_t frames) {
  if (broken == 0) return;
  throw Error(fmt::format("{} of {} frames could not be decoded; the others were decoded.", broken,
                          frames));
}

}  // namespace palpate::apps
