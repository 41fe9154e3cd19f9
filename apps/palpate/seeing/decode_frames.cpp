// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_frames.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "palpate/core/work_in_order.h"
#include "palpate/sensing/decode_frame.h"
#include "palpate/sensing/surface_color.h"
#include "seeing/decode_input.h"
#include "seeing/decode_record.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// A frame in the pipeline. Only one stage at a time uses it.
struct FrameItem {
  sensing::DecodedFrame decoded;
  FinishedFrame finished;
  double write_milliseconds = 0;           ///< including counting of pixels, logging and pictures
  std::vector<ShardFile> inputs, outputs;  ///< with --shard
};

/// Makes the function that reads a frame check and convert it as the call requests.
void prepare_reading(const DecodeCall& call, sensing::SourceFrame& frame) {
  if (call.bits == 0 && frame.number == 0) doubt_bits_when_read(frame);
  if (call.linearizer) linearize_when_read(*call.linearizer, frame);
  if (!call.options.anchors.empty() && frame.number == 0) examine_when_read(frame);
}

/// The colour of the surface in a frame, for screens.
cv::Mat color_of(const DecodeCall& call, const sensing::Rig& rig,
                 const sensing::DecodedFrame& decoded) {
  cv::Mat image = decoded.image;
  if (call.options.half_resolution) {
    const cv::Size size(rig.camera.width, rig.camera.height);
    cv::resize(image(cv::Rect(0, 0, 2 * size.width, 2 * size.height)), image, size, 0, 0,
               cv::INTER_AREA);
  }
  return sensing::srgb_of(sensing::surface_color(image, decoded.result.range, rig, call.shown));
}

/// Warns if most phases are not used because their surfaces have no anchor, or because steps may be
/// hidden between surfaces.
void warn_of_pixels_without_anchor(const std::string& frame, const sensing::ReasonImage& reasons) {
  const long doubtful = sensing::count(reasons, sensing::Reason::ambiguous_offset);
  if (doubtful > 0) {
    spdlog::warn(
        "{}: {} pixels around the anchors get no depth. The sinusoid hardly shows steps, and the "
        "anchored regions are not most of what it lights, so they may hold other surfaces whole "
        "periods away. Project stripes or the other --axis, or give an --anchor on each surface.",
        frame, doubtful);
    return;
  }
  const long without = sensing::count(reasons, sensing::Reason::no_transition);
  const long decoded = sensing::count(reasons, sensing::Reason::reconstructed);
  if (without <= decoded) return;
  spdlog::warn(
      "{}: {} pixels show the sinusoid on surfaces without an anchor, only {} on surfaces with "
      "one. Give an --anchor on each surface, at its depth in mm, away from edges and holes.",
      frame, without, decoded);
}

/// Measures those of some outputs of a frame that exist: a surface may have no triangle.
void measure_outputs(const DecodeCall& call, const std::vector<std::string>& endings,
                     FrameItem& item) {
  for (const std::string& ending : endings) {
    const auto file = numbered(call.outputs.folder, item.finished.number, ending);
    if (is_there(file)) item.outputs.push_back(measured(file, call.outputs.folder));
  }
}

/// Writes the data of a decoded frame, and measures the time.
void write_frame(const DecodeCall& call, const sensing::Rig& rig, FrameItem& item) {
  const Clock::time_point start = Clock::now();
  const sensing::DecodeResult& result = item.decoded.result;
  const sensing::SourceFrame& source = item.decoded.source;
  if (spdlog::should_log(spdlog::level::info)) {  // because counting takes long
    spdlog::info("{}: {} stripe edges, {} regions ({} without an offset); pixels: {}", source.name,
                 result.transitions, result.regions, result.unresolved_regions,
                 counts(result.reasons));
  }
  item.finished = stamped(source);
  item.finished.milliseconds = item.decoded.decode_milliseconds;
  item.finished.evidence = result.evidence;
  measure_depths(result.range.z, item.finished);
  if (item.finished.pixels == 0)
    spdlog::warn("{}: no pixel has a depth; run with -v to see why.", source.name);
  if (!call.options.anchors.empty()) warn_of_pixels_without_anchor(source.name, result.reasons);
  const cv::Mat color = call.outputs.color ? color_of(call, rig, item.decoded) : cv::Mat();
  item.decoded.image.release();
  write_outputs(call.outputs, source.number, result, color);
  if (call.shard) {
    item.inputs = {measured(source.file)};
    measure_outputs(call, output_endings(call.outputs, item.finished.pixels > 0).data, item);
  }
  item.write_milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Draws the pictures of a decoded frame, and measures the time.
Outcome outcome_of(const DecodeCall& call, FrameItem& item) {
  const sensing::SourceFrame& frame = item.decoded.source;
  if (!item.decoded.error.empty()) {
    Outcome broken{.error = item.decoded.error, .frame = {}};
    broken.frame.number = frame.number;
    broken.frame.name = frame.name;
    if (call.shard && is_there(frame.file)) broken.inputs = {measured(frame.file)};
    return broken;
  }
  const Clock::time_point start = Clock::now();
  draw_outputs(call.outputs, frame.number, item.decoded.result, frame.name);
  if (call.shard)
    measure_outputs(call, output_endings(call.outputs, item.finished.pixels > 0).pictures, item);
  item.write_milliseconds +=
      std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return {.error = {},
          .frame = item.finished,
          .read_milliseconds = item.decoded.read_milliseconds,
          .write_milliseconds = item.write_milliseconds,
          .inputs = std::move(item.inputs),
          .outputs = std::move(item.outputs)};
}

}  // namespace

void decode_frames(const sensing::Decoder& decoder, const DecodeCall& call,
                   const DecodeStages& stages) {
  std::once_flag begun;
  const auto next = [&]() -> std::optional<FrameItem> {
    std::optional<sensing::SourceFrame> frame = stages.next();
    if (!frame) return std::nullopt;
    prepare_reading(call, *frame);
    FrameItem item;
    item.decoded.source = std::move(*frame);
    return item;
  };
  const auto work = [&](FrameItem& item) {
    item.decoded = sensing::decode_frame(std::move(item.decoded.source), decoder);
    if (!item.decoded.error.empty()) return;
    std::call_once(begun, stages.begin);
    write_frame(call, decoder.rig(), item);
  };
  const auto deliver = [&](FrameItem& item) { stages.finished(outcome_of(call, item)); };
  work_in_order<FrameItem>(next, work, deliver, usual_live_items());
}

}  // namespace palpate::apps
