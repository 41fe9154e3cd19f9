// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "planes.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <string>

#include "hot_loop.h"
#include "palpate/error.h"

namespace palpate::sensing {
namespace {

/// Where the channels of an image in BGR order go: green first, then red and blue.
constexpr int plane_of_channel(int channel, int channels) {
  return channels == 1 ? 0 : (channel + 2) % 3;
}

template <typename T>
void split(const cv::Mat& frame, float scale, std::vector<Plane>& planes) {
  const int channels = frame.channels();
  for (int row = 0; row < frame.rows; ++row) {
    const T* values = frame.ptr<T>(row);
    for (int channel = 0; channel < channels; ++channel) {
      const auto plane = static_cast<std::size_t>(plane_of_channel(channel, channels));
      float* out = &planes[plane](row, 0);
      for (int column = 0; column < frame.cols; ++column) {
        out[column] = scale * static_cast<float>(values[column * channels + channel]);
      }
    }
  }
}

PALPATE_HOT_LOOP void raise_to(float* values, const float* other, long count) {
  for (long i = 0; i < count; ++i) values[i] = values[i] > other[i] ? values[i] : other[i];
}

PALPATE_HOT_LOOP void lower_to(float* values, const float* other, long count) {
  for (long i = 0; i < count; ++i) values[i] = values[i] < other[i] ? values[i] : other[i];
}

/// Largest (or smallest) value within `radius` rows.
template <typename Combine>
Plane filter_columns(const Plane& in, int radius, Combine combine) {
  Plane out = in;
  for (long row = 0; row < in.rows(); ++row) {
    const long first = std::max<long>(0, row - radius);
    const long last = std::min<long>(in.rows() - 1, row + radius);
    for (long other = first; other <= last; ++other)
      combine(&out(row, 0), &in(other, 0), in.cols());
  }
  return out;
}

}  // namespace

std::vector<Plane> split_frame(const cv::Mat& frame, bool transposed) {
  const bool known = frame.dims == 2 && (frame.depth() == CV_8U || frame.depth() == CV_16U) &&
                     (frame.channels() == 1 || frame.channels() == 3);
  if (!known || frame.empty()) {
    throw InvalidInput("frame: a frame of 8 or 16 bit with 1 or 3 channels is expected");
  }
  cv::Mat oriented = frame;
  if (transposed) cv::transpose(frame, oriented);
  std::vector<Plane> planes(static_cast<std::size_t>(frame.channels()),
                            Plane(oriented.rows, oriented.cols));
  if (frame.depth() == CV_8U) {
    split<std::uint8_t>(oriented, 1.0F / 255, planes);
  } else {
    split<std::uint16_t>(oriented, 1.0F / 65535, planes);
  }
  return planes;
}

Plane projector_light(const std::vector<Plane>& channels, bool colored, int radius) {
  Plane light = channels[0];
  if (channels.size() > 1) {
    for (std::size_t i = 1; i < channels.size(); ++i)
      raise_to(light.data(), channels[i].data(), light.size());
  }
  if (colored) {
    Plane low = channels[0];
    for (std::size_t i = 1; i < channels.size(); ++i)
      lower_to(low.data(), channels[i].data(), low.size());
    light -= low;
  }
  const Plane filled = filter_columns(light, radius, raise_to);
  return filter_columns(filled, radius, lower_to);
}

}  // namespace palpate::sensing
