// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/sensing/multishot.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/response.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_doubts.h"
#include "palpate/sensing/trained_colors.h"
#include "seeing/decode_frames.h"
#include "seeing/decode_input.h"
#include "seeing/decode_multishot.h"
#include "seeing/decode_outputs.h"
#include "seeing/decode_record.h"
#include "seeing/decode_report.h"
#include "seeing/decode_shard.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/progress.h"
#include "shared/result_folder.h"

namespace palpate::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// The next frame to be decoded. Frames that an earlier run has finished are added to `kept`.
std::optional<sensing::SourceFrame> next_unfinished(const DecodeCall& call,
                                                    sensing::FrameSource& source,
                                                    const DecodeRecord& record, Outcomes& kept) {
  while (auto frame = source.next()) {
    const FinishedFrame* finished = record.find(*frame);
    if (finished == nullptr || !has_outputs(call.outputs, frame->number, finished->pixels > 0))
      return frame;
    kept[frame->number] = {.error = {}, .frame = *finished, .kept = true};
  }
  return std::nullopt;
}

/// Returns true if the rig is the one stored with the range maps.
bool lies_in_output(const DecodeCall& call) {
  return fs::weakly_canonical(call.rig) == fs::weakly_canonical(call.output / "rig.yaml");
}

/// Describes the content of the folder if the run ends now.
std::string what_is_kept(const ResultFolder& folder, const DecodeRecord& record,
                         const sensing::FrameSource& source) {
  return folder.what_is_kept(record.finished(),
                             std::max(record.finished(), source.expected_frames()));
}

/// Writes the table of the frames of a run that did not finish.
void write_table_if_there_is_room(const DecodeRecord& record) {
  try {
    record.write_table();
  } catch (const OutputError&) {  // --resume needs only the record
  }
}

/// Decodes all frames that are not finished.
Outcomes decode_all(const sensing::Decoder& decoder, const DecodeCall& call,
                    sensing::FrameSource& source, const ResultFolder& folder,
                    DecodeRecord& record) {
  Outcomes kept, outcomes;
  Progress progress("decoding");
  const InterruptMessage message(what_is_kept(folder, record, source));
  const auto begin = [&] {
    folder.begin();
    record.begin();
    // Written before the first range map, so that range maps of an interrupted run are usable. A
    // rig that is already there is kept as it was written.
    if (!lies_in_output(call)) sensing::write_rig(call.outputs.folder / "rig.yaml", decoder.rig());
  };
  const auto finished = [&](const Outcome& outcome) {
    if (outcome.error.empty()) record.add(outcome.frame);
    outcomes[outcome.frame.number] = outcome;
    InterruptMessage::set_kept(what_is_kept(folder, record, source));
    progress.show(outcome.frame.number + 1, source.expected_frames());
  };
  try {
    decode_frames(decoder, call,
                  {.next = [&] { return next_unfinished(call, source, record, kept); },
                   .begin = begin,
                   .finished = finished});
  } catch (const Interrupted&) {
    write_table_if_there_is_room(record);
    throw;
  } catch (...) {
    if (record.finished() > 0) {
      write_table_if_there_is_room(record);
      spdlog::warn("{}", what_is_kept(folder, record, source));
    }
    throw;
  }
  record.write_table();
  outcomes.merge(kept);
  return outcomes;
}

/// Everything that a range map depends on besides its frame, by the names of the options.
Json settings_of(const DecodeCall& call) {
  return decode_settings({.rig = call.rig,
                          .pattern = call.pattern,
                          .colors = call.colors,
                          .response = call.response,
                          .bayer = call.bayer,
                          .bits = call.bits,
                          .options = call.options});
}

/// Gives options of single frames to the decoder of several images, which has three of them.
void share_options(const std::vector<CLI::Option*>& given, DecodeCall& call) {
  for (const CLI::Option* option : given) {
    if (option->count() == 0) continue;
    const std::string name = option->get_name();
    if (name == "--min-signal") {
      call.multishot_options.min_signal = call.options.min_signal;
    } else if (name == "--max-phase-variance") {
      call.multishot_options.max_phase_variance = call.options.max_phase_variance;
    } else if (name == "--max-sensitivity") {
      call.multishot_options.max_sensitivity = call.options.max_sensitivity;
    } else {
      throw InvalidInput("--multishot: excludes " + name +
                         ", which is for single frames; leave one of them out");
    }
  }
}

