// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Reports of decoding about frames, rigs, patterns and colours that do not fit each other, and
// about those that do: the figures of docs/sensing-faults.md.
#include <fmt/format.h>
#include <fmt/ostream.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <numeric>
#include <opencv2/core/utility.hpp>

#include "faults.h"
#include "more_scenes.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/sensing/decode.h"
#include "rendered_scenes.h"
#include "simulated_scenes.h"

namespace palpate::bench {
namespace {

namespace fs = std::filesystem;
using sensing::DecodeOptions;
using sensing::DecodeVerdict;

/// A depth is confidently wrong if it is off by more than this [mm] and by more than this number of
/// its predicted deviations.
constexpr float kWrong = 5;
constexpr float kDeviations = 5;

/// The report on a frame, or on all frames of a scene.
struct Said {
  std::string name;     ///< of the scene, and the frame's number
  std::string verdict;  ///< "error" if the decoder refused its input
  bool told = false;
  bool judged = true;          ///< not too little
  double agreement = 0;        ///< [%] of stripes and sinusoid
  double displaced = 0;        ///< [%] of the edges in steady parts
  double coverage = 0;         ///< [%]
  double confident_wrong = 0;  ///< [% of the frame]
};

struct Result {
  std::string fault;
  std::vector<Said> frames, scenes;
};

Said said_of(const std::string& name, const sensing::DecodeEvidence& evidence) {
  const sensing::DecodeJudgement judgement = sensing::judge(evidence);
  const auto sum = [](const auto& bands) {
    return std::accumulate(bands.begin(), bands.end(), 0.0);
  };
  const auto percent = [](double part, long whole) {
    return 100 * part / static_cast<double>(std::max(whole, 1L));
  };
  return {
      .name = name,
      .verdict = sensing::to_string(judgement.verdict),
      .told = !judgement.usable(),
      .judged = judgement.verdict != DecodeVerdict::too_little,
      .agreement = percent(evidence.agreement, evidence.edges + evidence.off_panel),
      .displaced = percent(sum(evidence.displaced_edges), std::lround(sum(evidence.steady_edges)))};
}

void measure_depths(const View& view, const sensing::DecodeResult& result, Said& said) {
  long wrong = 0, covered = 0, counted = 0;
  for (long i = 0; i < view.z.size(); ++i) {
    const float z = result.range.z.data()[i];
    if (view.counted.data()[i]) {
      ++counted;
      covered += z > 0;
    }
    if (!(z > 0)) continue;
    const float error = std::abs(z - view.z.data()[i]);  // NaN where nothing is
    wrong += !(error <= kWrong) && !(error <= kDeviations * result.sigma.data()[i]);
  }
  said.coverage =
      counted > 0 ? 100.0 * static_cast<double>(covered) / static_cast<double>(counted) : 0;
  said.confident_wrong = 100.0 * static_cast<double>(wrong) / static_cast<double>(view.z.size());
}

void decode_scene(const Scene& scene, const DecodeOptions& options, Result& result) {
  try {
    const sensing::Decoder decoder(scene.rig, scene.pattern, scene.colors, options);
    sensing::DecodeEvidence all;
    for (std::size_t i = 0; i < scene.views.size(); ++i) {
      const sensing::DecodeResult decoded = decoder.decode(scene.views[i].frame);
      Said said = said_of(fmt::format("{} {}", scene.name, i), decoded.evidence);
      // At half the size only the verdict counts.
      if (!options.half_resolution) measure_depths(scene.views[i], decoded, said);
      result.frames.push_back(std::move(said));
      all += decoded.evidence;
    }
    result.scenes.push_back(said_of(scene.name, all));
  } catch (const Error&) {
    const Said error{.name = scene.name, .verdict = "error", .told = true};
    for (std::size_t i = 0; i < scene.views.size(); ++i) {
      result.frames.push_back(error);
      result.frames.back().name += fmt::format(" {}", i);
    }
    result.scenes.push_back(error);
  }
}

Result decode_all(const std::string& name, const std::vector<Scene>& scenes,
                  const DecodeOptions& options = {}) {
  Result result{name, {}, {}};
  for (const Scene& scene : scenes) decode_scene(scene, options, result);
  std::cerr << name << '\n';
  return result;
}

/// Frames that can be judged are those of which enough is said without a fault.
std::vector<const Said*> judgeable(const std::vector<Said>& said, const std::vector<Said>& right) {
  std::vector<const Said*> chosen;
  for (const Said& one : said) {
    const auto same = std::ranges::find(right, one.name, &Said::name);
    if (same != right.end() && same->judged) chosen.push_back(&one);
  }
  return chosen;
}

double mean(const std::vector<const Said*>& said, double Said::*figure) {
  double sum = 0;
  for (const Said* one : said) sum += one->*figure;
  return sum / static_cast<double>(std::max<std::size_t>(said.size(), 1));
}

/// "wrong_rig 40, accepted 3"
std::string verdicts(const std::vector<const Said*>& said) {
  std::map<std::string, int> counts;
  for (const Said* one : said) ++counts[one->verdict];
  std::vector<std::pair<int, std::string>> sorted;
  for (const auto& [verdict, count] : counts) sorted.emplace_back(-count, verdict);
  std::ranges::sort(sorted);
  std::string text;
  for (const auto& [count, verdict] : sorted) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", verdict, -count);
  }
  return text;
}

long told(const std::vector<const Said*>& said) {
  return std::ranges::count_if(said, [](const Said* one) { return one->told; });
}

void write_right(std::ostream& out, const std::string& title, const std::vector<Result>& results) {
  fmt::print(out, "\n| {} | frames | refused | too little to judge | scenes refused |\n", title);
  fmt::print(out, "|---|---|---|---|---|\n");
  for (const Result& result : results) {
    const auto count = [](const std::vector<Said>& said, bool Said::*what, bool wanted) {
      return std::ranges::count_if(said, [&](const Said& one) { return one.*what == wanted; });
    };
    fmt::print(out, "| {} | {} | {} | {} | {} of {} |\n", result.fault, result.frames.size(),
               count(result.frames, &Said::told, true), count(result.frames, &Said::judged, false),
               count(result.scenes, &Said::told, true), result.scenes.size());
  }
}

void write_faults(std::ostream& out, const std::string& title, const Result& right,
                  const std::vector<Result>& results) {
  fmt::print(out,
             "\n| {} | coverage [%] | confident wrong [%] | largest confident wrong of an accepted "
             "frame [%] | frames noticed | scenes noticed | verdicts |\n",
             title);
  fmt::print(out, "|---|---|---|---|---|---|---|\n");
  for (const Result& result : results) {
    const auto frames = judgeable(result.frames, right.frames);
    const auto scenes = judgeable(result.scenes, right.scenes);
    double most = 0;
    for (const Said* one : frames) {
      if (!one->told) most = std::max(most, one->confident_wrong);
    }
    fmt::print(out, "| {} | {:.0f} | {:.1f} | {:.1f} | {} of {} | {} of {} | {} |\n", result.fault,
               mean(frames, &Said::coverage), mean(frames, &Said::confident_wrong), most,
               told(frames), frames.size(), told(scenes), scenes.size(), verdicts(frames));
  }
}

void write_csv(std::ostream& out, const std::string& part, const std::vector<Result>& results) {
  for (const Result& result : results) {
    for (const Said& one : result.frames) {
      fmt::print(out, "{},{},{},{},{:.1f},{:.1f},{:.2f},{:.3f}\n", part, result.fault, one.name,
                 one.verdict, one.agreement, one.displaced, one.coverage, one.confident_wrong);
    }
  }
}

std::vector<Result> decode_right(const std::vector<Scene>& scenes) {
  return {decode_all("as it is", scenes),
          decode_all("snakes", scenes, {.segmentation = sensing::Segmentation::snakes}),
          decode_all("half resolution", scenes, {.half_resolution = true}),
          decode_all("window of 4 periods", scenes, {.window_periods = 4})};
}

std::vector<Result> decode_wrong(const std::vector<Scene>& scenes) {
  std::vector<Fault> faults = faults_of_frames();
  for (Fault& fault : faults_of_files()) faults.push_back(std::move(fault));
  std::vector<Result> results;
  for (const Fault& fault : faults) {
    std::vector<Scene> wrong = scenes;
    for (Scene& scene : wrong) fault.apply(scene);
    results.push_back(decode_all(fault.name, wrong));
  }
  return results;
}

void run_part(const std::string& part, const std::vector<Scene>& scenes,
              const std::vector<Result>& more_right, std::ostream& csv) {
  std::vector<Result> right = decode_right(scenes);
  right.insert(right.end(), more_right.begin(), more_right.end());
  write_right(std::cout, part + ": nothing is wrong", right);
  const std::vector<Result> wrong = decode_wrong(scenes);
  write_faults(std::cout, part + ": fault", right[0], wrong);
  write_csv(csv, part, right);
  write_csv(csv, part, wrong);
  std::cout << std::flush;
}

void run_bundled(std::ostream& csv) {
  std::vector<Scene> scenes = smooth_scenes();
  for (Scene& scene : hard_scenes()) scenes.push_back(std::move(scene));
  std::vector<Result> noisy;
  for (const CameraNoise& noise : kCameraNoises) {
    noisy.push_back(decode_all(fmt::format("noise {} %", noise.percent), smooth_scenes(noise)));
  }
  run_part("bundled rig", scenes, noisy, csv);
}

void run(const std::vector<std::string>& parts, const fs::path& rendered, const fs::path& output) {
  const auto wanted = [&](const char* part) {
    return parts.empty() || std::ranges::find(parts, part) != parts.end();
  };
  write_file(output / "sensing-faults.csv", [&](std::ostream& csv) {
    csv << "part,fault,frame,verdict,agreement,displaced,coverage,confident_wrong\n";
    if (wanted("bundled")) run_bundled(csv);
    if (wanted("others")) run_part("other rigs", scenes_of_other_rigs(), {}, csv);
    if (!rendered.empty()) run_part("rendered", rendered_scenes(rendered), {}, csv);
  });
}

}  // namespace
}  // namespace palpate::bench

int main(int count, char** arguments) try {
  CLI::App app("Tells wrong rigs, patterns, colours and frames from right ones; prints Markdown");
  std::vector<std::string> parts;
  std::filesystem::path rendered, output = ".";
  app.add_option("--part", parts, "Only the bundled rig, only other rigs, or neither")
      ->check(CLI::IsMember({"bundled", "others", "none"}));
  app.add_option("--rendered", rendered, "Folder of rendered sets with their truth")
      ->check(CLI::ExistingDirectory);
  app.add_option("-o,--output", output, "Folder for sensing-faults.csv");
  CLI11_PARSE(app, count, arguments);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  palpate::bench::run(parts, rendered, output);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
