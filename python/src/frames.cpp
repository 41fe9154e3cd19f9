// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "frames.h"

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::python {

Frame::Frame(const py::object& object) {
  pixels_ = py::array::ensure(object, py::array::c_style);
  if (!pixels_) PyErr_Clear();
  const bool wide = pixels_ && py::isinstance<py::array_t<std::uint16_t>>(pixels_);
  const bool narrow = pixels_ && py::isinstance<py::array_t<std::uint8_t>>(pixels_);
  const bool color = pixels_ && pixels_.ndim() == 3 && pixels_.shape(2) == 3;
  if (!(wide || narrow) || !(color || pixels_.ndim() == 2)) {
    throw InvalidInput(
        "frame: must be uint8 or uint16, of shape (rows, columns) or (rows, "
        "columns, 3) with blue first, as read_frame() and OpenCV give it");
  }
  // Only read.
  mat_ =
      cv::Mat(static_cast<int>(pixels_.shape(0)), static_cast<int>(pixels_.shape(1)),
              CV_MAKETYPE(wide ? CV_16U : CV_8U, color ? 3 : 1), const_cast<void*>(pixels_.data()));
}

py::array pixels_of(cv::Mat&& image) {
  auto kept = std::make_unique<cv::Mat>(image.isContinuous() ? std::move(image) : image.clone());
  const cv::Mat& pixels = *kept;
  const py::capsule owner(kept.release(), [](void* held) { delete static_cast<cv::Mat*>(held); });
  const auto item = static_cast<py::ssize_t>(pixels.elemSize1());
  std::vector<py::ssize_t> shape{pixels.rows, pixels.cols};
  if (pixels.channels() > 1) shape.push_back(pixels.channels());
  const py::dtype type = item == 2 ? py::dtype::of<std::uint16_t>() : py::dtype::of<std::uint8_t>();
  return py::array(type, std::move(shape), pixels.data, owner);
}

}  // namespace palpate::python
