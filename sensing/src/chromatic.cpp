// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "chromatic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hot_loop.h"

namespace palpate::sensing {
namespace {

/// Adds a channel to the sum, turned by the angle of `cosine` and `sine`, and keeps what was added.
PALPATE_HOT_LOOP void add_turned(const float* re, const float* im, const float* cosine,
                                 const float* sine, long columns, float* __restrict added_re,
                                 float* __restrict added_im, float* __restrict sum_re,
                                 float* __restrict sum_im) {
  for (long i = 0; i < columns; ++i) {
    added_re[i] = re[i] * cosine[i] - im[i] * sine[i];
    added_im[i] = re[i] * sine[i] + im[i] * cosine[i];
    sum_re[i] += added_re[i];
    sum_im[i] += added_im[i];
  }
}

PALPATE_HOT_LOOP void interpolate(const float* above, const float* below_it, const float* right,
                                  const float* below, long columns, float* __restrict out) {
  for (long i = 0; i < columns; ++i) {
    const float upper = above[i] + right[i] * (above[i + 1] - above[i]);
    const float lower = below_it[i] + right[i] * (below_it[i + 1] - below_it[i]);
    out[i] = upper + below[i] * (lower - upper);
  }
}

PALPATE_HOT_LOOP void find_share(const float* re, const float* im, const float* sum_re,
                                 const float* sum_im, long columns, float* __restrict share) {
  for (long i = 0; i < columns; ++i) {
    share[i] =
        (re[i] * sum_re[i] + im[i] * sum_im[i]) / (sum_re[i] * sum_re[i] + sum_im[i] * sum_im[i]);
  }
}

/// One row of a signal.
struct SignalRow {
  explicit SignalRow(long columns) : re(columns), im(columns) {}
  Eigen::ArrayXf re;
  Eigen::ArrayXf im;
};

/// One row of a channel where green sees it, the carrier and the lag not yet put in.
void shifted_row(const Demodulated& signal, const ChannelShift& shift, long row, SignalRow& out) {
  if (shift.none()) {
    out.re = signal.re.row(row);
    out.im = signal.im.row(row);
    return;
  }
  out.re.setZero();
  out.im.setZero();
  for (const ChannelShift::Run& run : shift.runs[static_cast<std::size_t>(row)]) {
    const float* right = &shift.right(row, run.begin);
    const float* below = &shift.below(row, run.begin);
    const long length = run.end - run.begin;
    interpolate(&signal.re(run.row, run.column), &signal.re(run.row + 1, run.column), right, below,
                length, &out.re[run.begin]);
    interpolate(&signal.im(run.row, run.column), &signal.im(run.row + 1, run.column), right, below,
                length, &out.im[run.begin]);
  }
}

/// About so many pixels tell of the chromatic error, every kErrorSpacing-th [px] of evenly spaced
/// rows: as far as the averaging along the rows reaches.
constexpr long kErrorSamples = 4000;
constexpr long kErrorSpacing = 5;
/// The noise of pixels twice as far apart is independent.
constexpr std::size_t kIndependent = 2;
/// Of a channel that counts in the sum, the squared modulation over green's lies between this and
/// its inverse.
constexpr float kLeastRatio = 0.3F;
/// Differences beyond this are of steps, not of lenses [rad].
constexpr double kLargestDifference = 0.5;
/// A mean is taken of so many products.
constexpr int kLeastProducts = 100;

struct Phasors {
  const float* re;
  const float* im;
};

/// One row of what `remaining_error` compares.
struct ComparedRow {
  Phasors green;
  const SignalRow& channel;
  Phasors turn;
  const float* phase;     ///< absolute
  const float* expected;  ///< projector pixel for which the channel was turned
  long row;
};

/// By how much a channel runs ahead of green at a pixel; NaN where they cannot be compared.
double difference(const ComparedRow& row, long i, const ChromaticLag& lag,
                  const PixelOfPhase& pixels) {
  const float channel_re = row.channel.re[i];
  const float channel_im = row.channel.im[i];
  const float power = channel_re * channel_re + channel_im * channel_im;
  const float reference = row.green.re[i] * row.green.re[i] + row.green.im[i] * row.green.im[i];
  const bool both = power > kLeastRatio * reference && reference > kLeastRatio * power;
  if (!both) return std::numeric_limits<double>::quiet_NaN();
  const float re = channel_re * row.turn.re[i] - channel_im * row.turn.im[i];
  const float im = channel_re * row.turn.im[i] + channel_im * row.turn.re[i];
  const float ahead = std::atan2(im * row.green.re[i] - re * row.green.im[i],
                                 re * row.green.re[i] + im * row.green.im[i]);
  const double moved =
      pixels.at(row.row, static_cast<double>(row.phase[i])) - static_cast<double>(row.expected[i]);
  return static_cast<double>(ahead) + lag.slope * moved;
}

/// The mean product of differences.
class Disagreement {
 public:
  void add_row(const ComparedRow& row, const ChromaticLag& lag, const PixelOfPhase& pixels) {
    differences_.clear();
    for (long i = 0; i < row.channel.re.size(); i += kErrorSpacing) {
      differences_.push_back(difference(row, i, lag, pixels));
    }
    for (std::size_t i = kIndependent; i < differences_.size(); ++i) {
      const double first = differences_[i - kIndependent];
      const double second = differences_[i];
      const bool both =
          std::abs(first) < kLargestDifference && std::abs(second) < kLargestDifference;
      if (!both) continue;
      sum_ += first * second;
      ++count_;
    }
  }
  [[nodiscard]] double mean() const {
    return count_ < kLeastProducts ? 0 : std::max(0.0, sum_ / count_);
  }

