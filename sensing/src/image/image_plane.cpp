// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/image_plane.h"

#include <algorithm>
#include <array>
#include <limits>
#include <opencv2/core.hpp>
#include <string>

#include "image/hot_loop.h"
#include "palpate/core/error.h"

namespace palpate::sensing {
namespace {

/// Order of the channels of a BGR image: green first, then red and blue.
constexpr int plane_of_channel(int channel, int channels) {
  return channels == 1 ? 0 : (channel + 2) % 3;
}

template <int channels, typename T>
void split_row(const T* values, float scale, long columns, const std::array<float*, 3>& out) {
  for (long column = 0; column < columns; ++column) {
    for (int channel = 0; channel < channels; ++channel) {
      out[static_cast<std::size_t>(plane_of_channel(channel, channels))][column] =
          scale * static_cast<float>(values[column * channels + channel]);
    }
  }
}

template <typename T>
void split(const cv::Mat& frame, std::vector<Plane>& planes) {
  constexpr float scale = 1.0F / std::numeric_limits<T>::max();
  for (int row = 0; row < frame.rows; ++row) {
    if (planes.size() == 1) {
      split_row<1>(frame.ptr<T>(row), scale, frame.cols, {&planes[0](row, 0)});
    } else {
      split_row<3>(frame.ptr<T>(row), scale, frame.cols,
                   {&planes[0](row, 0), &planes[1](row, 0), &planes[2](row, 0)});
    }
  }
}

/// Finds the pixels at which the only channel reaches `least`.
PALPATE_HOT_LOOP void find_bright(const float* values, float least, long count,
                                  std::uint8_t* __restrict bright) {
  for (long i = 0; i < count; ++i) bright[i] = values[i] >= least ? 1 : 0;
}

/// Finds where the largest of three channels, minus the smallest if `colored`, reaches `least`.
PALPATE_HOT_LOOP void find_bright(const float* a, const float* b, const float* c, bool colored,
                                  float least, long count, std::uint8_t* __restrict bright) {
  const float share = colored ? 1.0F : 0.0F;
  for (long i = 0; i < count; ++i) {
    const float high = a[i] > b[i] ? a[i] : b[i];
    const float low = a[i] < b[i] ? a[i] : b[i];
    const float highest = high > c[i] ? high : c[i];
    const float lowest = low < c[i] ? low : c[i];
    bright[i] = highest - share * lowest >= least ? 1 : 0;
  }
}

PALPATE_HOT_LOOP void unite(std::uint8_t* __restrict values, const std::uint8_t* other,
                            long count) {
  for (long i = 0; i < count; ++i) values[i] |= other[i];
}

PALPATE_HOT_LOOP void intersect(std::uint8_t* __restrict values, const std::uint8_t* other,
                                long count) {
  for (long i = 0; i < count; ++i) values[i] &= other[i];
}

/// Union (or intersection) of the rows within `radius`.
template <typename Combine>
void filter_columns(const Mask& in, int radius, Combine combine, Mask& out) {
  out = in;
  for (long row = 0; row < in.rows(); ++row) {
    const long first = std::max<long>(0, row - radius);
    const long last = std::min<long>(in.rows() - 1, row + radius);
    for (long other = first; other <= last; ++other)
      combine(&out(row, 0), &in(other, 0), in.cols());
  }
}

/// A value is clipped if it is within half an 8-bit step of full scale.
constexpr float kFullScale = 1 - 0.5F / 255;

PALPATE_HOT_LOOP void add_clipped(const float* values, std::uint8_t* clipped, long count) {
  for (long i = 0; i < count; ++i) clipped[i] = values[i] >= kFullScale ? 1 : clipped[i];
}

}  // namespace

bool is_frame(const cv::Mat& image) {
  return image.dims == 2 && !image.empty() && (image.depth() == CV_8U || image.depth() == CV_16U) &&
         (image.channels() == 1 || image.channels() == 3);
}

double full_scale(const cv::Mat& frame) { return frame.depth() == CV_8U ? 255 : 65535; }

void split_frame(const cv::Mat& frame, bool transposed, std::vector<Plane>& out) {
  if (!is_frame(frame)) {
    throw InvalidInput("frame: a frame of 8 or 16 bit with 1 or 3 channels is expected");
  }
  cv::Mat oriented = frame;
  if (transposed) cv::transpose(frame, oriented);
  out.resize(static_cast<std::size_t>(frame.channels()));
  for (Plane& plane : out) plane.resize(oriented.rows, oriented.cols);
  if (frame.depth() == CV_8U) {
    split<std::uint8_t>(oriented, out);
  } else {
    split<std::uint16_t>(oriented, out);
  }
}

void find_lit(const std::vector<Plane>& channels, const LitOptions& options, Mask& lit) {
  const auto least = static_cast<float>(options.min_signal);
  const Plane& first = channels[0];
  Mask bright(first.rows(), first.cols());
  if (channels.size() == 1) {
    find_bright(first.data(), least, first.size(), bright.data());
  } else {
    find_bright(first.data(), channels[1].data(), channels[2].data(), options.colored, least,
                first.size(), bright.data());
  }
  Mask filled;
  filter_columns(bright, options.radius, unite, filled);
  filter_columns(filled, options.radius, intersect, lit);
}

void find_clipped(const std::vector<Plane>& channels, Mask& clipped) {
  clipped.setZero(channels[0].rows(), channels[0].cols());
  for (const Plane& channel : channels) add_clipped(channel.data(), clipped.data(), clipped.size());
}

}  // namespace palpate::sensing
