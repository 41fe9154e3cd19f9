// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/sensing/bayer.h"

namespace palpate::sensing {

/// One frame of a sequence, not yet read.
struct SourceFrame {
  std::size_t number = 0;      ///< its place in the sequence, from 0
  std::string name;            ///< of its file; in a video with its number there: "wave.avi#12"
  std::filesystem::path file;  ///< image or video
  /// Gives the image as `Decoder` wants it; may be called in any thread.
  /// \throws FileError if the frame cannot be read; the others still can.
  std::function<cv::Mat()> read;
};

struct FrameSourceOptions {
  /// Given: the frames are mosaics of a single-chip camera.
  std::optional<BayerPattern> bayer = {};
};

/// The frames of images, folders of images and videos, one after another: nothing is read before
/// its turn, and nothing is kept.
class FrameSource {
 public:
  /// `paths`: images (PNG, TIFF), folders (all PNG and TIFF in them by name), videos (whatever
  /// OpenCV's FFmpeg reads: AVI, MP4, MKV and others), in the order of the sequence.
  /// \throws FileError for a path that does not exist, a folder without an image, or a video that
  /// cannot be opened.
  explicit FrameSource(const std::vector<std::filesystem::path>& paths,
                       const FrameSourceOptions& options = {});
  ~FrameSource();
  FrameSource(FrameSource&&) noexcept;
  FrameSource& operator=(FrameSource&&) noexcept;

  /// The next frame; nothing at the end. A video that ends before its announced number of frames
  /// gives a last frame that cannot be read and says so.
  [[nodiscard]] std::optional<SourceFrame> next();

  /// The files in their order, folders replaced by their images.
  [[nodiscard]] const std::vector<std::filesystem::path>& files() const;
  /// How many frames there are, as far as the videos know: only for showing progress.
  [[nodiscard]] std::size_t expected_frames() const;
  /// What should be known about the source, such as a video that is compressed with losses.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The images (png, tif, tiff) in a folder, by name, numbers in it as numbers (`comes_before`).
/// \throws FileError if it cannot be read or there are none.
[[nodiscard]] std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);

}  // namespace palpate::sensing
