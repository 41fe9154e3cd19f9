// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "palpate/sensing/decode.h"
#include "palpate/sensing/frame_source.h"

namespace palpate::sensing {

/// One frame of a sequence, read and decoded.
struct DecodedFrame {
  SourceFrame source = {};   ///< without `read`, which may hold the image
  std::string error = {};    ///< why there is no result, with the name of the frame; else empty
  cv::Mat image = {};        ///< as it was read; empty if there is an error
  DecodeResult result = {};  ///< empty if there is an error
  double read_milliseconds = 0;
  double decode_milliseconds = 0;
};

/// Reads and decodes one frame. A frame that cannot be read, or does not fit the decoder, becomes
/// an error in the result, so that it does not stop a sequence.
///
/// `work_in_order` decodes a sequence in parallel and in bounded memory:
///
///     FrameSource source({"frames/"});
///     work_in_order<DecodedFrame>(
///         [&]() -> std::optional<DecodedFrame> {
///           auto frame = source.next();
///           if (!frame) return std::nullopt;
///           return DecodedFrame{.source = std::move(*frame)};
///         },
///         [&](DecodedFrame& frame) { frame = decode_frame(std::move(frame.source), decoder); },
///         [](DecodedFrame& frame) { ... }, usual_live_items());
[[nodiscard]] DecodedFrame decode_frame(SourceFrame source, const Decoder& decoder);

}  // namespace palpate::sensing
