// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>

#include <opencv2/core/mat.hpp>

namespace palpate::python {

namespace py = pybind11;

/// The pixels of a camera, in OpenCV's form and without a copy if they lie one after the other.
class Frame {
 public:
  /// \throws InvalidInput unless the object is an array of uint8 or uint16 of one or three channels.
  explicit Frame(const py::object& object);
  [[nodiscard]] const cv::Mat& mat() const { return mat_; }

 private:
  py::array pixels_;
  cv::Mat mat_;
};

/// An image as an array of uint8 or uint16, which keeps the memory of the image.
[[nodiscard]] py::array pixels_of(cv::Mat&& image);

}  // namespace palpate::python
