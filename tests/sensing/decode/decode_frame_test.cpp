// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode_frame.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/work_in_order.h"
#include "synthetic_scene.h"

namespace palpate::sensing {
namespace {

/// A small camera, so that the tests are quick.
struct Setting {
  Rig rig = small_rig();
  Pattern pattern = make_pattern(Axis::y, 10, 1024);
  Decoder decoder{rig, pattern, ideal_colors()};

  static Rig small_rig() {
    Rig rig = make_rig(false);
    rig.camera = {.width = 80, .height = 60, .fx = 550, .fy = 550, .cx = 39.5, .cy = 29.5};
    return rig;
  }
  [[nodiscard]] cv::Mat frame(double distance) const {
    return render(rig, pattern, plane(Eigen::Vector3d::UnitZ(), distance)).frame;
  }
};

SourceFrame source_frame(std::size_t number, std::function<cv::Mat()> read) {
  return {.number = number,
          .name = "frame " + std::to_string(number),
          .file = {},
          .read = std::move(read)};
}

TEST(DecodeFrame, GivesWhatTheDecoderGives) {
  const Setting setting;
  const cv::Mat image = setting.frame(700);
  const DecodedFrame frame = decode_frame(source_frame(3, [&] { return image; }), setting.decoder);
  EXPECT_EQ(frame.error, "");
  EXPECT_EQ(frame.source.number, 3u);
  const DecodeResult expected = setting.decoder.decode(image);
  EXPECT_GT(count(expected.reasons, Reason::reconstructed), 0);
  EXPECT_TRUE((frame.result.reasons == expected.reasons).all());
  EXPECT_TRUE((frame.result.range.z == expected.range.z ||
               (frame.result.range.z.isNaN() && expected.range.z.isNaN()))
                  .all());
}

TEST(DecodeFrame, NamesTheFrameThatIsBrokenOrDoesNotFit) {
  const Setting setting;
  const DecodedFrame broken =
      decode_frame(source_frame(1, []() -> cv::Mat { throw FileError("frame 1: is truncated"); }),
                   setting.decoder);
  EXPECT_EQ(broken.error, "frame 1: is truncated");
  EXPECT_EQ(broken.source.name, "frame 1");
  const DecodedFrame misfit =
      decode_frame(source_frame(3, [] { return cv::Mat(10, 10, CV_8UC3); }), setting.decoder);
  EXPECT_NE(misfit.error.find("frame 3: frame: is 10 x 10 px"), std::string::npos) << misfit.error;
}

TEST(DecodeFrame, LetsGoOfTheImageThatItsReaderHolds) {
  const Setting setting;
  const auto image = std::make_shared<const cv::Mat>(setting.frame(700));
  const DecodedFrame frame =
      decode_frame(source_frame(0, [image] { return *image; }), setting.decoder);
  EXPECT_EQ(image.use_count(), 1);
  EXPECT_EQ(frame.source.read, nullptr);
}

// Decodes a sequence as the example in the header does.
TEST(DecodeFrame, DecodesASequenceInItsOrder) {
  const Setting setting;
  const std::vector<cv::Mat> images = {setting.frame(600), setting.frame(700), setting.frame(800)};
  std::size_t begun = 0;
  std::vector<std::size_t> numbers;
  work_in_order<DecodedFrame>(
      [&]() -> std::optional<DecodedFrame> {
        if (begun == 30) return std::nullopt;
        const cv::Mat image = images[begun % images.size()];
        return DecodedFrame{.source = source_frame(begun++, [image] { return image; })};
      },
      [&](DecodedFrame& frame) { frame = decode_frame(std::move(frame.source), setting.decoder); },
      [&](DecodedFrame& frame) {
        const DecodeResult expected = setting.decoder.decode(images[frame.source.number % 3]);
        EXPECT_TRUE((frame.result.reasons == expected.reasons).all());
        numbers.push_back(frame.source.number);
      },
      4);
  ASSERT_EQ(numbers.size(), 30u);
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], i);
}

}  // namespace
}  // namespace palpate::sensing
