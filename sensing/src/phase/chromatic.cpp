// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/chromatic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "image/hot_loop.h"
#include "palpate/core/quantile.h"

namespace palpate::sensing {
namespace {

/// Adds a channel, rotated by the angle of `cosine` and `sine`, to the sum, and stores the rotated
/// channel.
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

/// Weight of the second of two pixels for a place `shift` px to the right of a pixel.
[[gnu::always_inline]] inline float weight_of(float shift, float first) {
  const float weight = shift - first;
  const float positive = weight > 0 ? weight : 0;
  return positive < 1 ? positive : 1;
}

/// Offset of the upper left of four pixels, to the right and down.
struct FirstOfFour {
  float right;
  float down;
};

PALPATE_HOT_LOOP void interpolate(const float* above, const float* below_it, const float* right,
                                  const float* down, FirstOfFour first, long columns,
                                  float* __restrict out) {
  for (long i = 0; i < columns; ++i) {
    const float right_weight = weight_of(right[i], first.right);
    const float upper = above[i] + right_weight * (above[i + 1] - above[i]);
    const float lower = below_it[i] + right_weight * (below_it[i + 1] - below_it[i]);
    out[i] = upper + weight_of(down[i], first.down) * (lower - upper);
  }
}

/// Interpolates between the nodes.
PALPATE_HOT_LOOP void fill_row(const float* nodes, long columns, float* __restrict out) {
  for (long first = 0; first < columns; first += kNodeSpacing, ++nodes) {
    const float slope = (nodes[1] - nodes[0]) / kNodeSpacing;
    const long count = columns - first < kNodeSpacing ? columns - first : kNodeSpacing;
    for (int i = 0; i < count; ++i) out[first + i] = nodes[0] + slope * static_cast<float>(i);
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

/// One row of a model and of the channel at the places where green sees it, without carrier and
/// lag.
struct ShiftedRow {
  explicit ShiftedRow(long columns)
      : signal(columns), cosine(columns), sine(columns), right_(columns), down_(columns) {}

  void find(const Demodulated& channel, const ChannelModel& model, long row) {
    fill_row(&model.cosine(row, 0), cosine.size(), cosine.data());
    fill_row(&model.sine(row, 0), sine.size(), sine.data());
    if (model.shift.none()) {
      signal.re = channel.re.row(row);
      signal.im = channel.im.row(row);
      return;
    }
    fill_row(&model.shift.right(row, 0), right_.size(), right_.data());
    fill_row(&model.shift.down(row, 0), down_.size(), down_.data());
    signal.re.setZero();
    signal.im.setZero();
    for (const ChannelShift::Run& run : model.shift.runs[static_cast<std::size_t>(row)]) {
      const FirstOfFour first{static_cast<float>(run.column - run.begin),
                              static_cast<float>(run.row - row)};
      const float* right = &right_[run.begin];
      const float* down = &down_[run.begin];
      const long length = run.end - run.begin;
      interpolate(&channel.re(run.row, run.column), &channel.re(run.row + 1, run.column), right,
                  down, first, length, &signal.re[run.begin]);
      interpolate(&channel.im(run.row, run.column), &channel.im(run.row + 1, run.column), right,
                  down, first, length, &signal.im[run.begin]);
    }
  }

  SignalRow signal;
  Eigen::ArrayXf cosine;
  Eigen::ArrayXf sine;

 private:
  Eigen::ArrayXf right_;
  Eigen::ArrayXf down_;
};

/// Approximate number of pixels for estimating the chromatic error: every kErrorSpacing-th [px] of
/// evenly spaced rows, the reach of the averaging along the rows.
constexpr long kErrorSamples = 4000;
constexpr long kErrorSpacing = 5;
/// At twice this distance the noise of two pixels is independent.
constexpr std::size_t kIndependent = 2;
/// A channel is used if its squared modulation relative to green's is between this and its
/// inverse.
constexpr float kLeastRatio = 0.3F;
/// Larger differences come from steps of the depth, not from lenses [rad].
constexpr double kLargestDifference = 0.5;
/// Smallest number of products for a mean.
constexpr std::size_t kLeastProducts = 100;
/// Products beyond this number of medians are cut there; edges of print and stripes have such.
constexpr double kLargestProduct = 10;
/// The part that the cut leaves of the mean square of normal deviates, 3 % of which are beyond.
constexpr double kCutMean = 0.942;

struct Phasors {
  const float* re;
  const float* im;
};

/// One row of the input of `remaining_error`.
struct ComparedRow {
  Phasors green;
  const SignalRow& channel;
  Phasors turn;
  const float* phase;     ///< absolute
  const float* expected;  ///< projector pixel for which the lag was applied
  long row;
};

/// Phase of a channel minus that of green at a pixel; NaN where they cannot be compared.
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

/// The mean product of differences; without the excess of the largest where texture disturbs.
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
      products_.push_back(first * second);
    }
  }
  [[nodiscard]] double mean(PhaseTexture texture) const {
    if (products_.size() < kLeastProducts) return 0;
    const bool cut = texture == PhaseTexture::disturbs;
    const double largest = cut ? kLargestProduct * std::max(0.0, median(products_))
                               : std::numeric_limits<double>::infinity();
    double sum = 0;
    for (const double product : products_) sum += std::clamp(product, -largest, largest);
    return std::max(0.0, sum / ((cut ? kCutMean : 1) * static_cast<double>(products_.size())));
  }

