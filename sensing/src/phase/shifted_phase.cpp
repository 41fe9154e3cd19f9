// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/shifted_phase.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace palpate::sensing {
namespace {

/// Least numbers of images for the second and for the third harmonic.
constexpr std::size_t kSecondHarmonic = 7;
constexpr std::size_t kThirdHarmonic = 10;
/// A harmonic is left out if the shifts determine it worse than this: least eigenvalue of the
/// normal matrix per image (1/2 for equal steps).
constexpr double kLeastEigenvalue = 0.05;
/// Approximate number of samples of the noise, per exposure and channel.
constexpr long kNoisePlaces = 8000;
/// Distance of two pixels without common noise, beyond the reach of demosaicing [px].
constexpr long kIndependentPixels = 4;

/// One row per image: 1, cos, -sin of the shift and of its multiples.
Eigen::MatrixXd design_matrix(const std::vector<double>& shifts, int harmonics) {
  Eigen::MatrixXd design(static_cast<Eigen::Index>(shifts.size()), 1 + 2 * harmonics);
  for (Eigen::Index k = 0; k < design.rows(); ++k) {
    design(k, 0) = 1;
    for (int h = 1; h <= harmonics; ++h) {
      design(k, 2 * h - 1) = std::cos(h * shifts[static_cast<std::size_t>(k)]);
      design(k, 2 * h) = -std::sin(h * shifts[static_cast<std::size_t>(k)]);
    }
  }
  return design;
}

/// The values of one row of the images in one channel: images x columns.
using ShotValues = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Results of one row in one channel.
struct ShiftedRowFit {
  ShotValues estimate;   ///< 3 x columns
  ShotValues remainder;  ///< images x columns
};

template <typename T>
void take_values(std::span<const cv::Mat> images, int row, int channel, float scale,
                 ShotValues& values) {
  for (std::size_t k = 0; k < images.size(); ++k) {
    const T* const pixels = images[k].ptr<T>(row);
    const int step = images[k].channels();
    float* const out = &values(static_cast<Eigen::Index>(k), 0);
    for (int column = 0; column < images[k].cols; ++column)
      out[column] = scale * static_cast<float>(pixels[column * step + channel]);
  }
}

void take_values(std::span<const cv::Mat> images, int row, int channel, ShotValues& values) {
  if (images[0].depth() == CV_8U) {
    take_values<std::uint8_t>(images, row, channel, 1.0F / 255, values);
  } else {
    take_values<std::uint16_t>(images, row, channel, 1.0F / 65535, values);
  }
}

/// Products of a matrix of coefficients with each column of the values.
void apply_fit(const Eigen::MatrixXf& coefficients, const ShotValues& values, ShotValues& out) {
  for (Eigen::Index i = 0; i < coefficients.rows(); ++i) {
    auto sum = out.row(i);
    sum = coefficients(i, 0) * values.row(0);
    for (Eigen::Index k = 1; k < coefficients.cols(); ++k)
      sum += coefficients(i, k) * values.row(k);
  }
}

/// Channel of a BGR image for a plane: green first, then red and blue.
int channel_of_plane(std::size_t plane, int channels) {
  constexpr int kOrder[] = {1, 2, 0};
  return channels == 1 ? 0 : kOrder[plane];
}

void start_sums(const cv::Mat& image, ShiftedImages& sums) {
  const auto zero = [&] { return Plane(Plane::Zero(image.rows, image.cols)); };
  for (int channel = 0; channel < image.channels(); ++channel)
    sums.channels.push_back({.mean = zero(), .re = zero(), .im = zero(), .count = zero()});
  sums.remainder = zero();
  sums.signal = zero();
  sums.samples.resize(sums.channels.size());
}

/// A row's remainders, and amplitudes that are 0 where the remainder does not count.
struct JudgedRow {
  ShotValues remainder;
  Eigen::ArrayXf amplitude;
};

/// Sums the products of remainders, and of amplitudes, of a row and the same row, or another one,
/// from a column on.
void add_products(const JudgedRow& row, const JudgedRow& other, Eigen::Index from, int freedom,
                  ShiftedImages& sums) {
  const Eigen::Index pairs = row.amplitude.size() - from;
  if (pairs <= 0) return;
  const Eigen::ArrayXf power = row.amplitude.head(pairs) * other.amplitude.tail(pairs);
  Eigen::ArrayXf products = Eigen::ArrayXf::Zero(pairs);
  for (Eigen::Index k = 0; k < row.remainder.rows(); ++k) {
    products += row.remainder.row(k).head(pairs).transpose() *
                other.remainder.row(k).tail(pairs).transpose();
  }
  sums.shared += (power > 0).select(products, 0.0F).cast<double>().sum() / freedom;
  sums.power += power.cast<double>().sum();
}

}  // namespace

