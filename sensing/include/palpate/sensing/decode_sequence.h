// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "palpate/sensing/decode.h"
#include "palpate/sensing/frame_source.h"

namespace palpate::sensing {

/// What one frame of a sequence came to.
struct DecodedFrame {
  SourceFrame source;
  std::string error;    ///< why there is no result; names the frame. Empty if there is one
  DecodeResult result;  ///< empty if there is an error
  double read_milliseconds = 0;
  double decode_milliseconds = 0;
  double work_milliseconds = 0;  ///< in `DecodeSequenceOptions::in_parallel`
};

struct DecodeSequenceOptions {
  /// Called in parallel and in no order on each frame that was decoded, before it is delivered: the
  /// place for writing files.
  std::function<void(const DecodedFrame&)> in_parallel = {};
  /// Never are more frames and results in memory; >= 1. Unless given, two a thread, at most 100.
  std::optional<int> max_live_frames = {};
};

/// Decodes the frames that `next` gives until it gives none: each alone, read and decoded in
/// parallel, delivered in their order. A frame that cannot be read or does not fit the decoder is
/// delivered with its error, and does not stop the others. What `next`, `in_parallel` or `deliver`
/// throws does, and passes through: frames that were delivered before are whole.
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
