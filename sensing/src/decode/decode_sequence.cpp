// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode_sequence.h"

#include <chrono>

#include "palpate/error.h"
#include "palpate/work_in_order.h"

namespace palpate::sensing {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void decode_one(const Decoder& decoder, DecodedFrame& frame) {
  cv::Mat image;
  Clock::time_point start = Clock::now();
  try {
    image = frame.source.read();
  } catch (const Error& broken) {
    frame.error = broken.what();
    return;
  }
  // A frame of a video is held by its reader.
  frame.source.read = nullptr;
  frame.read_milliseconds = milliseconds_since(start);
  start = Clock::now();
  try {
    frame.result = decoder.decode(image);
  } catch (const Error& misfit) {
    frame.error = frame.source.name + ": " + misfit.what();
  }
  frame.decode_milliseconds = milliseconds_since(start);
}

}  // namespace

void decode_sequence(const std::function<std::optional<SourceFrame>()>& next,
                     const Decoder& decoder,
                     const std::function<void(const DecodedFrame&)>& deliver,
                     const DecodeSequenceOptions& options) {
  work_in_order<DecodedFrame>(
      [&]() -> std::optional<DecodedFrame> {
        std::optional<SourceFrame> source = next();
        if (!source) return std::nullopt;
        DecodedFrame frame;
        frame.source = std::move(*source);
        return frame;
      },
      [&](DecodedFrame& frame) {
        decode_one(decoder, frame);
        if (!frame.error.empty() || !options.in_parallel) return;
        const Clock::time_point start = Clock::now();
        options.in_parallel(frame);
        frame.work_milliseconds = milliseconds_since(start);
      },
      [&](DecodedFrame& frame) { deliver(frame); },
      options.max_live_frames.value_or(usual_live_items()));
}

}  // namespace palpate::sensing
