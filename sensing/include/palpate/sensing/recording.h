// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/sensing/live_camera.h"

namespace palpate::sensing {

/// A frame of a recording.
struct RecordedFrame {
  cv::Mat image;             ///< as `CameraFrame::image`
  std::uint64_t number = 0;  ///< as `CameraFrame::number`
  double time = 0;           ///< s since the first frame, by the camera's clock
  std::size_t index = 0;     ///< place in the recording, from 0, without gaps
  std::chrono::steady_clock::time_point arrival = {};
};

/// Frames that follow each other and are not in a recording.
struct LostFrames {
  std::uint64_t first = 0;  ///< number of the first one
  std::uint64_t count = 0;
  bool by_memory = false;  ///< they arrived, but writing was too slow; else they never arrived
};

struct RecordingOptions {
  std::optional<std::uint64_t> frames = {};  ///< ends after this number; >= 1
  std::optional<double> seconds = {};        ///< ends this long after the first frame; > 0 [s]
  /// For frames that wait to be written [bytes].
  std::size_t memory = std::size_t{512} << 20U;
  /// If no frame comes for this long [s], the camera counts as dead; > 0, more than its interval.
  double patience = 5;
  /// Threads that write. They wait for the disk most of the time.
  int writers = 4;
  int decoders = 0;  ///< threads that decode; 0 if frames are not decoded
};

/// The work on the frames of a recording. An exception of `write` or `decode` ends the recording.
struct RecordingWork {
  /// Writes a frame; called for every recorded frame, from several threads at once.
  std::function<void(const RecordedFrame&)> write;
  /// Decodes a frame; called for frames that it can keep up with, from several threads at once.
  std::function<void(const RecordedFrame&)> decode = {};
  /// Called after each frame and at least ten times a second with the number of frames so far and
  /// of lost ones; false ends the recording.
  std::function<bool(std::size_t recorded, std::uint64_t lost)> go_on = {};
};

struct Recording {
  std::size_t frames = 0;        ///< recorded, and written
  std::vector<LostFrames> lost;  ///< in the order of their numbers
  std::size_t skipped = 0;       ///< recorded frames that decoding did not keep up with
  std::size_t most_waiting = 0;  ///< largest number of frames that waited to be written
  double seconds = 0;            ///< between the first and the last frame, by the camera's clock
  /// The reason why it ended early; empty if it did not.
  std::string broken_off = {};
};

[[nodiscard]] std::uint64_t count_lost(const std::vector<LostFrames>& lost);

/// Records the frames of a camera. The camera never waits for a disk or a decoder: frames wait in
/// bounded memory. Those for which there is no room are lost and listed, like those that never
/// arrived; all others are written. Decoding begins with frames that are at most two behind the
/// newest one, and skips others.
///
/// If the camera stops sending (`patience`) or fails, the frames until then are written, and
/// `broken_off` says why.
/// \throws InvalidInput if an option is out of its range, and the exceptions of `write` and
/// `decode`; frames that wait are then dropped.
[[nodiscard]] Recording record(LiveCamera& camera, const RecordingOptions& options,
                               const RecordingWork& work);

/// Takes one image after something has changed in front of the camera, such as the projector's
/// picture. Frames that were exposed before are skipped: those that are already there, and one
/// more, whose exposure may have begun before the call.
/// \param patience [s] as above.
/// \throws DeviceError if the camera sends nothing for that long.
[[nodiscard]] CameraFrame take_fresh(LiveCamera& camera, double patience);

/// Takes the oldest frame that was not taken yet, and waits for one if there is none.
/// \throws DeviceError as `take_fresh`.
[[nodiscard]] CameraFrame take_next(LiveCamera& camera, double patience);

}  // namespace palpate::sensing
