// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/reason_image.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

/// Every reason, in an image whose rows and columns differ in number.
ReasonImage every_reason() {
  ReasonImage reasons(3, kReasonCount);
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < kReasonCount; ++u)
      reasons(v, u) = static_cast<std::uint8_t>((u + 5 * v) % kReasonCount);
  }
  return reasons;
}

TEST(ReasonImage, IsReadAsItWasWritten) {
  const ScratchFolder folder;
  const ReasonImage reasons = every_reason();
  for (const char* name : {"reasons.tiff", "reasons.png"}) {
    write_reasons(folder / name, reasons);
    const ReasonImage read = read_reasons(folder / name);
    ASSERT_EQ(read.rows(), reasons.rows()) << name;
    ASSERT_EQ(read.cols(), reasons.cols()) << name;
    EXPECT_TRUE((read == reasons).all()) << name;
  }
}

TEST(ReasonImage, IsAnImageOfCodesForOtherPrograms) {
  const ScratchFolder folder;
  const ReasonImage reasons = every_reason();
  write_reasons(folder / "reasons.tiff", reasons);
  const cv::Mat image = cv::imread(folder / "reasons.tiff", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_8UC1);
  ASSERT_EQ(image.size(), cv::Size(kReasonCount, 3));
  EXPECT_EQ(image.at<unsigned char>(2, 1), reasons(2, 1));
}

TEST(ReasonImage, RefusesWhatHoldsNoReasons) {
  const ScratchFolder folder;
  const std::string codes = folder / "codes.png";
  cv::imwrite(codes, cv::Mat(4, 5, CV_8UC1, cv::Scalar(kReasonCount)));
  EXPECT_NE(message_of<FileError>([&] {
              (void)read_reasons(codes);
            }).find("code " + std::to_string(kReasonCount)),
            std::string::npos);
  const std::string colors = folder / "colors.png";
  cv::imwrite(colors, cv::Mat(4, 5, CV_8UC3, cv::Scalar(1, 1, 1)));
  EXPECT_NE(message_of<FileError>([&] { (void)read_reasons(colors); }).find("one channel"),
            std::string::npos);
  EXPECT_THROW((void)read_reasons(folder / "missing.tiff"), FileError);
  EXPECT_THROW(write_reasons(folder / "none.tiff", {}), InvalidInput);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.tiff"));
}

}  // namespace
}  // namespace palpate::sensing
