// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `image_codecs`.
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "files/image_codecs.h"

namespace {

cv::Mat decode(const std::string& bytes, int flags) {
  const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
  return cv::imdecode(buffer, flags);
}

}  // namespace

const palpate::sensing::ImageCodecs palpate_image_codecs{&decode};
