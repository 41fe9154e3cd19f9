// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/frame.h"

#include <opencv2/imgcodecs.hpp>
#include <ostream>
#include <string>

#include "files/image_codecs.h"
#include "files/image_format.h"
#include "files/png_image.h"
#include "files/storage_file.h"
#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/input_file.h"
#include "palpate/core/output_file.h"

namespace palpate::sensing {
namespace {

/// \throws FileError unless the bytes are those of a whole image in a known format.
void check_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::string damage;
  switch (image_format(bytes)) {
    case ImageFormat::unknown:
      damage = "neither PNG, TIFF, BMP, JPEG nor WebP; a frame of 8 or 16 bit is expected";
      break;
    case ImageFormat::jpeg:
      damage = find_jpeg_damage(bytes);
      break;
    case ImageFormat::webp:
      damage = find_webp_damage(bytes);
      break;
    case ImageFormat::bmp:
      damage = find_bmp_damage(bytes);
      break;
    case ImageFormat::png:
    case ImageFormat::tiff:
      break;  // the decoders notice it
  }
  if (!damage.empty()) throw FileError(path.string() + ": " + damage);
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
  const std::string bytes = read_input_file(path);
  check_bytes(path, bytes);
  if (image_format(bytes) == ImageFormat::png) return read_png(path, bytes);
  // Ignore the orientation: the camera's pixels stay where the lens puts them.
  cv::Mat frame = decode_image(
      path, bytes, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (frame.depth() != CV_8U && frame.depth() != CV_16U) {
    throw FileError(path.string() + ": the values are neither 8 nor 16 bit whole numbers");
  }
  return frame;
}

bool has_frame_name(const std::filesystem::path& path) {
  const std::string ending = lower_extension(path);
  for (const char* known : {".png", ".tif", ".tiff", ".bmp", ".jpg", ".jpeg", ".webp"}) {
    if (ending == known) return true;
  }
  return false;
}

bool has_losses(const std::filesystem::path& path) {
  const std::string bytes = read_input_file(path);
  const ImageFormat format = image_format(bytes);
  return format == ImageFormat::jpeg || (format == ImageFormat::webp && is_lossy_webp(bytes));
}

void write_png(const std::filesystem::path& path, const cv::Mat& image) {
  if (!is_frame(image)) {
    throw InvalidInput("write_png(" + path.string() +
                       "): an image of 8 or 16 bit with 1 or 3 channels is expected");
  }
  const std::string bytes = encode_png(image);
  write_file(path, [&](std::ostream& out) {
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  });
}

}  // namespace palpate::sensing