 private:
  std::vector<double> differences_;
  std::vector<double> products_;
};

/// The first of the two of `size` pixels around a place in (-1, size).
long first_of_two(double place, long size) {
  return std::clamp<long>(static_cast<long>(std::floor(place)), 0, size - 2);
}

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

static_assert(kPartSpacing % kNodeSpacing == 0, "the nodes of a part are nodes of the image");

Nodes nodes_in(const Nodes& nodes, const ImagePart& part) {
  const long count = (part.columns - 1 + kNodeSpacing - 1) / kNodeSpacing + 2;
  return nodes.block(part.row, part.column / kNodeSpacing, part.rows, count);
}

/// The runs of a row of a part.
std::vector<ChannelShift::Run> runs_in(const std::vector<ChannelShift::Run>& runs,
                                       const ImagePart& part) {
  std::vector<ChannelShift::Run> inside;
  for (ChannelShift::Run run : runs) {
    run.row -= part.row;
    if (run.row < 0 || run.row + 1 >= part.rows) continue;
    const long right = run.column - run.begin;  // of the four pixels
    run.begin = std::max({run.begin - part.column, 0L, -right});
    run.end = std::min({run.end - part.column, part.columns, part.columns - 1 - right});
    run.column = run.begin + right;
    if (run.begin < run.end) inside.push_back(run);
  }
  return inside;
}

ChannelModel part_of(const ChannelModel& model, const ImagePart& part) {
  ChannelModel inside{.shift = {},
                      .lag = model.lag,
                      .cosine = nodes_in(model.cosine, part),
                      .sine = nodes_in(model.sine, part)};
  if (model.shift.none()) return inside;
  inside.shift.right = nodes_in(model.shift.right, part);
  inside.shift.down = nodes_in(model.shift.down, part);
  for (long row = part.row; row < part.row + part.rows; ++row)
    inside.shift.runs.push_back(runs_in(model.shift.runs[static_cast<std::size_t>(row)], part));
  return inside;
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

Nodes nodes_of(const Plane& smooth) {
  const long last = smooth.cols() - 1;
  Nodes nodes(smooth.rows(), (last + kNodeSpacing - 1) / kNodeSpacing + 2);
  for (long i = 0; i < nodes.cols(); ++i) {
    const long column = i * kNodeSpacing;
    nodes.col(i) = smooth.col(std::min(column, last));
    if (column > last && last > 0) {
      nodes.col(i) += static_cast<float>(column - last) * (smooth.col(last) - smooth.col(last - 1));
    }
  }
  return nodes;
}

ChannelShift channel_shift(const geometry::Camera& camera, double alpha,
                           const Eigen::Matrix2Xd& rays, const Carrier& carrier) {
  const bool transposed = carrier.transposed;
  if (alpha == 1 || camera.width < 2 || camera.height < 2) return {};
  const long rows = transposed ? camera.width : camera.height;
  const long columns = transposed ? camera.height : camera.width;
  Plane right(rows, columns);
  Plane down(rows, columns);
  std::vector<std::vector<ChannelShift::Run>> runs(static_cast<std::size_t>(rows));
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      const long u = transposed ? row : column;
      const long v = transposed ? column : row;
      const Eigen::Vector2d ray = rays.col(v * camera.width + u) / alpha;
      Eigen::Vector2d place = geometry::distort(camera, ray);
      if (transposed) std::swap(place.x(), place.y());
      right(row, column) = static_cast<float>(place.x() - static_cast<double>(column));
      down(row, column) = static_cast<float>(place.y() - static_cast<double>(row));
      const bool inside = place.x() > -1 && place.y() > -1 &&
                          place.x() < static_cast<double>(columns) &&
                          place.y() < static_cast<double>(rows);
      if (!inside) continue;
      extend(runs[static_cast<std::size_t>(row)],
             {column, column + 1, first_of_two(place.y(), rows), first_of_two(place.x(), columns)});
    }
  }
  return {std::move(runs), nodes_of(right), nodes_of(down),
          static_cast<float>(carrier.along) * down};
}

