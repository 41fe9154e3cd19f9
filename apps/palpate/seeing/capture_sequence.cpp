// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "palpate/core/error.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/sensing/recording.h"
#include "seeing/capture.h"
#include "seeing/capture_decoding.h"
#include "seeing/capture_files.h"
#include "seeing/capture_stage.h"
#include "seeing/projector_window.h"
#include "shared/call_checks.h"
#include "shared/field_options.h"
#include "shared/interrupts.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

/// Entries of the list of lost frames in a message.
constexpr std::size_t kMostGaps = 8;

struct SequenceCall {
  LiveCameraCall camera;
  fs::path output;
  std::optional<std::uint64_t> count;
  std::optional<double> seconds;
  LiveDecodeCall decode;
  fs::path show;
  std::string projector;
};

/// "3, 17 to 21": the frames of `lost` that have one cause.
std::string lost_in_words(const std::vector<sensing::LostFrames>& lost, bool by_memory) {
  std::string words;
  std::size_t gaps = 0;
  for (const sensing::LostFrames& frames : lost) {
    if (frames.by_memory != by_memory) continue;
    if (++gaps > kMostGaps) continue;
    words += fmt::format("{}{}", gaps > 1 ? ", " : "", frames.first);
    if (frames.count > 1) words += fmt::format(" to {}", frames.first + frames.count - 1);
  }
  if (gaps > kMostGaps) words += fmt::format(" and in {} more places", gaps - kMostGaps);
  return words;
}

void warn_of_losses(const sensing::Recording& recording) {
  const std::string never = lost_in_words(recording.lost, false);
  if (!never.empty()) {
    spdlog::warn(
        "frames that the camera took never arrived: {}. The connection or this computer was too "
        "slow; a lower --rate, a smaller --size or fewer programs beside it may help",
        never);
  }
  const std::string unwritten = lost_in_words(recording.lost, true);
  if (!unwritten.empty()) {
    spdlog::warn(
        "frames found no memory, because writing was too slow: {}. Record to a faster disk, or "
        "with a lower --rate",
        unwritten);
  }
}

/// Shows the state of a recording on a terminal, and ends it at Ctrl-C.
class RecordingWatch {
 public:
  explicit RecordingWatch(const Settings& settings)
      : shows_(!settings.quiet && ::isatty(STDERR_FILENO) != 0) {}
  ~RecordingWatch() {
    if (shown_) std::fputs("\r\x1b[K", stderr);
  }
  RecordingWatch(const RecordingWatch&) = delete;
  RecordingWatch& operator=(const RecordingWatch&) = delete;

