// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "setup/lens_entry.h"

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>

namespace palpate::sensing {
namespace {

/// Numbers of distortion coefficients in OpenCV's files.
constexpr std::array<int, 4> kDistortionLengths = {0, 4, 5, 8};

std::array<double, 8> read_distortion(const StorageFile& file, const std::string& key) {
  std::array<double, 8> distortion{};
  const YAML::Node node = file.child(file.root(), key);
  // FileStorage cannot write an empty matrix; an empty list also means no lens distortion.
  if (node.IsSequence() && node.size() == 0) return distortion;
  const cv::Mat_<double> values = file.matrix(key);
  const int count = static_cast<int>(values.total());
  const bool is_vector = count == 0 || values.rows == 1 || values.cols == 1;
  if (!is_vector || std::find(kDistortionLengths.begin(), kDistortionLengths.end(), count) ==
                        kDistortionLengths.end()) {
    file.fail(key, "has " + std::to_string(values.rows) + " x " + std::to_string(values.cols) +
                       " values; a vector of 0, 4, 5 or 8 coefficients is expected");
  }
  std::copy(values.begin(), values.end(), distortion.begin());
  return distortion;
}

}  // namespace

geometry::Camera read_lens(const StorageFile& file, const std::string& name) {
  geometry::Camera camera;
  const std::string size_key = name + "_size";
  const auto size = file.items(file.child(file.root(), size_key), size_key);
  if (size.size() != 2) file.fail(size_key, "width and height are expected");
  camera.width = file.whole_number(size[0], size_key);
  camera.height = file.whole_number(size[1], size_key);
  if (camera.width <= 0 || camera.height <= 0) file.fail(size_key, "must be positive");
  const std::string matrix_key = name + "_matrix";
  const cv::Mat_<double> matrix = file.matrix(matrix_key);
  if (matrix.rows != 3 || matrix.cols != 3) file.fail(matrix_key, "a 3 x 3 matrix is expected");
  if (matrix(0, 1) != 0 || matrix(1, 0) != 0 || matrix(2, 0) != 0 || matrix(2, 1) != 0 ||
      matrix(2, 2) != 1) {
    file.fail(matrix_key, "must have the form [fx 0 cx; 0 fy cy; 0 0 1]");
  }
  camera.fx = matrix(0, 0);
  camera.fy = matrix(1, 1);
  camera.cx = matrix(0, 2);
  camera.cy = matrix(1, 2);
  if (!(camera.fx > 0) || !(camera.fy > 0)) file.fail(matrix_key, "fx and fy must be > 0");
  camera.distortion = read_distortion(file, name + "_distortion");
  return camera;
}

void write_lens(cv::FileStorage& storage, const std::string& name, const geometry::Camera& camera) {
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx,  //
                          0, camera.fy, camera.cy,                            //
                          0, 0, 1);
  cv::Mat_<double> distortion(1, static_cast<int>(camera.distortion.size()));
  std::copy(camera.distortion.begin(), camera.distortion.end(), distortion.begin());
  storage << name + "_size"
          << "[:" << camera.width << camera.height << "]";
  storage << name + "_matrix" << matrix << name + "_distortion" << distortion;
}

}  // namespace palpate::sensing
