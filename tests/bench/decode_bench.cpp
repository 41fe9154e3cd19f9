// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Decoding of one frame against the least that any demodulation in OpenCV does: six separable
// low-pass filters.
#include "palpate/sensing/decode.h"

#include <opencv2/imgproc.hpp>

#include <filesystem>

#include "paired.h"
#include "palpate/sensing/frame.h"

namespace {

namespace sensing = palpate::sensing;

void decode_against_opencv_low_pass(benchmark::State& state) {
  const std::filesystem::path demo = std::filesystem::path(PALPATE_SOURCE_DIR) / "demo";
  const sensing::Decoder decoder(sensing::read_rig(demo / "rig.yaml"),
                                 sensing::read_pattern(demo / "pattern.yaml"),
                                 sensing::train_colors_from_folder(demo / "training"));
  const cv::Mat frame = sensing::read_frame(demo / "frames/duck.png");
  constexpr int kKernelLength = 15;  // px, two periods of the pattern in the image
  const cv::Mat kernel = cv::getGaussianKernel(kKernelLength, kKernelLength / 6.0, CV_32F);
  cv::Mat channel, filtered;
  cv::extractChannel(frame, channel, 1);
  channel.convertTo(channel, CV_32F);
  cv::setNumThreads(1);
  palpate::bench::run_paired(
      state, [&] { benchmark::DoNotOptimize(decoder.decode(frame)); },
      [&] {
        for (int i = 0; i < 6; ++i)
          cv::sepFilter2D(channel, filtered, CV_32F, kernel,
                          kernel);  // real and imaginary, three channels
        benchmark::DoNotOptimize(filtered.data);
      });
}
BENCHMARK(decode_against_opencv_low_pass)->Unit(benchmark::kMillisecond);

}  // namespace
