// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/sensing/decode.h"
#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/multishot.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/response.h"
#include "seeing/decode_outputs.h"
#include "seeing/decode_report.h"
#include "shards/shard.h"

namespace palpate::apps {

/// A call of `decode`.
struct DecodeCall {
  std::vector<std::filesystem::path> frames;
  std::filesystem::path rig, pattern, colors, response;
  std::optional<sensing::Linearizer> linearizer;  ///< of `response`
  std::string bayer;
  int bits = 0;  ///< of 16-bit frames; 0: not stated, all 16
  sensing::DecodeOptions options;
  std::filesystem::path output;  ///< the folder for the results
  DecodeOutputs outputs;         ///< in the folder where this run writes
  std::optional<Shard> shard;
  bool resume = false;
  bool force = false;      ///< accept frames that do not fit
  sensing::Pattern shown;  ///< read from `pattern`
  bool multishot = false;
  sensing::MultishotOptions multishot_options;
};

/// The source of frames, and functions to call besides decoding. `next` and `finished` are each
/// called by one thread at a time, but may overlap.
struct DecodeStages {
  /// The next frame to be decoded; nothing at the end.
  std::function<std::optional<sensing::SourceFrame>()> next;
  std::function<void()> begin;  ///< called once, before the first output is written
  std::function<void(const Outcome&)> finished;  ///< called for each frame, in order
};

/// Decodes frames in parallel, and writes the outputs of each. They are written or drawn while the
/// frame is in the pipeline; only its figures are kept. A frame that cannot be decoded is an
/// outcome with an error.
/// \throws OutputError if an output cannot be written, and the exceptions of the stages.
void decode_frames(const sensing::Decoder& decoder, const DecodeCall& call,
                   const DecodeStages& stages);

}  // namespace palpate::apps
