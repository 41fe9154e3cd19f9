// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "chromatic.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::sensing {

ChromaticLag chromatic_lag(const ChromaticShift& shift, const geometry::Camera& projector,
                           const Pattern& pattern) {
  const bool along_x = pattern.axis == Axis::x;
  const double focal = along_x ? projector.fx : projector.fy;
  const double center = along_x ? projector.cx : projector.cy;
  const double per_pixel = 2 * std::numbers::pi / pattern.period;
  // pixel - (focal ((pixel - center) / focal - gamma) / beta + center), times the phase per pixel
  const double slope = per_pixel * (1 - 1 / shift.beta);
  return {.slope = slope, .offset = per_pixel * focal * shift.gamma / shift.beta - slope * center};
}

ChannelShift channel_shift(const geometry::Camera& camera, double alpha,
                           const Eigen::Matrix2Xd& rays, const Carrier& carrier) {
  const bool transposed = carrier.transposed;
  if (alpha == 1 || camera.width < 2 || camera.height < 2) return {};
  const long rows = transposed ? camera.width : camera.height;
  const long columns = transposed ? camera.height : camera.width;
  ChannelShift shift{Plane(rows, columns), Plane(rows, columns), {}, {}};
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d ray = rays.col(static_cast<long>(v) * camera.width + u) / alpha;
      const Eigen::Vector2f move =
          (geometry::distort(camera, ray) - Eigen::Vector2d(u, v)).cast<float>();
      const long row = transposed ? u : v;
      const long column = transposed ? v : u;
      shift.columns(row, column) = transposed ? move.y() : move.x();
      shift.rows(row, column) = transposed ? move.x() : move.y();
    }
  }
  const Plane turn = shift.rows * static_cast<float>(carrier.along);
  shift.cosine = turn.cos();
  shift.sine = turn.sin();
  return shift;
}

Demodulated resample(const Demodulated& signal, const ChannelShift& shift) {
  if (shift.none()) return signal;
  const long rows = signal.re.rows();
  const long columns = signal.re.cols();
  Demodulated out{Plane::Zero(rows, columns), Plane::Zero(rows, columns), signal.mean};
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      const float x = static_cast<float>(column) + shift.columns(row, column);
      const float y = static_cast<float>(row) + shift.rows(row, column);
      if (!(x > -1 && y > -1 && x < static_cast<float>(columns) && y < static_cast<float>(rows)))
        continue;
      const auto left =
          static_cast<long>(std::clamp<float>(std::floor(x), 0, static_cast<float>(columns - 2)));
      const auto top =
          static_cast<long>(std::clamp<float>(std::floor(y), 0, static_cast<float>(rows - 2)));
      const float fx = std::clamp(x - static_cast<float>(left), 0.0F, 1.0F);
      const float fy = std::clamp(y - static_cast<float>(top), 0.0F, 1.0F);
      const auto blend = [&](const Plane& plane) {
        const float* above = &plane(top, left);
        const float* below = above + columns;
        return (1 - fy) * ((1 - fx) * above[0] + fx * above[1]) +
               fy * ((1 - fx) * below[0] + fx * below[1]);
      };
      const float re = blend(signal.re);
      const float im = blend(signal.im);
      const float cosine = shift.cosine(row, column);
      const float sine = shift.sine(row, column);
      out.re(row, column) = re * cosine - im * sine;
      out.im(row, column) = re * sine + im * cosine;
    }
  }
  return out;
}

Combined combine_channels(const std::vector<Demodulated>& channels, const ChromaticModel& model) {
  Combined combined{channels[0].re, channels[0].im, {}};
  if (channels.size() == 1) return combined;
  std::array<Plane, 2> re;
  std::array<Plane, 2> im;
  for (std::size_t i = 0; i < 2; ++i) {
    const ChannelModel& channel = model.channels[i];
    const Demodulated moved = resample(channels[i + 1], channel.shift);
    re[i] = moved.re * channel.cosine - moved.im * channel.sine;
    im[i] = moved.re * channel.sine + moved.im * channel.cosine;
    combined.re += re[i];
    combined.im += im[i];
  }
  const Plane norm = combined.re.square() + combined.im.square();
  combined.shares.red = (re[0] * combined.re + im[0] * combined.im) / norm;
  combined.shares.blue = (re[1] * combined.re + im[1] * combined.im) / norm;
  return combined;
}

}  // namespace palpate::sensing
