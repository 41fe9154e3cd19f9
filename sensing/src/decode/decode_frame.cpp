// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode_frame.h"

#include <chrono>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::sensing {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

DecodedFrame decode_frame(SourceFrame source, const Decoder& decoder) {
  const auto read = std::exchange(source.read, nullptr);
  DecodedFrame frame{.source = std::move(source)};
  Clock::time_point start = Clock::now();
  try {
    frame.image = read();
  } catch (const Error& broken) {
    frame.error = broken.what();
    return frame;
  }
  frame.read_milliseconds = milliseconds_since(start);
  start = Clock::now();
  try {
    frame.result = decoder.decode(frame.image);
  } catch (const Error& misfit) {
    frame.error = frame.source.name + ": " + misfit.what();
    frame.image.release();
  }
  frame.decode_milliseconds = milliseconds_since(start);
  return frame;
}

}  // namespace palpate::sensing
