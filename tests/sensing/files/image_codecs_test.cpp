// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/image_codecs.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(ImageCodecs, DecodeWhatOpenCvDecodes) {
  cv::Mat image(20, 30, CV_8UC3);
  cv::randu(image, 0, 255);
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes);
  for (const int flags :
       {static_cast<int>(cv::IMREAD_GRAYSCALE), static_cast<int>(cv::IMREAD_ANYCOLOR)}) {
    const cv::Mat found = decode_image("a.jpg", std::string(bytes.begin(), bytes.end()), flags);
    const cv::Mat expected = cv::imdecode(bytes, flags);
    ASSERT_EQ(found.type(), expected.type());
    EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0);
  }
}

TEST(ImageCodecs, NameTheFileThatIsDamaged) {
  EXPECT_EQ(
      message_of<FileError>([] { (void)decode_image("a.jpg", "no image", cv::IMREAD_GRAYSCALE); }),
      "a.jpg: is truncated or damaged");
}

}  // namespace
}  // namespace palpate::sensing
