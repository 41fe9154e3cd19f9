// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/frame.h"

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "files/image_codecs.h"
#include "files/png_image.h"
#include "files/storage_file.h"
#include "palpate/error.h"

namespace palpate::sensing {
namespace {

bool is_png(const std::string& bytes) { return bytes.starts_with("\x89PNG"); }

bool is_tiff(const std::string& bytes) {
  using namespace std::string_literals;
  return bytes.starts_with("II*\0"s) || bytes.starts_with("MM\0*"s);
}

cv::Mat read_png(const std::filesystem::path& path, const std::string& bytes) {
  try {
    return decode_png(bytes);
  } catch (const InvalidInput& error) {
    throw FileError(path.string() + ": " + error.what());
  }
}

}  // namespace

cv::Mat read_frame(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  if (is_png(bytes)) {
    const std::string damage = find_png_damage(bytes);
    if (!damage.empty()) throw FileError(path.string() + ": " + damage);
    cv::Mat frame = read_png(path, bytes);
    if (!frame.empty()) return frame;
  } else if (!is_tiff(bytes)) {
    throw FileError(path.string() + ": neither PNG nor TIFF; a frame of 8 or 16 bit is expected");
  }
  cv::Mat frame = decode_image(path, bytes, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
  if (frame.depth() != CV_8U && frame.depth() != CV_16U) {
    throw FileError(path.string() + ": the values are neither 8 nor 16 bit whole numbers");
  }
  return frame;
}

void write_png(const std::filesystem::path& path, const cv::Mat& image) {
  const bool known = image.dims == 2 && (image.depth() == CV_8U || image.depth() == CV_16U) &&
                     (image.channels() == 1 || image.channels() == 3);
  if (!known || image.empty()) {
    throw InvalidInput("write_png(" + path.string() +
                       "): an image of 8 or 16 bit with 1 or 3 channels is expected");
  }
  write_image(path, ".png", image);
}

}  // namespace palpate::sensing
