// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/image_codecs.h"

#include <opencv2/core.hpp>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/module.h"

namespace palpate::sensing {
namespace {

const ImageCodecs& image_codecs() {
  static const void* const codecs = module_symbol("image_codecs");
  return *static_cast<const ImageCodecs*>(codecs);
}

}  // namespace

cv::Mat decode_image(const std::filesystem::path& path, const std::string& bytes, int flags) {
  const QuietOpenCv quiet;
  cv::Mat image;
  try {
    image = image_codecs().decode(bytes, flags);
  } catch (const cv::Exception& error) {
    throw FileError(path.string() + ": cannot be decoded (" + error.err + ")");
  }
  if (image.empty()) throw FileError(path.string() + ": is truncated or damaged");
  return image;
}

}  // namespace palpate::sensing
