// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "palpate/sensing/decode.h"
#include "palpate/sensing/live_camera.h"
#include "palpate/sensing/recording.h"
#include "palpate/sensing/response.h"
#include "seeing/decode_outputs.h"
#include "seeing/decode_record.h"
#include "seeing/decode_report.h"
#include "shared/result_folder.h"

namespace palpate::apps {

/// Options with which `capture sequence` decodes.
struct LiveDecodeCall {
  fs::path output;  ///< the folder of the range maps; empty: nothing is decoded
  fs::path rig, pattern, colors, response;
  sensing::DecodeOptions options;
};

/// Decodes frames of a recording while it continues, into a folder of range maps as `palpate
/// decode` writes it: the same call with --resume decodes the frames that were skipped.
class LiveDecoding {
 public:
  /// \throws InvalidInput if the camera is not the rig's, the folder has results, or as
  /// `sensing::Decoder`.
  LiveDecoding(const LiveDecodeCall& call, const sensing::CameraState& camera);

  /// Decodes a frame and writes its range map. Any thread may call this.
  /// \param file in which the frame is recorded.
  /// \throws OutputError if the disk is full.
  void decode(const sensing::RecordedFrame& frame, const fs::path& file);

  /// Records which frames are decoded. Call it when all frames are written.
  /// \param frames all recorded frames, in their order.
  void finish(const std::vector<fs::path>& frames);

  [[nodiscard]] const Outcomes& outcomes() const { return outcomes_; }
  /// [ms] from the arrival of a frame to its written range map.
  [[nodiscard]] const std::vector<double>& delays() const { return delays_; }

 private:
  void add(Outcome outcome, const sensing::RecordedFrame& frame);

  LiveDecodeCall call_;
  std::optional<sensing::BayerPattern> bayer_;
  int bits_ = 0;
  std::optional<sensing::Linearizer> linearizer_;
  std::optional<sensing::Decoder> decoder_;
  std::optional<ResultFolder> folder_;
  DecodeOutputs outputs_;
  Json live_settings_;
  std::mutex mutex_;
  bool begun_ = false;
  bool has_warned_ = false;
  Outcomes outcomes_;
  sensing::DecodeEvidence evidence_;  ///< the sum of their evidence
  std::vector<double> delays_;
};

}  // namespace palpate::apps
