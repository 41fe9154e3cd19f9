// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/video_file.h"

#include <algorithm>
#include <array>
#include <opencv2/videoio.hpp>
#include <string>
#include <string_view>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/module.h"

namespace palpate::sensing {
namespace {

constexpr std::array<std::string_view, 9> kEndings{".avi", ".m4v", ".mj2", ".mkv", ".mov",
                                                   ".mp4", ".mpg", ".ogv", ".webm"};
/// Lossless codecs, by their four characters; raw video has the characters of its pixel format.
constexpr std::array<std::string_view, 6> kLosslessCodecs{"FFV1", "HFYU", "FFVH",
                                                          "png ", "MPNG", "DIB "};
/// Pixel formats with one value per colour, or a single value, by FFmpeg's tags. Others hold
/// rounded colour differences, mostly at half the resolution.
constexpr std::array<std::string_view, 11> kFullPixels{
    "BGR", "RGB", "BGRA", "RGBA", "ABGR", "ARGB", "G3", "Y800", "GREY", "Y1", "GBRP"};

/// The characters of a tag in memory order, without unprintable ones.
std::string letters(double tag) {
  const auto bits = static_cast<unsigned>(static_cast<int>(tag));
  std::string text;
  for (const unsigned shift : {0U, 8U, 16U, 24U}) {
    const char letter = static_cast<char>((bits >> shift) & 0xFFU);
    if (std::isprint(static_cast<unsigned char>(letter)) != 0) text += letter;
  }
  return text;
}

template <std::size_t N>
bool is_among(const std::array<std::string_view, N>& known, const std::string& word) {
  return std::find(known.begin(), known.end(), word) != known.end();
}

VideoCapture open_video(const std::string& path) {
  static const void* const captures = module_symbol("video_capture");
  return static_cast<const VideoCaptures*>(captures)->open(path);
}

}  // namespace

bool is_video(const std::filesystem::path& path) {
  return is_among(kEndings, lower_extension(path));
}

VideoFile::VideoFile(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw FileError(path.string() + ": no such file");
  const QuietOpenCv quiet;
  capture_ = open_video(path.string());
  if (!capture_.read) {
    throw FileError(path.string() +
                    ": cannot be opened as a video; the file is damaged or cut off, or of a kind "
                    "that OpenCV's FFmpeg does not read");
  }
}

cv::Mat VideoFile::next() {
  const QuietOpenCv quiet;
  cv::Mat frame;
  if (!capture_.read(frame)) return {};
  return frame.clone();  // the capture may reuse its memory
}

std::size_t VideoFile::announced_frames() const {
  const double frames = capture_.property(cv::CAP_PROP_FRAME_COUNT);
  return frames > 0 ? static_cast<std::size_t>(frames) : 0;
}

bool VideoFile::is_lossless() const {
  const std::string codec = letters(capture_.property(cv::CAP_PROP_FOURCC));
  const std::string pixels = letters(capture_.property(cv::CAP_PROP_CODEC_PIXEL_FORMAT));
  const bool is_raw = codec.empty() || codec == pixels;
  return (is_raw || is_among(kLosslessCodecs, codec)) && is_among(kFullPixels, pixels);
}

}  // namespace palpate::sensing