/// Several images of a still scene give one range map.
void decode_scenes(const Settings& settings, const DecodeCall& call, sensing::FrameSource& source,
                   const sensing::Rig& rig, const sensing::Pattern& pattern) {
  Json record_settings = settings_of(call);
  record_settings["--multishot"] = true;
  sensing::MultishotOptions options = call.multishot_options;
  record_settings.update(option_values(fields_of(options)));
  const sensing::MultishotDecoder decoder(rig, pattern, options);
  decode_multishot(settings, {.decoder = decoder,
                              .source = source,
                              .linearizer = call.linearizer ? &*call.linearizer : nullptr,
                              .output = call.output,
                              .outputs = call.outputs,
                              .record_settings = record_settings,
                              .writes_rig = !lies_in_output(call)});
}

sensing::Decoder make_decoder(const DecodeCall& call, const sensing::Rig& rig,
                              const sensing::Pattern& pattern) {
  sensing::TrainedColors colors;
  if (!call.colors.empty()) {
    colors = sensing::read_trained_colors(call.colors);
  } else if (!pattern.stripe_edges.empty()) {
    throw InvalidInput("--colors: is missing; " + call.pattern.string() +
                       " has coloured stripes. Give the trained colours (colors.yaml), as palpate "
                       "calibrate colors writes them.");
  }
  return {rig, pattern, colors, call.options};
}

/// The journals of a sharded run are invalid after its merge.
bool is_no_journal(const fs::path& result) { return !result.has_parent_path(); }

void decode(const Settings& settings, const CLI::App& command, DecodeCall call) {
  refuse_pipes({{"--rig", call.rig},
                {"--pattern", call.pattern},
                {"--colors", call.colors},
                {"--response", call.response}});
  if (call.options.half_resolution && lies_in_output(call)) {
    throw InvalidInput("--half-resolution: " + call.rig.string() +
                       " would be replaced by the rig of the smaller range maps; choose another "
                       "folder for them");
  }
  sensing::FrameSource source = open_frames(call.frames, call.bayer, call.bits, call.output);
  if (!call.response.empty()) call.linearizer.emplace(sensing::read_response(call.response));
  const sensing::Rig rig = load_rig(call.rig);
  const sensing::Pattern pattern = sensing::read_pattern(call.pattern);
  sensing::check_pattern_fits(pattern, rig.projector, call.pattern.string());
  if (call.multishot) return decode_scenes(settings, call, source, rig, pattern);
  if (pattern.multishot && call.options.anchors.empty()) {
    throw InvalidInput("--multishot: is missing; " + call.pattern.string() +
                       " is for several images of a still scene");
  }
  if (!call.options.anchors.empty())
    tell_doubts(call.pattern.string(), sensing::sinusoid_doubts(rig, pattern));
  call.outputs.noise = call.outputs.sigma && rig.covariance.has_value();
  const sensing::Decoder decoder = make_decoder(call, rig, pattern);
  call.shown = pattern;
  if (call.shard) {
    return decode_shard(settings, {.command = command,
                                   .decoder = decoder,
                                   .source = source,
                                   .call = call,
                                   .record_settings = settings_of(call),
                                   .writes_rig = !lies_in_output(call)});
  }
  using enum ResultFolder::Unfinished;
  ResultFolder folder(call.output, decoded_files, call.resume ? resumed : kept);
  call.outputs.folder = folder.place();
  DecodeRecord record(folder.place(), settings_of(call), source.files());
  if (call.resume) record.resume();

  const Clock::time_point start = Clock::now();
  const Outcomes outcomes = decode_all(decoder, call, source, folder, record);
  if (outcomes.empty())
    throw FileError(call.frames.front().string() + ": holds no frame; pass images or a video.");
  const std::size_t broken = count_broken(outcomes);
  const sensing::DecodeJudgement judgement = judge_sequence(outcomes);
  if (judgement.usable() || call.force) folder.finish(is_no_journal);
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  report_decoding(settings, folder.place(), call.outputs, outcomes, judgement, seconds);
  refuse_misfit(judgement, call.force,
                fmt::format("What was decoded is in {}{}; to accept it, run the same call again "
                            "with --resume --force.",
                            folder.place().string(),
                            folder.replaces() ? ", and the earlier results are unchanged" : ""));
  refuse_broken(broken, outcomes.size());
}

}  // namespace

