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

/// A frame of a sequence that has not been read yet.
struct SourceFrame {
  std::size_t number = 0;      ///< index in the sequence, from 0
  std::string name;            ///< file name; for a video with the frame number: "wave.avi#12"
  std::filesystem::path file;  ///< image or video
  /// Reads the image in the form that `Decoder` takes; may be called from any thread.
  /// \throws FileError if this frame cannot be read; other frames are not affected.
  std::function<cv::Mat()> read;
};

struct FrameSourceOptions {
  /// If given, the frames are raw mosaics of a single-chip camera.
  std::optional<BayerPattern> bayer = {};
  /// Bits that the values of 16-bit frames use, in [8, 16]: 12 if the camera's full scale is 4095.
  int bits = 16;
};

/// The frames of images, folders of images and videos as one sequence. Each frame is read only when
/// it is needed, and no frame is kept.
class FrameSource {
 public:
  /// \param paths images that `read_frame` reads, folders (all their images by name) and videos
  /// (AVI, MP4, MKV and others that OpenCV's FFmpeg reads), in the order of the sequence.
  /// \throws FileError if a path does not exist, a folder has no image, or a video cannot be
  /// opened.
  explicit FrameSource(const std::vector<std::filesystem::path>& paths,
                       const FrameSourceOptions& options = {});
  ~FrameSource();
  FrameSource(FrameSource&&) noexcept;
  FrameSource& operator=(FrameSource&&) noexcept;

  /// Returns the next frame; empty at the end. A video that ends before its declared number of
  /// frames gives a last frame whose `read` throws an error that says so.
  [[nodiscard]] std::optional<SourceFrame> next();

  /// The files in sequence order; folders are replaced by their images.
  [[nodiscard]] const std::vector<std::filesystem::path>& files() const;
  /// Number of frames as declared by the videos; may be wrong, so use it only for progress.
  [[nodiscard]] std::size_t expected_frames() const;
  /// Warnings about the source, such as lossy compression of a video or of images.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Lists the images in a folder (those whose names `has_frame_name` accepts), sorted by name.
/// Numbers in names are compared as numbers (`comes_before`): 2.png comes before 10.png. Other
/// files are left out.
/// \throws FileError if the folder cannot be read or has no images.
[[nodiscard]] std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder);

}  // namespace palpate::sensing