  bool go_on(std::size_t recorded, std::uint64_t lost) {
    const Clock::time_point now = Clock::now();
    if (shows_ && now - drawn_ >= kRedraw) {
      drawn_ = now;
      shown_ = true;
      std::fputs(
          fmt::format("\r\x1b[Krecording: {} frames, {} lost; Ctrl-C ends it", recorded, lost)
              .c_str(),
          stderr);
    }
    try {
      InterruptedByThrowing::check();
    } catch (const Interrupted&) {
      return false;
    }
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kRedraw{250};

  InterruptedWithoutHaste interrupts_;
  bool shows_;
  bool shown_ = false;
  Clock::time_point drawn_ = Clock::now();
};

Json decoding_figures(const LiveDecoding& decoding, const SequenceCall& call,
                      const sensing::DecodeJudgement& judgement, std::size_t skipped) {
  std::size_t decoded = 0;
  std::vector<double> milliseconds;
  for (const auto& [index, outcome] : decoding.outcomes()) {
    if (!outcome.error.empty()) continue;
    ++decoded;
    milliseconds.push_back(outcome.frame.milliseconds);
  }
  const auto delays = geometry::error_statistics(decoding.delays());
  const auto most = std::ranges::max_element(decoding.delays());
  return {{"folder", call.decode.output.string()},
          {"decoded", decoded},
          {"skipped", skipped},
          {"broken", decoding.outcomes().size() - decoded},
          {"verdict", sensing::to_string(judgement.verdict)},
          {"reason", judgement.reason},
          {"ms_per_frame", number_or_null(geometry::error_statistics(milliseconds).median)},
          {"delay_ms", number_or_null(delays.median)},
          {"largest_delay_ms",
           number_or_null(most == decoding.delays().end() ? std::nullopt
                                                          : std::optional<double>(*most))}};
}

/// The call that decodes the frames that were skipped.
std::string decode_words(const SequenceCall& call, const sensing::CameraState& camera) {
  LiveDecodeCall decode = call.decode;
  sensing::DecodeOptions usual;
  std::string words = fmt::format("palpate decode {} --resume --rig {} --pattern {} --colors {}",
                                  call.output.string(), decode.rig.string(),
                                  decode.pattern.string(), decode.colors.string());
  if (!decode.response.empty()) words += " --response " + decode.response.string();
  words += changed_options(fields_of(decode.options), fields_of(usual));
  return words + decode_options_of(camera) + " -o " + decode.output.string();
}

void report(const Settings& settings, const SequenceCall& call, const sensing::CameraState& camera,
            const sensing::Recording& recording, const LiveDecoding* decoding,
            const sensing::DecodeJudgement& judgement) {
  const std::uint64_t lost = sensing::count_lost(recording.lost);
  const double rate = recording.seconds > 0
                          ? static_cast<double>(recording.frames + lost - 1) / recording.seconds
                          : 0;
  Json gaps = Json::array();
  for (const sensing::LostFrames& frames : recording.lost) {
    gaps.push_back({{"first", frames.first},
                    {"frames", frames.count},
                    {"cause", frames.by_memory ? "memory" : "camera"}});
  }
  Json figures = {{"folder", call.output.string()},
                  {"camera", camera_figures(camera)},
                  {"frames", recording.frames},
                  {"frames_lost", lost},
                  {"gaps", gaps},
                  {"seconds", recording.seconds},
                  {"frames_per_second", number_or_null(rate)},
                  {"most_waiting", recording.most_waiting}};
  std::string prose = fmt::format(
      "{}: {} frames in {}{}; {}{}", camera.name, recording.frames, call.output.string(),
      rate > 0 ? fmt::format(", {:.1f} frames/s", rate) : "",
      lost == 0 ? "none was lost" : fmt::format("{} were lost", lost),
      camera.counts_frames ? "" : ", as far as their times tell: this camera does not count");
  if (decoding != nullptr) {
    const Json decoded = decoding_figures(*decoding, call, judgement, recording.skipped);
    figures["decoding"] = decoded;
    prose += fmt::format("\n{} frames were decoded into {} while they came, {} were skipped",
                         decoded["decoded"].get<std::size_t>(), call.decode.output.string(),
                         recording.skipped);
    if (!decoding->delays().empty()) {
      prose += fmt::format(
          "; a range map was there {:.0f} ms after its frame (median; at most {:.0f} ms)",
          decoded["delay_ms"].get<double>(), decoded["largest_delay_ms"].get<double>());
    }
    if (recording.skipped > 0)
      prose += "\nTo decode those that were skipped: " + decode_words(call, camera);
  } else {
    const std::string options = decode_options_of(camera);
    if (!options.empty()) prose += "\nDecode these frames with" + options;
  }
  print(settings, figures, prose);
}

std::vector<fs::path> files_of(const CaptureFiles& files, std::size_t count) {
  std::vector<fs::path> paths;
  for (std::size_t i = 0; i < count; ++i) paths.push_back(files.file(i));
  return paths;
}

void record_sequence(const Settings& settings, const SequenceCall& call) {
  const LiveDecodeCall& decode = call.decode;
  const bool decodes = !decode.output.empty();
  if (decodes && (decode.rig.empty() || decode.pattern.empty() || decode.colors.empty()))
    throw InvalidInput("--decode: needs --rig, --pattern and --colors, as palpate decode does.");
  check_outputs({call.show, decode.rig, decode.pattern, decode.colors, decode.response},
                {call.output, decode.output});
  const std::unique_ptr<sensing::LiveCamera> camera = open_live_camera(call.camera);
  std::optional<ProjectorWindow> projector;
  if (!call.show.empty()) projector.emplace(call.projector);
  if (projector) projector->show(call.show);
  std::optional<LiveDecoding> decoding;
  if (decodes) decoding.emplace(decode, camera->state());
  CaptureFiles files(call.output, camera_figures(camera->state()));
  sensing::RecordingOptions options{
      .frames = call.count, .seconds = call.seconds, .patience = call.camera.patience};
  if (decodes) options.decoders = tbb::this_task_arena::max_concurrency();
  sensing::RecordingWork work{
      .write = [&](const sensing::RecordedFrame& frame) { files.write(frame); }};
  if (decodes) {
    work.decode = [&](const sensing::RecordedFrame& frame) {
      decoding->decode(frame, files.file(frame.index));
    };
  }
  sensing::Recording recording;
  try {
    RecordingWatch watch(settings);
    work.go_on = [&](std::size_t recorded, std::uint64_t lost) {
      return watch.go_on(recorded, lost);
    };
    recording = sensing::record(*camera, options, work);
    files.write_table();
    if (decoding) decoding->finish(files_of(files, recording.frames));
  } catch (const OutputError& full) {
    throw OutputError(fmt::format("{} The recording has ended; {} frames are in {}.", full.what(),
                                  files.written(), call.output.string()));
  }
  sensing::DecodeJudgement judgement;
  if (decoding) judgement = judge_sequence(decoding->outcomes());
  warn_of_losses(recording);
  report(settings, call, camera->state(), recording, decoding ? &*decoding : nullptr, judgement);
  if (!recording.broken_off.empty()) {
    throw DeviceError(fmt::format("{}. The {} frames until then are in {}.", recording.broken_off,
                                  recording.frames, call.output.string()));
  }
  if (decoding && !judgement.usable()) {
    throw Error(fmt::format(
        "all frames are recorded, but they do not fit rig, pattern or colours, so depths are "
        "likely to be wrong: {}.",
        judgement.reason));
  }
}

}  // namespace