void add_decode(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<DecodeCall>();
  CLI::App* command = app.add_subcommand("decode", "Decode camera frames into range maps");
  add_required(*command, "FRAMES", call->frames, "Images, folders of images, videos");
  add_required(*command, "--rig", call->rig, "Camera and projector (rig.yaml)");
  add_required(*command, "--pattern", call->pattern, "Projected pattern (pattern.yaml)");
  CLI::Option* colors = command->add_option(
      "--colors", call->colors, "Trained colours (colors.yaml), for a pattern with stripes");
  command->add_option(
      "--response", call->response,
      "Response of projector and camera (response.yaml): frames are linearised first");
  const std::vector<CLI::Option*> decoding = add_fields(*command, fields_of(call->options));
  CLI::Option* bits = add_number(
      *command, "--bits", call->bits, at_least(8).at_most(16),
      "Number of bits that the camera delivers, if its frames are 16-bit files: 12 if its "
      "largest value is 4095");
  add_word(*command, "--bayer", call->bayer, {"rggb", "bggr", "grbg", "gbrg"},
           "The frames are raw mosaics of a single-chip camera: the colours of the first two "
           "pixels, then of the two below");
  DecodeOutputs& outputs = call->outputs;
  add_required(*command, "-o,--output", call->output, "Folder for the range maps");
  add_word(*command, "--meshes", outputs.meshes, {"ply", "obj", "stl", "pcd"},
           "Also write each range map as a mesh, or (pcd) as an organised point cloud");
  command->add_flag("--surface-color", outputs.color,
                    "Also write the colour of the surface without stripes and fringes, "
                    "NNNNNN_color.png, and give it to --meshes (ply, obj, pcd)");
  command->add_flag(
      "--pictures", outputs.pictures,
      "Also draw each range map in false colour (PNG), and what --sigma and --reasons "
      "write; drawing takes longer than decoding");
  command->add_flag("--sigma", outputs.sigma,
                    "Also write the predicted standard deviation of each depth [mm]: "
                    "NNNNNN_sigma.tiff. If the rig has a "
                    "covariance (calibrate rig writes it), they contain the rig's uncertainty, and "
                    "NNNNNN_noise.tiff has the noise alone; otherwise the rig counts as exact");
  command->add_flag(
      "--reasons", outputs.reasons,
      "Also write why pixels have no depth, as codes: NNNNNN_reasons.tiff. The picture of "
      "--pictures has a legend");
  CLI::Option* resume = command->add_flag(
      "--resume", call->resume,
      "Keep the frames that an earlier run with the same settings finished in this folder");
  CLI::Option* force =
      command->add_flag("--force", call->force,
                        "Accept range maps of frames that do not fit rig, pattern or colours");
  CLI::Option* multishot = command->add_flag(
      "--multishot", call->multishot,
      "Several images of a static scene give one range map: shifted sinusoids, then a "
      "Gray code, as the pattern says (palpate pattern --multishot)");
  CLI::Option* shard = add_shard_option(*command, call->shard);
  for (CLI::Option* other : {colors, bits, resume, force, shard}) multishot->excludes(other);
  for (CLI::Option* other : {resume, force}) shard->excludes(other);
  constexpr std::array<std::string_view, 1> kExposures{"exposures"};
  add_fields(*command, fields_of(call->multishot_options), kExposures).front()->needs(multishot);
  command->footer(
      "Frames are numbered from 0 in the order of their file names, in which numbers count as "
      "numbers: the range map of the first frame is 000000.tiff. frames.csv lists which frame "
      "belongs to which range map.\n"
      "A broken frame is reported and skipped, and the exit status is 1; the other frames keep "
      "their numbers.\n"
      "Frames whose stripes contradict their sinusoid do not fit rig, pattern or colours. If that "
      "holds for all together, the exit status is 1 and a sentence states the likely cause. What "
      "was decoded stays, but does not replace earlier results; --resume --force accepts it.\n"
      "Without --resume, results of an earlier run in the folder are replaced when all frames are "
      "decoded; until then they stay as they are. With --resume, frames are kept for which "
      "decode.jsonl, the record of finished frames, and all requested files exist. Ctrl-C keeps "
      "the frames that are finished, for --resume.\n"
      "Examples:\n  palpate decode frames/ --rig rig.yaml --pattern pattern.yaml --colors "
      "colors.yaml -o range/ --meshes ply\n"
      "  palpate decode captures/ --multishot --rig rig.yaml --pattern multishot/pattern.yaml -o "
      "still/ --sigma\n"
      "  palpate decode wave.mkv --bayer rggb --rig rig.yaml --pattern pattern.yaml --colors "
      "colors.yaml -o range/ --sigma --reasons --resume");
  command->callback([call, command, decoding, &settings] {
    if (call->multishot) share_options(decoding, *call);
    decode(settings, *command, *call);
  });
}

}  // namespace palpate::apps