 private:
  std::vector<double> differences_;
  double sum_ = 0;
  int count_ = 0;
};

/// Interpolation between the pixels `first` and `first + 1` of `size`, at a place in (-1, size);
/// beyond the outermost pixels their values hold.
struct Between {
  Between(double place, long size)
      : first(std::clamp<long>(static_cast<long>(std::floor(place)), 0, size - 2)),
        weight(std::clamp(place - static_cast<double>(first), 0.0, 1.0)) {}
  long first;
  double weight;
};

/// Appends a pixel to the runs of its row.
void extend(std::vector<ChannelShift::Run>& runs, const ChannelShift::Run& pixel) {
  if (!runs.empty()) {
    ChannelShift::Run& last = runs.back();
    const bool continued = last.end == pixel.begin && last.row == pixel.row &&
                           last.column - last.begin == pixel.column - pixel.begin;
    if (continued) {
      last.end = pixel.end;
      return;
    }
  }
  runs.push_back(pixel);
}

}  // namespace

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
  const Plane zero = Plane::Zero(rows, columns);
  ChannelShift shift{std::vector<std::vector<ChannelShift::Run>>(static_cast<std::size_t>(rows)),
                     zero, zero, zero};
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      const long u = transposed ? row : column;
      const long v = transposed ? column : row;
      const Eigen::Vector2d ray = rays.col(v * camera.width + u) / alpha;
      Eigen::Vector2d place = geometry::distort(camera, ray);
      if (transposed) std::swap(place.x(), place.y());
      const bool inside = place.x() > -1 && place.y() > -1 &&
                          place.x() < static_cast<double>(columns) &&
                          place.y() < static_cast<double>(rows);
      if (!inside) continue;
      const Between x(place.x(), columns);
      const Between y(place.y(), rows);
      shift.right(row, column) = static_cast<float>(x.weight);
      shift.below(row, column) = static_cast<float>(y.weight);
      shift.turn(row, column) =
          static_cast<float>(carrier.along * (place.y() - static_cast<double>(row)));
      extend(shift.runs[static_cast<std::size_t>(row)], {column, column + 1, y.first, x.first});
    }
  }
  return shift;
}

ChannelModel channel_model(ChannelShift shift, const ChromaticLag& lag,
                           const Plane& expected_pixel) {
  Plane turn = expected_pixel * static_cast<float>(lag.slope) + static_cast<float>(lag.offset);
  if (!shift.none()) turn += shift.turn;
  return {std::move(shift), lag, turn.cos(), turn.sin()};
}

void combine_channels(const std::vector<Demodulated>& channels, const ChromaticModel& model,
                      Combined& out) {
  if (channels.size() == 1) {
    out = {channels[0].re, channels[0].im, {}};
    return;
  }
  for (Plane* plane : {&out.re, &out.im, &out.shares.red, &out.shares.blue})
    plane->resize(channels[0].re.rows(), channels[0].re.cols());
  const long columns = out.re.cols();
  const std::array<Plane*, 2> shares = {&out.shares.red, &out.shares.blue};
  SignalRow seen(columns);
  std::array<SignalRow, 2> added = {SignalRow(columns), SignalRow(columns)};
  for (long row = 0; row < out.re.rows(); ++row) {
    out.re.row(row) = channels[0].re.row(row);
    out.im.row(row) = channels[0].im.row(row);
    for (std::size_t i = 0; i < 2; ++i) {
      const ChannelModel& channel = model.channels[i];
      shifted_row(channels[i + 1], channel.shift, row, seen);
      add_turned(seen.re.data(), seen.im.data(), &channel.cosine(row, 0), &channel.sine(row, 0),
                 columns, added[i].re.data(), added[i].im.data(), &out.re(row, 0), &out.im(row, 0));
    }
    for (std::size_t i = 0; i < 2; ++i) {
      find_share(added[i].re.data(), added[i].im.data(), &out.re(row, 0), &out.im(row, 0), columns,
                 &(*shares[i])(row, 0));
    }
  }
}

ChromaticError remaining_error(const std::vector<Demodulated>& channels,
                               const ChromaticModel& model, const Plane& phase,
                               const PixelOfPhase& pixels) {
  if (channels.size() == 1) return {};
  const long step = std::max<long>(1, phase.size() / (kErrorSpacing * kErrorSamples));
  SignalRow seen(phase.cols());
  std::array<double, 2> error{};
  for (std::size_t i = 0; i < 2; ++i) {
    const ChannelModel& channel = model.channels[i];
    Disagreement found;
    for (long row = step / 2; row < phase.rows(); row += step) {
      shifted_row(channels[i + 1], channel.shift, row, seen);
      found.add_row({.green = {&channels[0].re(row, 0), &channels[0].im(row, 0)},
                     .channel = seen,
                     .turn = {&channel.cosine(row, 0), &channel.sine(row, 0)},
                     .phase = &phase(row, 0),
                     .expected = &model.expected_pixel(row, 0),
                     .row = row},
                    channel.lag, pixels);
    }
    error[i] = found.mean();
  }
  return {error[0], error[1]};
}

}  // namespace palpate::sensing
