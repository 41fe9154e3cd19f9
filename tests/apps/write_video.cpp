// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// write_video VIDEO IMAGE...: writes images as a lossless video (FFV1), for tests. A program of its
// own, because OpenCV's videos take longer to load than most tests.
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

int main(int count, char** arguments) {
  cv::VideoWriter writer;
  for (int i = 2; i < count; ++i) {
    const cv::Mat image = cv::imread(arguments[i]);
    if (i == 2)
      writer.open(arguments[1], cv::CAP_FFMPEG, cv::VideoWriter::fourcc('F', 'F', 'V', '1'), 25,
                  image.size());
    writer.write(image);
  }
  return writer.isOpened() ? 0 : 1;
}