ShiftFit make_shift_fit(const std::vector<double>& shifts) {
  int harmonics = shifts.size() >= kThirdHarmonic ? 3 : shifts.size() >= kSecondHarmonic ? 2 : 1;
  const auto count = static_cast<double>(shifts.size());
  const auto least = [&] {
    const Eigen::MatrixXd design = design_matrix(shifts, harmonics);
    const Eigen::MatrixXd normal = design.transpose() * design / count;
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(normal).eigenvalues()[0];
  };
  while (harmonics > 1 && least() < kLeastEigenvalue) --harmonics;
  const Eigen::MatrixXd design = design_matrix(shifts, harmonics);
  const Eigen::MatrixXd inverse = design.completeOrthogonalDecomposition().pseudoInverse();
  const auto images = static_cast<Eigen::Index>(shifts.size());
  return {.estimate = inverse.topRows(3).cast<float>(),
          .remainder = (Eigen::MatrixXd::Identity(images, images) - design * inverse).cast<float>(),
          .spread = inverse.middleRows(1, 2) * inverse.middleRows(1, 2).transpose(),
          .freedom = static_cast<int>(images - design.cols())};
}

std::vector<Mask> clipped_places(std::span<const cv::Mat> images) {
  cv::Mat brightest = images[0].clone();
  for (const cv::Mat& image : images.subspan(1)) cv::max(brightest, image, brightest);
  std::vector<Mask> clipped;
  for (int plane = 0; plane < brightest.channels(); ++plane) {
    cv::Mat channel;
    cv::extractChannel(brightest, channel,
                       channel_of_plane(static_cast<std::size_t>(plane), brightest.channels()));
    cv::Mat at_top = channel >= full_scale(brightest);
    if (brightest.channels() == 3) cv::dilate(at_top, at_top, cv::Mat());
    Mask mask(at_top.rows, at_top.cols);
    for (int row = 0; row < at_top.rows; ++row) {
      std::transform(at_top.ptr(row), at_top.ptr(row) + at_top.cols, &mask(row, 0),
                     [](std::uint8_t value) { return value != 0 ? 1 : 0; });
    }
    clipped.push_back(std::move(mask));
  }
  return clipped;
}

void add_exposure(std::span<const cv::Mat> images, const ShiftFit& fit, float least_amplitude,
                  bool varies_along_rows, ShiftedImages& sums) {
  const cv::Mat& first = images[0];
  if (sums.channels.empty()) start_sums(first, sums);
  sums.clipped.push_back(clipped_places(images));
  const std::vector<Mask>& clipped = sums.clipped.back();
  ShotValues values(fit.images(), first.cols);
  ShiftedRowFit fitted{ShotValues(3, first.cols), ShotValues(fit.images(), first.cols)};
  const long spacing = std::max<long>(1, static_cast<long>(first.total()) / kNoisePlaces);
  for (std::size_t c = 0; c < sums.channels.size(); ++c) {
    ShiftedChannel& channel = sums.channels[c];
    long until_sample = spacing / 2;
    std::array<JudgedRow, kIndependentPixels> above;
    for (int row = 0; row < first.rows; ++row) {
      take_values(images, row, channel_of_plane(c, first.channels()), values);
      apply_fit(fit.estimate, values, fitted.estimate);
      apply_fit(fit.remainder, values, fitted.remainder);
      const Eigen::ArrayXf used = 1.0F - clipped[c].row(row).cast<float>().transpose();
      const Eigen::ArrayXf all =
          (fitted.estimate.row(1).square() + fitted.estimate.row(2).square()).sqrt().transpose();
      sums.signal.row(row) = sums.signal.row(row).max(all.transpose());
      channel.count.row(row) += used.transpose();
      channel.mean.row(row) += used.transpose() * fitted.estimate.row(0);
      channel.re.row(row) += used.transpose() * fitted.estimate.row(1);
      channel.im.row(row) += used.transpose() * fitted.estimate.row(2);
      if (fit.freedom == 0) continue;
      const Eigen::ArrayXf squares =
          fitted.remainder.square().colwise().sum().transpose() / static_cast<float>(fit.freedom);
      sums.remainder.row(row) += (used * squares).transpose();
      const Eigen::ArrayXf amplitude =
          (all >= least_amplitude).select(used * all, Eigen::ArrayXf::Zero(all.size()));
      const JudgedRow judged{fitted.remainder, amplitude};
      JudgedRow& earlier = above[static_cast<std::size_t>(row) % above.size()];
      if (!varies_along_rows) {
        add_products(judged, judged, kIndependentPixels, fit.freedom, sums);
      } else if (row >= kIndependentPixels) {
        add_products(judged, earlier, 0, fit.freedom, sums);
      }
      earlier = judged;
      for (; until_sample < first.cols; until_sample += spacing) {
        if (!(amplitude[until_sample] > 0)) continue;
        sums.samples[c].push_back({fitted.estimate(0, until_sample), squares[until_sample]});
      }
      until_sample -= first.cols;
    }
  }
}

}  // namespace palpate::sensing