void add_capture_sequence(CLI::App& capture, const Settings& settings) {
  auto call = std::make_shared<SequenceCall>();
  CLI::App* command = capture.add_subcommand(
      "sequence", "Record a sequence of frames; with --decode, also decode it");
  add_live_camera_options(*command, call->camera);
  add_required(*command, "-o,--output", call->output, "New folder for the frames");
  add_number(*command, "--count", call->count, at_least(1), "End after this number of frames");
  add_number(*command, "--seconds", call->seconds, above(0).finite(), "End after this time [s]");
  CLI::Option* decode =
      command->add_option("--decode", call->decode.output,
                          "Also decode the frames that the computer keeps up with, into this new "
                          "folder of range maps");
  command->add_option("--rig", call->decode.rig, "Camera and projector (rig.yaml)")->needs(decode);
  command->add_option("--pattern", call->decode.pattern, "Projected pattern (pattern.yaml)")
      ->needs(decode);
  command->add_option("--colors", call->decode.colors, "Trained colours (colors.yaml)")
      ->needs(decode);
  command
      ->add_option("--response", call->decode.response,
                   "Response of projector and camera (response.yaml)")
      ->needs(decode);
  for (CLI::Option* option : add_fields(*command, fields_of(call->decode.options)))
    option->needs(decode);
  CLI::Option* show = command->add_option(
      "--show", call->show, "Show this image on the projector meanwhile (pattern.png)");
  command
      ->add_option("--projector", call->projector,
                   "Monitor that is the projector, by number or name (palpate-project --list); "
                   "default: the last one")
      ->needs(show);
  command->footer(
      "Without --count and --seconds the recording goes on until Ctrl-C, which ends it with all "
      "frames written.\n"
      "Frames are written as the camera sends them (frame_000000.tiff, ...); times.csv has the "
      "number and the time of each. The camera never waits: frames that writing does not keep up "
      "with wait in memory, and what is lost is listed by number. A recording is never replaced.\n"
      "Only frames that are at most two behind the newest are decoded; palpate decode --resume "
      "decodes the others afterwards.\n"
      "Examples:\n  palpate capture sequence aravis:Basler-21857625 --rate 100 --exposure 4000 "
      "--seconds 10 -o frames/\n"
      "  palpate capture sequence aravis:Basler-21857625 --show pattern/pattern.png -o frames/ "
      "--decode range/ --rig pattern/rig.yaml --pattern pattern/pattern.yaml --colors colors.yaml");
  command->callback([call, &settings] { record_sequence(settings, *call); });
}

}  // namespace palpate::apps
