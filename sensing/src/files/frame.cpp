// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/frame.h"

#include <opencv2/imgcodecs.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "files/png_image.h"
#include "files/storage_file.h"
#include "palpate/error.h"
#include "palpate/output_file.h"

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
  const QuietOpenCv quiet;
  cv::Mat frame;
  try {
    const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
    frame = cv::imdecode(buffer, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
  } catch (const cv::Exception& error) {
    throw FileError(path.string() + ": cannot be decoded (" + error.err + ")");
  }
  if (frame.empty()) throw FileError(path.string() + ": is truncated or damaged");
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
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image, bytes))
    throw OutputError(path.string() + ": cannot be encoded as PNG");
  write_file(path, [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  });
}

}  // namespace palpate::sensing
