// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/harmonics.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

#include "image/image_plane.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "setup/triangulation.h"

namespace palpate::sensing {
namespace {

/// Columns of the fit: mean, slope, fundamental (also with growing amplitude, which absorbs a
/// frequency error), then two for each harmonic from the second on.
enum Column { kMean, kSlope, kCosine, kSine, kGrowingCosine, kGrowingSine, kHarmonics };

/// Smallest period of a harmonic in pixels at which it can be measured (Nyquist with a margin).
constexpr double kLeastHarmonicPeriod = 2.2;
/// The second and the third.
constexpr int kLastHarmonic = 3;
constexpr double kWindowPeriods = 3;
/// Local frequencies are searched around the image's frequency within this factor, in this many
/// steps.
constexpr double kFrequencyRange = 1.35;
constexpr int kFrequencies = 41;
/// Smallest number of periods in a line.
constexpr int kLeastPeriods = 4;
/// Smallest number of windows for an average, and number of groups for its deviation.
constexpr std::size_t kLeastPlaces = 160;
constexpr std::size_t kWindowGroups = 16;
/// A harmonic is reported if this share of the windows measures it; fewer do if their period is
/// unusual, as at depth steps.
constexpr double kLeastMeasuredShare = 0.2;
/// A harmonic exists if it is this many standard deviations.
constexpr double kSignificance = 4;

cv::Mat_<float> brightest_channel(const cv::Mat& frame) {
  const cv::Scalar means = cv::mean(frame);
  int best = 0;
  for (int i = 1; i < frame.channels(); ++i)
    if (means[i] > means[best]) best = i;
  cv::Mat plane;
  cv::extractChannel(frame, plane, best);
  plane.convertTo(plane, CV_32F, 1 / full_scale(frame));
  return plane;
}

/// Dominant frequency along the rows, and its significance.
struct Peak {
  double frequency = 0;  ///< cycles/px
  double share = 0;      ///< of the power above the lowest frequencies
};
Peak find_peak(const cv::Mat_<float>& image) {
  const int length = image.cols;
  if (length < 4 * kLeastPeriods) return {};
  cv::Mat_<float> rows = image.clone();
  for (int y = 0; y < rows.rows; ++y) {
    const auto mean = static_cast<float>(cv::mean(rows.row(y))[0]);
    for (int x = 0; x < length; ++x) {
      const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (x + 0.5) / length);
      rows(y, x) = (rows(y, x) - mean) * static_cast<float>(window);
    }
  }
  cv::Mat_<cv::Vec2f> spectrum;
  cv::dft(rows, spectrum, cv::DFT_ROWS | cv::DFT_COMPLEX_OUTPUT);
  const int highest = static_cast<int>(length / (2 * kLeastHarmonicPeriod));
  std::vector<double> power(static_cast<std::size_t>(highest) + 1, 0);
  double total = 0;
  for (int k = kLeastPeriods; k <= highest; ++k) {
    for (int y = 0; y < rows.rows; ++y) {
      const cv::Vec2f& value = spectrum(y, k);
      // Multiply by the squared frequency, because the spectra of surfaces fall with the frequency.
      power[static_cast<std::size_t>(k)] += static_cast<double>(value.dot(value)) * k * k;
    }
    total += power[static_cast<std::size_t>(k)];
  }
  const auto largest = std::max_element(power.begin(), power.end());
  const auto at = static_cast<int>(largest - power.begin());
  if (!(total > 0)) return {};
  double near = 0;
  for (int k = 0; k <= highest; ++k)
    if (std::abs(k - at) <= std::max(2, at / 5)) near += power[static_cast<std::size_t>(k)];
  return {static_cast<double>(at) / length, near / total};
}

/// Returns true if a frequency [cycles/px] has enough pixels per period for a harmonic.
bool is_resolved(int harmonic, double frequency) {
  return harmonic * frequency * kLeastHarmonicPeriod <= 1;
}

/// Returns true if a harmonic can be separated from the alias that a colour mosaic makes of the
/// sinusoid, at half the sampling frequency minus its own. If both coincide (the second harmonic at
/// 6 px, the third at 8 px) their phases are locked too, so averaging does not separate them. A
/// window separates frequencies that differ by one period over its length.
bool is_told_from_mosaic(int harmonic, double frequency, int length) {
  return std::abs(0.5 - frequency - harmonic * frequency) * length >= 1;
}

/// Orthonormal columns and their triangle, for one frequency.
struct Basis {
  double frequency = 0;
  Eigen::MatrixXd columns;   ///< length x columns
  Eigen::MatrixXd triangle;  ///< columns x columns
};
std::vector<Basis> make_bases(double frequency, int length) {
  std::vector<Basis> bases;
  for (int i = 0; i < kFrequencies; ++i) {
    Basis basis{frequency * std::pow(kFrequencyRange, 2.0 * i / (kFrequencies - 1) - 1), {}, {}};
    int last = 1;
    while (last < kLastHarmonic && is_resolved(last + 1, basis.frequency)) ++last;
    const int columns = kHarmonics + 2 * (last - 1);
    Eigen::MatrixXd model(length, columns);
    for (int row = 0; row < length; ++row) {
      const double t = row - (length - 1) / 2.0;
      const double angle = 2 * std::numbers::pi * basis.frequency * t;
      const double grow = 2 * t / length;
      model(row, kMean) = 1;
      model(row, kSlope) = grow;
      model(row, kCosine) = std::cos(angle);
      model(row, kSine) = std::sin(angle);
      model(row, kGrowingCosine) = grow * std::cos(angle);
      model(row, kGrowingSine) = grow * std::sin(angle);
      for (int harmonic = 2; harmonic <= last; ++harmonic) {
        model(row, kHarmonics + 2 * (harmonic - 2)) = std::cos(harmonic * angle);
        model(row, kHarmonics + 2 * (harmonic - 2) + 1) = std::sin(harmonic * angle);
      }
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(model);
    basis.columns = qr.householderQ() * Eigen::MatrixXd::Identity(length, columns);
    basis.triangle = qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
    bases.push_back(std::move(basis));
  }
  return bases;
}

/// Result of one window.
struct Place {
  double frequency = 0;
  double modulation = 0;
  /// Second and third harmonic in phase with the fundamental, relative to it; NaN if it cannot be
  /// measured.
  std::array<double, kLastHarmonic - 1> harmonics{};
};

/// Fits one window; false if it shows no clear sinusoid.
bool fit_window(const Eigen::VectorXd& values, const std::vector<Basis>& bases,
                const HarmonicOptions& options, Place& place) {
  // Choose the frequency with mean, slope and fundamental alone; other signals, such as the alias
  // of a colour mosaic, would pull it to where a harmonic fits them.
  constexpr int kPlain = kSine + 1;
  const Basis* best = nullptr;
  double most = -1;
  for (const Basis& basis : bases) {
    const double explained = (basis.columns.leftCols<kPlain>().transpose() * values).squaredNorm();
    if (!(explained > most)) continue;
    best = &basis;
    most = explained;
  }
  // At the end of the range, this is not the frequency of the sinusoid.
  if (best == nullptr || best == &bases.front() || best == &bases.back()) return false;
  const Eigen::VectorXd projection = best->columns.transpose() * values;
  const Eigen::VectorXd c = best->triangle.triangularView<Eigen::Upper>().solve(projection);
  const auto wave = [&](int column) { return std::complex<double>(c[column], -c[column + 1]); };
  const double amplitude = std::abs(wave(kCosine));
  const double left = std::max(values.squaredNorm() - projection.squaredNorm(), 0.0);
  const double misfit = std::sqrt(left / static_cast<double>(values.size()));
  if (!(amplitude >= options.min_modulation) || !(misfit <= options.max_misfit * amplitude))
    return false;
  const std::complex<double> back = std::conj(wave(kCosine)) / amplitude;
  place.frequency = best->frequency;
  place.modulation = amplitude / c[kMean];
  const auto length = static_cast<int>(values.size());
  std::complex<double> turn = back;
  for (int harmonic = 2; harmonic <= kLastHarmonic; ++harmonic) {
    const int column = kHarmonics + 2 * (harmonic - 2);
    turn *= back;
    place.harmonics.at(static_cast<std::size_t>(harmonic) - 2) =
        column < c.size() && is_told_from_mosaic(harmonic, place.frequency, length)
            ? (wave(column) * turn).real() / amplitude
            : std::numeric_limits<double>::quiet_NaN();
  }
  return true;
}

std::vector<Place> fit_windows(const cv::Mat_<float>& image, const std::vector<Basis>& bases,
                               const HarmonicOptions& options) {
  const auto length = static_cast<int>(bases[0].columns.rows());
  const int step = std::max(1, length / 2);
  const int line_step = std::max(1, length / 12);
  std::vector<Place> places;
  Eigen::VectorXd values(length);
  for (int y = 0; y < image.rows; y += line_step) {
    for (int x = 0; x + length <= image.cols; x += step) {
      for (int i = 0; i < length; ++i) values[i] = static_cast<double>(image(y, x + i));
      Place place;
      // Clipping causes harmonics of its own.
      if (values.maxCoeff() < 1 && fit_window(values, bases, options, place))
        places.push_back(place);
    }
  }
  return places;
}

std::vector<double> collect(const std::vector<Place>& places, double Place::*field) {
  std::vector<double> values;
  values.reserve(places.size());
  for (const Place& place : places) values.push_back(place.*field);
  return values;
}

/// Median, and its standard deviation from the medians of groups of neighbouring windows, which
/// share local errors of the image.
std::optional<Harmonic> summarize(const std::vector<Place>& places, int order) {
  std::vector<double> values;
  for (const Place& place : places) {
    const double value = place.harmonics.at(static_cast<std::size_t>(order) - 2);
    if (std::isfinite(value)) values.push_back(value);
  }
  const double least = kLeastMeasuredShare * static_cast<double>(places.size());
  if (values.size() < kLeastPlaces || static_cast<double>(values.size()) < least) return {};
  Harmonic harmonic{.ratio = median(values)};
  double squares = 0;
  for (std::size_t group = 0; group < kWindowGroups; ++group) {
    const std::size_t begin = values.size() * group / kWindowGroups;
    const std::size_t end = values.size() * (group + 1) / kWindowGroups;
    const double part = median(std::span(values).subspan(begin, end - begin));
    squares += (part - harmonic.ratio) * (part - harmonic.ratio);
  }
  harmonic.deviation =
      std::sqrt(squares / (kWindowGroups - 1)) / std::sqrt(static_cast<double>(kWindowGroups));
  return harmonic;
}

/// Spectrum of a Hann window of this many px, 1 at frequency 0.
double hann_spectrum(double frequency, double length) {
  constexpr double kNearLimit = 1e-9;  // of x, where the formula is 0 / 0 and this its limit
  const double x = frequency * length;
  if (std::abs(x) < kNearLimit) return 1;
  if (std::abs(std::abs(x) - 1) < kNearLimit) return 0.5;
  return std::sin(std::numbers::pi * x) / (std::numbers::pi * x * (1 - x * x));
}

/// RMS over the places: the harmonic k of a frequency f is at k f - carrier from the carrier.
double phase_wave(const HarmonicCheck& check, const std::vector<Place>& places) {
  const double carrier = 1 / check.period;
  const double length = 2 * check.period;
  double sum = 0;
  for (const Place& place : places) {
    const double passed = hann_spectrum(place.frequency - carrier, length);
    const double second = check.second.value_or(Harmonic{}).ratio *
                          hann_spectrum(2 * place.frequency - carrier, length);
    const double third = check.third.value_or(Harmonic{}).ratio *
                         hann_spectrum(3 * place.frequency - carrier, length);
    sum += (second * second + third * third) / (2 * passed * passed);
  }
  return std::sqrt(sum / static_cast<double>(places.size()));
}

void check_input(const cv::Mat& frame, const HarmonicOptions& options) {
  if (!is_frame(frame)) {
    throw InvalidInput("check_harmonics: a frame of 8 or 16 bit with 1 or 3 channels is expected");
  }
  require("HarmonicOptions::min_modulation", options.min_modulation, above(0).below(1));
  require("HarmonicOptions::max_misfit", options.max_misfit, above(0));
  require("HarmonicOptions::max_ratio", options.max_ratio, above(0).below(1));
}

}  // namespace

HarmonicCheck check_harmonics(const cv::Mat& frame, const HarmonicOptions& options) {
  check_input(frame, options);
  cv::Mat_<float> image = brightest_channel(frame);
  cv::Mat_<float> transposed;
  cv::transpose(image, transposed);
  const Peak along_rows = find_peak(image);
  const Peak along_columns = find_peak(transposed);
  HarmonicCheck check;
  check.along_x = along_rows.share > along_columns.share;
  const double frequency = check.along_x ? along_rows.frequency : along_columns.frequency;
  if (!check.along_x) image = transposed;
  std::vector<Place> places;
  if (frequency > 0 && is_resolved(2, frequency)) {
    const int length = static_cast<int>(std::lround(kWindowPeriods / frequency));
    places = fit_windows(image, make_bases(frequency, length), options);
  }
  if (places.size() < kLeastPlaces) {
    throw InvalidInput(
        "check_harmonics: only " + std::to_string(places.size()) +
        " places show a sinusoid that is not clipped; pass an image of the white sinusoid on a "
        "bright surface, its period " +
        std::to_string(2 * kLeastHarmonicPeriod) + " px or more");
  }
  check.places = static_cast<long>(places.size());
  check.period = 1 / median(collect(places, &Place::frequency));
  check.modulation = median(collect(places, &Place::modulation));
  check.second = summarize(places, 2);
  check.third = summarize(places, 3);
  if (!check.second && !check.third) {
    throw InvalidInput("check_harmonics: at a period of " + std::to_string(check.period) +
                       " px what a colour mosaic leaves of the sinusoid lies on the harmonics; "
                       "pass an image with another period, best of 10 px or more");
  }
  check.phase_wave = phase_wave(check, places);
  const auto is_there = [&](const std::optional<Harmonic>& harmonic) {
    return harmonic && std::abs(harmonic->ratio) >=
                           std::max(options.max_ratio, kSignificance * harmonic->deviation);
  };
  check.distorted = is_there(check.second) || is_there(check.third);
  return check;
}

double depth_per_radian(const Rig& rig, const Pattern& pattern, double z) {
  check_rig(rig, "depth_per_radian: rig");
  check_pattern(pattern, "depth_per_radian: pattern");
  require("depth_per_radian(): z", z, above(0).finite(), "mm");
  const Triangulation triangulation(rig);
  const Eigen::Vector2d middle((rig.camera.width - 1) / 2.0, (rig.camera.height - 1) / 2.0);
  const Eigen::Vector3d ray = triangulation.direction(geometry::undistort(rig.camera, middle));
  const double slope = std::abs(triangulation.slope(ray, pattern.axis, z));
  if (!(slope > 0))
    throw InvalidInput("depth_per_radian: at this depth the phase does not change with the depth");
  return pattern.period / (2 * std::numbers::pi * slope);
}

}  // namespace palpate::sensing
