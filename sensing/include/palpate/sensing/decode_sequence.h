// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "palpate/sensing/decode.h"
#include "palpate/sensing/frame_source.h"

namespace palpate::sensing {

/// Result of one frame of a sequence.
struct DecodedFrame {
  SourceFrame source;
  std::string error;    ///< why there is no result; names the frame. Empty on success
  DecodeResult result;  ///< empty on error
  double read_milliseconds = 0;
  double decode_milliseconds = 0;
  double work_milliseconds = 0;  ///< time spent in `DecodeSequenceOptions::in_parallel`
};

struct DecodeSequenceOptions {
  /// Called for each decoded frame before its delivery, in parallel and in no fixed order. Write
  /// files here.
  std::function<void(const DecodedFrame&)> in_parallel = {};
  /// Upper limit of frames and results in memory; >= 1. Default: two per thread, at most 100.
  std::optional<int> max_live_frames = {};
};

/// Decodes the frames that `next` returns until it returns none. Frames are read and decoded in
/// parallel, each on its own, and delivered in order. A frame that cannot be read or does not fit
/// the decoder is delivered with its error, and decoding continues. An exception thrown by `next`,
/// `in_parallel` or `deliver` stops the sequence and propagates; frames delivered before are
/// complete.
///
///     FrameSource source({"frames/"});
///     decode_sequence([&] { return source.next(); }, decoder, [](const DecodedFrame& f) { ... });
///
/// \throws InvalidInput on an option outside its range.
void decode_sequence(const std::function<std::optional<SourceFrame>()>& next,
                     const Decoder& decoder,
                     const std::function<void(const DecodedFrame&)>& deliver,
                     const DecodeSequenceOptions& options = {});

}  // namespace palpate::sensing
