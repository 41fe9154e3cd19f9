// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "palpate/sensing/frame.h"
#include "whole/demo.h"

namespace palpate::apps {
namespace {

/// px, of each of the four images.
constexpr int kPaneWidth = 640;
constexpr int kPaneHeight = 480;

/// Draws an image into the middle of `pane`, a view of the pixels to fill, as large as it fits.
void fit_into(const cv::Mat& pane, const cv::Mat& image) {
  const double scale = std::min(static_cast<double>(pane.cols) / image.cols,
                                static_cast<double>(pane.rows) / image.rows);
  const cv::Size size(static_cast<int>(scale * image.cols), static_cast<int>(scale * image.rows));
  const cv::Rect place({(pane.cols - size.width) / 2, (pane.rows - size.height) / 2}, size);
  cv::resize(image, pane(place), size, 0, 0, cv::INTER_AREA);
}

}  // namespace

void demo_overview(const fs::path& data, const fs::path& output) {
  const std::array<fs::path, 4> images = {
      data / "frames/duck.png", output / "pictures/duck_mesh.png", output / "sheet/contacts.png",
      output / "sheet/contact.png"};
  cv::Mat overview(2 * kPaneHeight, 2 * kPaneWidth, CV_8UC3, cv::Scalar::all(255));
  for (int i = 0; i < 4; ++i) {
    const cv::Rect pane(i % 2 * kPaneWidth, i / 2 * kPaneHeight, kPaneWidth, kPaneHeight);
    fit_into(overview(pane), sensing::read_frame(images.at(static_cast<std::size_t>(i))));
  }
  sensing::write_png(output / "pictures/overview.png", overview);
}

}  // namespace palpate::apps
