// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_multishot.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/sensing/reason.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/surface_color.h"
#include "seeing/decode_input.h"
#include "seeing/decode_record.h"
#include "shared/progress.h"
#include "shared/result_folder.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using WallClock = std::chrono::steady_clock;

double milliseconds_since(WallClock::time_point start) {
  return std::chrono::duration<double, std::milli>(WallClock::now() - start).count();
}

/// The images of one scene that are yet to be read.
using Scene = std::vector<sensing::SourceFrame>;

struct SceneOutcome {
  std::string error;  ///< empty if there is a range map
  FinishedFrame frame;
  double disagreement = 0;  ///< [rad]
  double code_jumps = 0;    ///< per turn
  long contradictions = 0;  ///< pixels whose code and phase contradict each other
  double read_milliseconds = 0;
  double write_milliseconds = 0;
};

void check_number(const MultishotCall& call) {
  const auto needed = static_cast<std::size_t>(call.decoder.images());
  const std::size_t given = call.source.expected_frames();
  if (given > 0 && given % needed == 0) return;
  throw InvalidInput(fmt::format(
      "FRAMES: there are {} images; one scene has {} (sinusoids, then code, for each exposure), so "
      "a multiple of that is expected. Give the images of each scene in the order in which the "
      "pattern was drawn, and --exposures.",
      given, needed));
}

/// The next scene; empty at the end.
Scene next_scene(const MultishotCall& call) {
  Scene scene;
  while (static_cast<int>(scene.size()) < call.decoder.images()) {
    auto frame = call.source.next();
    if (!frame) break;
    if (call.linearizer != nullptr) linearize_when_read(*call.linearizer, *frame);
    scene.push_back(std::move(*frame));
  }
  return scene;
}

/// "a.png ... r.png"
std::string name_of(const Scene& scene) { return scene.front().name + " ... " + scene.back().name; }

sensing::MultishotResult decode_scene(const MultishotCall& call, const Scene& scene,
                                      SceneOutcome& outcome) {
  WallClock::time_point start = WallClock::now();
  std::vector<cv::Mat> images;
  for (const sensing::SourceFrame& frame : scene) images.push_back(frame.read());
  outcome.read_milliseconds = milliseconds_since(start);
  start = WallClock::now();
  sensing::MultishotResult result = call.decoder.decode(images);
  outcome.frame.milliseconds = milliseconds_since(start);
  outcome.disagreement = result.disagreement;
  outcome.code_jumps = result.code_jumps;
  outcome.contradictions =
      sensing::count(result.decoded.reasons, sensing::Reason::ambiguous_offset);
  return result;
}

void warn_of_scene(const SceneOutcome& outcome) {
  if (outcome.frame.pixels == 0)
    spdlog::warn("{}: no pixel has a depth; run with --reasons to see why.", outcome.frame.name);
  if (outcome.disagreement >= sensing::kStillDisagreement) {
    spdlog::warn(
        "{}: the images do not show one still scene under one steady light: phases are off by "
        "about {:.3f} rad. Object, camera or projector moved, the light flickered (expose for "
        "whole cycles of the projector), or the response is not linear (--response, or more "
        "steps).",
        outcome.frame.name, outcome.disagreement);
  }
  if (outcome.code_jumps >= sensing::kOrderedCodeJumps) {
    spdlog::warn(
        "{}: the code contradicts the sinusoid: between neighbours it jumps by whole periods, "
        "{:.2f} times a period, so depths are likely to be wrong. Give the images in the order in "
        "which the pattern was drawn, and the --pattern that was projected.",
        outcome.frame.name, outcome.code_jumps);
  }
  if (outcome.contradictions > outcome.frame.pixels) {
    spdlog::warn(
        "{}: the code contradicts the sinusoid at {} pixels, and only {} have a depth. Give the "
        "images in the order in which the pattern was drawn, and the --pattern that was projected.",
        outcome.frame.name, outcome.contradictions, outcome.frame.pixels);
  }
}

