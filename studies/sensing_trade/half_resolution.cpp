// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "half_resolution.h"

#include <opencv2/imgproc.hpp>

namespace palpate::bench {
namespace {

View halved(const View& view) {
  View half;
  const int rows = view.frame.rows / 2, columns = view.frame.cols / 2;
  cv::resize(view.frame, half.frame, cv::Size(columns, rows), 0, 0, cv::INTER_AREA);
  half.z.resize(rows, columns);
  half.counted.resize(rows, columns);
  for (int v = 0; v < rows; ++v) {
    for (int u = 0; u < columns; ++u) {
      half.z(v, u) = view.z.block<2, 2>(2 * v, 2 * u).mean();  // NaN where one is
      half.counted(v, u) = view.counted.block<2, 2>(2 * v, 2 * u).all();
    }
  }
  return half;
}

}  // namespace

Scene half_resolution(Scene scene) {
  geometry::Camera& camera = scene.rig.camera;
  camera.width /= 2;
  camera.height /= 2;
  camera.fx /= 2;
  camera.fy /= 2;
  // The centre of the first pixel is that of four: 0.5 before.
  camera.cx = (camera.cx - 0.5) / 2;
  camera.cy = (camera.cy - 0.5) / 2;
  for (View& view : scene.views) view = halved(view);
  return scene;
}

}  // namespace palpate::bench
