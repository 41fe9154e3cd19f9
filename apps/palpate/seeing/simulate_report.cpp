// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/simulate_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "palpate/pictures/draw_differences.h"
#include "shared/depth_score.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// Causes that affect a smaller share of the lit pixels are not listed.
constexpr double kWorthSaying = 0.001;

double share(long part, long whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}
double percent(long part, long whole) { return 100 * share(part, whole); }

/// Formats a number with this number of decimals; "none" for NaN, if nothing was measured.
std::string decimal(double value, int places) {
  return std::isnan(value) ? "none" : fmt::format("{:.{}f}", value, places);
}

/// Returns a result for the assessment of a failed trial: the truth, without depths.
sensing::DecodeResult nothing_decoded(const sensing::SceneTruth& truth) {
  sensing::DecodeResult none;
  none.range = truth.range;
  none.range.z.setConstant(std::nanf(""));
  none.reasons = sensing::ReasonImage::Constant(truth.body.rows(), truth.body.cols(),
                                                static_cast<std::uint8_t>(sensing::Reason::unlit));
  return none;
}

/// "12.3 % border, 2.0 % grazing", the largest first.
std::string losses(const sensing::RigAssessment& found) {
  std::vector<std::pair<long, int>> lost;
  for (int i = 1; i < sensing::kReasonCount; ++i) {
    const long pixels = found.reasons[static_cast<std::size_t>(i)];
    if (share(pixels, found.score.measurable) >= kWorthSaying) lost.emplace_back(pixels, i);
  }
  std::sort(lost.rbegin(), lost.rend());
  std::string text;
  for (const auto& [pixels, reason] : lost) {
    text += fmt::format("{}{:.1f} % {}", text.empty() ? "" : ", ",
                        percent(pixels, found.score.measurable),
                        sensing::name(static_cast<sensing::Reason>(reason)));
  }
  return text;
}

std::string causes(const ReportLine& line) {
  const sensing::RigAssessment& found = line.found;
  std::string text = fmt::format(
      "{:.0f} mm: of {} pixels that see the object, {:.1f} % are outside the projector's image and "
      "{:.1f} % in shadow or facing away",
      found.score.distance, found.visible, percent(found.outside, found.visible),
      percent(found.dark, found.visible));
  if (!line.failure.empty()) return text + "; nothing was measured: " + line.failure + "\n";
  const std::string lost = losses(found);
  if (!lost.empty()) text += "; lost of the lit pixels: " + lost;
  if (found.stray > 0)
    text += fmt::format("; {} pixels have a depth where there is no object", found.stray);
  return text + ".\n";
}

Json report_figures(const ReportLine& line) {
  const sensing::RigAssessment& found = line.found;
  Json lost = Json::object();
  for (int i = 1; i < sensing::kReasonCount && line.failure.empty(); ++i) {
    lost[std::string(sensing::name(static_cast<sensing::Reason>(i)))] =
        found.reasons[static_cast<std::size_t>(i)];
  }
  Json figures = score_figures(found.score);
  figures.update({{"visible", found.visible},
                  {"outside", found.outside},
                  {"dark", found.dark},
                  {"facing", found.facing},
                  {"facing_covered", found.facing_covered},
                  {"stray", found.stray},
                  {"lost", lost}});
  if (!line.failure.empty()) figures["failure"] = line.failure;
  return figures;
}

std::string report_table(const std::vector<ReportLine>& lines) {
  std::string text =
      "distance mm  lit %  coverage %  wrong %  median error     RMS      95 % within\n";
  for (const ReportLine& line : lines) {
    const geometry::RangeMapScore& score = line.found.score;
    text +=
        fmt::format("{:<11.0f}  {:<5.1f}  {:<10}  {:<7}  {} mm = {} %  {} mm  {} mm\n",
                    score.distance, percent(score.measurable, line.found.visible),
                    decimal(100 * score.coverage, 1), decimal(100 * score.wrong_share, 2),
                    decimal(score.error.median, 3), decimal(100 * score.relative_error.median, 4),
                    decimal(score.error.rms, 3), decimal(score.error.p95, 3));
  }
  text +=
      "(lit: share of the pixels that see the object; coverage: share of the lit pixels that have "
      "a depth; wrong: share of the\n"
      "measured pixels that are more than 1 % of the distance off, or where nothing is; error: of "
      "the others)\n";
  for (const ReportLine& line : lines) text += causes(line);
  return text;
}

}  // namespace

ReportLine report_line(const fs::path& picture, const sensing::RigTrial& trial) {
  const sensing::SceneTruth& truth = trial.simulation.truth;
  ReportLine line{.found = sensing::assess(trial.decoded ? *trial.decoded : nothing_decoded(truth),
                                           truth, {.counted_bodies = 1}),
                  .failure = trial.failure,
                  .picture = {}};
  if (line.found.score.measured == 0) return line;
  line.picture = picture;
  pictures::draw_differences(
      picture, line.found.score,
      fmt::format("Predicted depth error at {:.0f} mm", line.found.score.distance));
  return line;
}

void print_simulated(const Settings& settings, const std::vector<ReportLine>& lines,
                     std::size_t shots, std::size_t images, const fs::path& output) {
  Json figures = {{"frames", shots}, {"folder", output.string()}};
  std::string prose = lines.empty() ? "" : report_table(lines);
  if (!lines.empty()) {
    figures["report"] = Json::array();
    for (const ReportLine& line : lines) figures["report"].push_back(report_figures(line));
  }
  if (images > 1) figures["images_of_each"] = images;
  prose += images > 1 ? counted(shots, "scene") + fmt::format(" of {} images", images)
                      : counted(shots, "frame");
  print(settings, figures, prose + " with their true range maps written to " + output.string());
}

}  // namespace palpate::apps