void report(const Settings& settings, const MultishotCall& call,
            const std::vector<SceneOutcome>& outcomes, double seconds) {
  nlohmann::ordered_json per_frame = nlohmann::ordered_json::array();
  std::vector<double> decode_ms, read_ms, write_ms;
  std::string prose;
  for (std::size_t number = 0; number < outcomes.size(); ++number) {
    const SceneOutcome& outcome = outcomes[number];
    const FinishedFrame& frame = outcome.frame;
    if (!outcome.error.empty()) {
      per_frame.push_back({{"frame", frame.name}, {"error", outcome.error}});
      continue;
    }
    const fs::path map = numbered(call.output, number, ".tiff");
    decode_ms.push_back(frame.milliseconds);
    read_ms.push_back(outcome.read_milliseconds);
    write_ms.push_back(outcome.write_milliseconds);
    per_frame.push_back({{"frame", frame.name},
                         {"range_map", map.string()},
                         {"pixels", frame.pixels},
                         {"median_depth", frame.median_depth},
                         {"ms", frame.milliseconds},
                         {"kept", false},
                         {"disagreement", outcome.disagreement},
                         {"code_jumps", outcome.code_jumps}});
    prose += fmt::format("{} -> {}: {} pixels, median depth {}, {:.0f} ms\n", frame.name,
                         map.string(), frame.pixels,
                         frame.pixels > 0 ? fmt::format("{:.1f} mm", frame.median_depth) : "none",
                         frame.milliseconds);
  }
  const auto median = [](const std::vector<double>& values) {
    return geometry::error_statistics(values).median;
  };
  const nlohmann::ordered_json figures = {
      {"frames", outcomes.size()},
      {"decoded", decode_ms.size()},
      {"kept", 0},
      {"broken", outcomes.size() - decode_ms.size()},
      {"ms_per_frame", median(decode_ms)},
      {"read_ms_per_frame", median(read_ms)},
      {"write_ms_per_frame", median(write_ms)},
      {"frames_per_second", static_cast<double>(decode_ms.size()) / seconds},
      {"sigma_includes_rig", false},
      {"per_frame", per_frame}};
  print(settings, figures,
        prose + fmt::format("{} of {} scenes decoded, from {} images each, {:.0f} ms a scene "
                            "(median).",
                            decode_ms.size(), outcomes.size(), call.decoder.images(),
                            median(decode_ms)));
}

}  // namespace

void decode_multishot(const Settings& settings, MultishotCall call) {
  check_number(call);
  ResultFolder folder(call.output, decoded_files, ResultFolder::Unfinished::dropped);
  call.outputs.folder = folder.place();
  DecodeRecord record(folder.place(), call.record_settings, call.source.files());
  std::vector<SceneOutcome> outcomes;
  std::size_t decoded = 0;
  const WallClock::time_point start = WallClock::now();
  Progress progress("decoding");
  const auto scenes = static_cast<int>(call.source.expected_frames()) / call.decoder.images();
  for (Scene scene = next_scene(call); !scene.empty(); scene = next_scene(call)) {
    SceneOutcome& outcome = outcomes.emplace_back();
    const std::size_t number = outcomes.size() - 1;
    outcome.frame = stamped(scene.front());
    outcome.frame.number = number;
    outcome.frame.name = name_of(scene);
    std::optional<sensing::MultishotResult> result;
    try {
      result = decode_scene(call, scene, outcome);
    } catch (const FileError& error) {
      outcome.error = error.what();
    } catch (const InvalidInput& error) {
      outcome.error = outcome.frame.name + ": " + error.what();
    }
    if (result) {
      if (decoded++ == 0) {
        folder.begin();
        record.begin();
        if (call.writes_rig)
          sensing::write_rig(call.outputs.folder / "rig.yaml", call.decoder.rig());
      }
      const WallClock::time_point writing = WallClock::now();
      measure_depths(result->decoded.range.z, outcome.frame);
      write_outputs(call.outputs, number, result->decoded,
                    call.outputs.color ? sensing::srgb_of(result->color) : cv::Mat());
      draw_outputs(call.outputs, number, result->decoded, outcome.frame.name);
      record.add(outcome.frame);
      outcome.write_milliseconds = milliseconds_since(writing);
      warn_of_scene(outcome);
    }
    progress.show(static_cast<int>(outcomes.size()), scenes);
  }
  if (decoded == 0) throw FileError(outcomes.front().error);
  for (const SceneOutcome& outcome : outcomes) {
    if (!outcome.error.empty()) spdlog::error("{}", outcome.error);
  }
  record.write_table();
  folder.finish([](const fs::path&) { return true; });
  const std::chrono::duration<double> seconds = WallClock::now() - start;
  report(settings, call, outcomes, seconds.count());
  if (decoded < outcomes.size()) {
    throw Error(fmt::format("{} of {} scenes could not be decoded; the others were decoded.",
                            outcomes.size() - decoded, outcomes.size()));
  }
}

}  // namespace palpate::apps
