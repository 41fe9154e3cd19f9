// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/capture_decoding.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/sensing/decodable.h"
#include "palpate/sensing/decode_frame.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "seeing/decode_input.h"
#include "seeing/live_camera_call.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

/// Frames after which a misfit is reported, so that nobody records for hours in vain.
constexpr std::size_t kFirstJudgement = 5;

/// The settings as `palpate decode` records them, so that it can continue with --resume.
Json live_settings(const LiveDecodeCall& call, const sensing::CameraState& camera) {
  return decode_settings({.rig = call.rig,
                          .pattern = call.pattern,
                          .colors = call.colors,
                          .response = call.response,
                          .bayer = camera.bayer ? bayer_name(*camera.bayer) : "",
                          .bits = camera.bits > 8 ? camera.bits : 0,
                          .options = call.options});
}

}  // namespace

LiveDecoding::LiveDecoding(const LiveDecodeCall& call, const sensing::CameraState& camera)
    : call_(call), bayer_(camera.bayer), bits_(camera.bits) {
  const sensing::Rig rig = load_rig(call_.rig);
  check_sends_frames_of(rig.camera, call_.rig, camera);
  const sensing::Pattern pattern = sensing::read_pattern(call_.pattern);
  sensing::check_pattern_fits(pattern, rig.projector, call_.pattern.string());
  if (pattern.stripe_edges.empty()) {
    throw InvalidInput(call_.pattern.string() +
                       ": has no stripes, so single frames cannot be decoded while they come. "
                       "Record them, and decode them with --anchor or --multishot.");
  }
  const sensing::TrainedColors colors = sensing::read_trained_colors(call_.colors);
  if (!call_.response.empty()) linearizer_.emplace(sensing::read_response(call_.response));
  decoder_.emplace(rig, pattern, colors, call_.options);
  live_settings_ = live_settings(call_, camera);
  folder_.emplace(call_.output, decoded_files, ResultFolder::Unfinished::kept);
  if (folder_->replaces()) {
    throw InvalidInput(
        call_.output.string() +
        ": already holds range maps. Give a new folder for those of this recording.");
  }
  outputs_.folder = folder_->place();
}

void LiveDecoding::decode(const sensing::RecordedFrame& frame, const fs::path& file) {
  const std::string name = file.filename().string();
  const auto read = [&] {
    try {
      return sensing::decodable(frame.image, bayer_, bits_);
    } catch (const InvalidInput& error) {
      throw InvalidInput(name + ": " + error.what());
    }
  };
  sensing::SourceFrame source{.number = frame.index, .name = name, .file = file, .read = read};
  if (linearizer_) linearize_when_read(*linearizer_, source);
  const sensing::DecodedFrame decoded = sensing::decode_frame(std::move(source), *decoder_);
  Outcome outcome;
  outcome.error = decoded.error;
  outcome.frame.number = frame.index;
  outcome.frame.name = name;
  if (decoded.error.empty()) {
    {
      const std::lock_guard lock(mutex_);
      if (!std::exchange(begun_, true)) {
        DecodeRecord(outputs_.folder, live_settings_, {}).begin();
        sensing::write_rig(outputs_.folder / "rig.yaml", decoder_->rig());
      }
    }
    outcome.frame.milliseconds = decoded.decode_milliseconds;
    outcome.frame.evidence = decoded.result.evidence;
    measure_depths(decoded.result.range.z, outcome.frame);
    write_outputs(outputs_, frame.index, decoded.result);
  }
  add(std::move(outcome), frame);
}

void LiveDecoding::add(Outcome outcome, const sensing::RecordedFrame& frame) {
  const std::chrono::duration<double, std::milli> delay =
      std::chrono::steady_clock::now() - frame.arrival;
  const std::lock_guard lock(mutex_);
  delays_.push_back(delay.count());
  evidence_ += outcome.frame.evidence;
  outcomes_[frame.index] = std::move(outcome);
  if (has_warned_ || outcomes_.size() < kFirstJudgement) return;
  const sensing::DecodeJudgement judgement = sensing::judge(evidence_);
  if (judgement.usable()) return;
  has_warned_ = true;
  spdlog::warn("the frames do not fit rig, pattern or colours: {}.", judgement.reason);
}

void LiveDecoding::finish(const std::vector<fs::path>& frames) {
  if (!begun_) return;
  DecodeRecord record(outputs_.folder, live_settings_, frames);
  record.begin();
  for (auto& [index, outcome] : outcomes_) {
    if (!outcome.error.empty()) continue;
    const FinishedFrame stamp = stamped(
        {.number = index, .name = outcome.frame.name, .file = frames.at(index), .read = {}});
    outcome.frame.bytes = stamp.bytes;
    outcome.frame.modified = stamp.modified;
    record.add(outcome.frame);
  }
  record.write_table();
}

}  // namespace palpate::apps
