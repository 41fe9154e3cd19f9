// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/reason_image.h"

#include <algorithm>
#include <string>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/tiff_frame.h"

namespace palpate::sensing {

void write_reasons(const std::filesystem::path& path, const ReasonImage& reasons) {
  if (reasons.size() == 0) throw InvalidInput(path.string() + ": reasons without pixels to write");
  const cv::Mat image(static_cast<int>(reasons.rows()), static_cast<int>(reasons.cols()), CV_8U,
                      const_cast<std::uint8_t*>(reasons.data()));
  if (path.extension() == ".png") {
    write_png(path, image);
  } else {
    write_tiff(path, image);
  }
}

ReasonImage read_reasons(const std::filesystem::path& path) {
  const cv::Mat image = read_frame(path);
  if (image.type() != CV_8UC1)
    throw FileError(path.string() + ": an image of reasons has one channel of 8 bit");
  ReasonImage reasons(image.rows, image.cols);
  for (int v = 0; v < image.rows; ++v)
    std::copy_n(image.ptr<std::uint8_t>(v), image.cols, reasons.row(v).data());
  const int largest = reasons.maxCoeff();
  if (largest >= kReasonCount) {
    throw FileError(path.string() + ": holds the code " + std::to_string(largest) +
                    "; reasons have codes from 0 to " + std::to_string(kReasonCount - 1));
  }
  return reasons;
}

}  // namespace palpate::sensing