ChannelModel channel_model(ChannelShift shift, const ChromaticLag& lag,
                           const Plane& expected_pixel) {
  Plane turn = expected_pixel * static_cast<float>(lag.slope) + static_cast<float>(lag.offset);
  if (!shift.none()) turn += shift.turn;
  return {std::move(shift), lag, nodes_of(turn.cos()), nodes_of(turn.sin())};
}

ChromaticModel part_of(const ChromaticModel& model, const ImagePart& part) {
  return {part_of(model.expected_pixel, part),
          {part_of(model.channels[0], part), part_of(model.channels[1], part)}};
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
  ShiftedRow seen(columns);
  std::array<SignalRow, 2> added = {SignalRow(columns), SignalRow(columns)};
  for (long row = 0; row < out.re.rows(); ++row) {
    out.re.row(row) = channels[0].re.row(row);
    out.im.row(row) = channels[0].im.row(row);
    for (std::size_t i = 0; i < 2; ++i) {
      seen.find(channels[i + 1], model.channels[i], row);
      add_turned(seen.signal.re.data(), seen.signal.im.data(), seen.cosine.data(), seen.sine.data(),
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
                               const PixelOfPhase& pixels, PhaseTexture texture) {
  if (channels.size() == 1) return {};
  const long step = std::max<long>(1, phase.size() / (kErrorSpacing * kErrorSamples));
  ShiftedRow seen(phase.cols());
  std::array<double, 2> error{};
  for (std::size_t i = 0; i < 2; ++i) {
    const ChannelModel& channel = model.channels[i];
    Disagreement found;
    for (long row = step / 2; row < phase.rows(); row += step) {
      seen.find(channels[i + 1], channel, row);
      found.add_row({.green = {&channels[0].re(row, 0), &channels[0].im(row, 0)},
                     .channel = seen.signal,
                     .turn = {seen.cosine.data(), seen.sine.data()},
                     .phase = &phase(row, 0),
                     .expected = &model.expected_pixel(row, 0),
                     .row = row},
                    channel.lag, pixels);
    }
    error[i] = found.mean(texture);
  }
  return {error[0], error[1]};
}

}  // namespace palpate::sensing
