// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "carrier.h"
#include "chromatic.h"
#include "demodulation.h"
#include "hue.h"
#include "hue_classifier.h"
#include "palpate/error.h"
#include "phase_offset.h"
#include "phase_variance.h"
#include "planes.h"
#include "stripe_transitions.h"
#include "triangulation.h"
#include "unwrapping.h"

namespace palpate::sensing {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kTurn = 2 * std::numbers::pi;

void check_options(const DecodeOptions& options) {
  const auto require = [](bool good, const char* name, const char* range) {
    if (!good) throw InvalidInput(std::string("DecodeOptions: ") + name + " must lie in " + range);
  };
  const auto fraction = [](double value) { return value > 0 && value < 1; };
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  require(fraction(options.min_signal), "min_signal", "(0, 1)");
  require(fraction(options.min_modulation), "min_modulation", "(0, 1)");
  require(fraction(options.min_contrast), "min_contrast", "(0, 1)");
  require(options.min_hue_step > 0 && options.min_hue_step < std::numbers::pi, "min_hue_step",
          "(0, pi)");
  require(options.color_window_px >= 1, "color_window_px", "[1, infinity)");
  require(fraction(options.min_color_score), "min_color_score", "(0, 1)");
  require(positive(options.max_phase_variance), "max_phase_variance", "(0, infinity)");
  require(options.min_agreement > 0.5 && options.min_agreement <= 1, "min_agreement", "(0.5, 1]");
  require(positive(options.max_sensitivity), "max_sensitivity", "(0, infinity)");
}

void check_anchor(const Anchor& anchor, const geometry::Camera& camera) {
  const bool inside = anchor.u_px > -0.5 && anchor.u_px < camera.width - 0.5 &&
                      anchor.v_px > -0.5 && anchor.v_px < camera.height - 0.5;
  if (!inside || !(anchor.z > 0) || !std::isfinite(anchor.z)) {
    throw InvalidInput("anchor " + std::to_string(anchor.u_px) + ", " +
                       std::to_string(anchor.v_px) + ", " + std::to_string(anchor.z) +
                       ": a pixel of the " + std::to_string(camera.width) + " x " +
                       std::to_string(camera.height) + " image and a depth > 0 are expected");
  }
}

}  // namespace

struct Decoder::Impl {
  Impl(const Rig& the_rig, const Pattern& the_pattern, const TrainedColors& colors,
       const DecodeOptions& the_options);

  /// The sinusoid of all channels, compensated and added; the share of each in its direction.
  struct Combined {
    Plane re;
    Plane im;
    Plane red_share;  ///< Re(red conj(sum)) / |sum|^2
    Plane blue_share;
  };

  [[nodiscard]] Combined combine(std::vector<Demodulated>& channels) const;
  [[nodiscard]] Mask find_modulated(const Combined& combined,
                                    const std::vector<Demodulated>& channels,
                                    const Mask& lit) const;
  [[nodiscard]] Plane hue_plane(const std::vector<Demodulated>& channels) const;
  [[nodiscard]] std::vector<PhaseGuess> guesses(const std::vector<Transition>& transitions) const;
  [[nodiscard]] PhaseGuess anchor_guess() const;
  [[nodiscard]] float depth_at(long row, long column, double phase, const Combined& combined) const;
  [[nodiscard]] DecodeResult decode(const cv::Mat& frame) const;

  [[nodiscard]] Eigen::Vector3d direction(long row, long column) const {
    return directions.col(row * columns + column);
  }
  /// Absolute phase, the carrier taken out, of a projector pixel seen on a row.
  [[nodiscard]] double phase_of(double pixel, long row) const {
    return kTurn * pixel / pattern.period + pattern.phase -
           carrier.along * static_cast<double>(row);
  }

  Rig rig;
  Pattern pattern;
  DecodeOptions options;
  Triangulation triangulation;
  Carrier carrier;
  DemodulationFilter filter;
  long rows = 0;     ///< of the working image
  long columns = 0;  ///< of the working image
  Eigen::Matrix3Xd
      directions;  ///< of the rays, in projector coordinates, in the order of the working image
  std::optional<HueClassifier> classifier;
  std::array<ChromaticLag, 2> lags;    ///< red, blue
  std::array<ChannelShift, 2> shifts;  ///< red, blue
  Plane expected_pixel;                ///< along the axis, at the carrier's depth
  std::array<Plane, 2> lag_cosine;     ///< of the lag there
  std::array<Plane, 2> lag_sine;
};

Decoder::Impl::Impl(const Rig& the_rig, const Pattern& the_pattern, const TrainedColors& colors,
                    const DecodeOptions& the_options)
    : rig((check_rig(the_rig, "rig"), the_rig)),
      pattern((check_pattern(the_pattern, "pattern"), the_pattern)),
      options((check_options(the_options), the_options)),
      triangulation(rig),
      carrier(expected_carrier(rig, pattern)),
      filter(make_filter(carrier.along)) {
  if (pattern.stripes.size() < 2 && !options.anchor) {
    throw InvalidInput(
        "pattern: has no stripes to find depths from; an anchor (a pixel and its depth) "
        "is needed");
  }
  if (options.anchor) check_anchor(*options.anchor, rig.camera);
  if (pattern.stripes.size() >= 2) classifier.emplace(pattern, colors);
  rows = carrier.transposed ? rig.camera.width : rig.camera.height;
  columns = carrier.transposed ? rig.camera.height : rig.camera.width;
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(rig.camera);
  directions.resize(3, rows * columns);
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      const long ray = carrier.transposed ? column * rows + row : row * columns + column;
      directions.col(row * columns + column) = triangulation.direction(rays.col(ray));
    }
  }
  expected_pixel.resize(rows, columns);
  const int axis = pattern.axis == Axis::x ? 0 : 1;
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      expected_pixel(row, column) =
          static_cast<float>(triangulation.project(direction(row, column), carrier.z)[axis]);
    }
  }
  const ChromaticShift* const channel[] = {&rig.red, &rig.blue};
  for (std::size_t i = 0; i < 2; ++i) {
    lags[i] = chromatic_lag(*channel[i], rig.projector, pattern);
    shifts[i] = channel_shift(rig.camera, channel[i]->alpha, rays, carrier.transposed);
    const Plane lag =
        expected_pixel * static_cast<float>(lags[i].slope) + static_cast<float>(lags[i].offset);
    lag_cosine[i] = lag.cos();
    lag_sine[i] = lag.sin();
  }
}

Decoder::Impl::Combined Decoder::Impl::combine(std::vector<Demodulated>& channels) const {
  for (Demodulated& channel : channels) smooth_rows(channel);
  Combined combined{channels[0].re, channels[0].im, {}, {}};
  if (channels.size() == 1) return combined;
  std::array<Plane, 2> re;
  std::array<Plane, 2> im;
  for (std::size_t i = 0; i < 2; ++i) {
    const Demodulated moved = resample(channels[i + 1], shifts[i], carrier.along);
    re[i] = moved.re * lag_cosine[i] - moved.im * lag_sine[i];
    im[i] = moved.re * lag_sine[i] + moved.im * lag_cosine[i];
    combined.re += re[i];
    combined.im += im[i];
  }
  const Plane norm = combined.re.square() + combined.im.square();
  combined.red_share = (re[0] * combined.re + im[0] * combined.im) / norm;
  combined.blue_share = (re[1] * combined.re + im[1] * combined.im) / norm;
  return combined;
}

Mask Decoder::Impl::find_modulated(const Combined& combined,
                                   const std::vector<Demodulated>& channels,
                                   const Mask& lit) const {
  Plane mean = channels[0].mean;
  if (channels.size() == 3) {
    const Plane sum = channels[0].mean + channels[1].mean + channels[2].mean;
    mean = sum;
    if (classifier) mean -= 3 * channels[0].mean.min(channels[1].mean).min(channels[2].mean);
  }
  const Plane amplitude = 2 * (combined.re.square() + combined.im.square()).sqrt();
  const auto contrast = static_cast<float>(options.min_contrast * pattern.amplitude / pattern.mean);
  return lit * ((amplitude >= static_cast<float>(options.min_modulation)) &&
                (amplitude >= contrast * mean))
                   .cast<std::uint8_t>();
}

Plane Decoder::Impl::hue_plane(const std::vector<Demodulated>& channels) const {
  Plane hue(rows, columns);
  for (long i = 0; i < hue.size(); ++i) {
    hue.data()[i] =
        hue_of(channels[1].mean.data()[i], channels[0].mean.data()[i], channels[2].mean.data()[i])
            .angle;
  }
  return hue;
}

std::vector<PhaseGuess> Decoder::Impl::guesses(const std::vector<Transition>& transitions) const {
  const Axis stripe_axis = pattern.axis == Axis::x ? Axis::y : Axis::x;
  const int axis = pattern.axis == Axis::x ? 0 : 1;
  std::vector<PhaseGuess> result;
  for (const Transition& transition : transitions) {
    const int column = static_cast<int>(std::lround(transition.column));
    const Eigen::Vector3d ray = direction(transition.row, column);
    const double edge = pattern.stripe_edges[static_cast<std::size_t>(transition.edge)];
    const double z = triangulation.depth(ray, stripe_axis, edge);
    const Eigen::Vector2d pixel = triangulation.project(ray, z);
    if (!triangulation.on_panel(pixel)) continue;
    result.push_back({transition.row, column, phase_of(pixel[axis], transition.row),
                      static_cast<double>(transition.score), transition.edge});
  }
  return result;
}

PhaseGuess Decoder::Impl::anchor_guess() const {
  const int u = static_cast<int>(std::lround(options.anchor->u_px));
  const int v = static_cast<int>(std::lround(options.anchor->v_px));
  const int row = carrier.transposed ? u : v;
  const int column = carrier.transposed ? v : u;
  const Eigen::Vector2d pixel = triangulation.project(direction(row, column), options.anchor->z);
  return {row, column, phase_of(pixel[pattern.axis == Axis::x ? 0 : 1], row), 1, 0};
}

float Decoder::Impl::depth_at(long row, long column, double phase, const Combined& combined) const {
  const double per_pixel = kTurn / pattern.period;
  double pixel = (phase + carrier.along * static_cast<double>(row) - pattern.phase) / per_pixel;
  if (combined.red_share.size() > 0) {
    // The lags were taken at the carrier's depth; now the projector pixel is known.
    const double moved = pixel - static_cast<double>(expected_pixel(row, column));
    pixel += moved *
             (static_cast<double>(combined.red_share(row, column)) * lags[0].slope +
              static_cast<double>(combined.blue_share(row, column)) * lags[1].slope) /
             per_pixel;
  }
  const Eigen::Vector3d ray = direction(row, column);
  const double z = triangulation.depth(ray, pattern.axis, pixel);
  if (!triangulation.on_panel(triangulation.project(ray, z))) return kUnknown;
  const double phase_per_mm = per_pixel * triangulation.slope(ray, pattern.axis, z);
  return std::abs(phase_per_mm) * options.max_sensitivity * z >= 1 ? static_cast<float>(z)
                                                                   : kUnknown;
}

DecodeResult Decoder::Impl::decode(const cv::Mat& frame) const {
  if (frame.cols != rig.camera.width || frame.rows != rig.camera.height) {
    throw InvalidInput("frame: is " + std::to_string(frame.cols) + " x " +
                       std::to_string(frame.rows) + " px, the rig's camera has " +
                       std::to_string(rig.camera.width) + " x " +
                       std::to_string(rig.camera.height));
  }
  const std::vector<Plane> channels = split_frame(frame, carrier.transposed);
  if (classifier && channels.size() != 3) {
    throw InvalidInput("frame: has one channel; the pattern's coloured stripes need three");
  }
  DecodeResult result;
  const Plane light = projector_light(channels, classifier.has_value(), (filter.radius + 1) / 2);
  const Mask lit = (light >= static_cast<float>(options.min_signal)).cast<std::uint8_t>();
  std::vector<Demodulated> demodulated = demodulate(channels, lit, filter);
  const Combined combined = combine(demodulated);
  const Mask modulated = find_modulated(combined, demodulated, lit);

  Plane wrapped(rows, columns);
  for (long i = 0; i < wrapped.size(); ++i) {
    wrapped.data()[i] = std::atan2(combined.im.data()[i], combined.re.data()[i]);
  }
  const Plane variance = phase_variance(wrapped, modulated);
  Regions regions = grow_regions(wrapped, variance, options.max_phase_variance, 1.5);
  std::vector<PhaseGuess> all_guesses;
  Plane hue;
  if (classifier) {
    hue = hue_plane(demodulated);
    const auto transitions = find_transitions(hue, lit, pattern, *classifier,
                                              {.min_hue_step = options.min_hue_step,
                                               .window_px = options.color_window_px,
                                               .min_color_score = options.min_color_score,
                                               .reversed = carrier.stripes_reversed});
    result.transitions = static_cast<int>(transitions.size());
    all_guesses = guesses(transitions);
    split_regions(wrapped, variance, options.max_phase_variance, 1.5,
                  find_markers(regions, all_guesses), regions);
  }
  std::vector<std::optional<double>> offsets =
      region_offsets(regions, all_guesses, options.min_agreement);
  if (options.anchor) {
    const PhaseGuess guess = anchor_guess();
    const int label = regions.label(guess.row, guess.column);
    if (label >= 0) {
      offsets[static_cast<std::size_t>(label)] =
          kTurn *
          std::round((guess.phase - static_cast<double>(regions.phase(guess.row, guess.column))) /
                     kTurn);
    }
  }
  Plane phase = regions.phase;
  Mask known = Mask::Zero(rows, columns);
  for (long i = 0; i < phase.size(); ++i) {
    const int label = regions.label.data()[i];
    if (label < 0 || !offsets[static_cast<std::size_t>(label)]) continue;
    known.data()[i] = 1;
    phase.data()[i] += static_cast<float>(*offsets[static_cast<std::size_t>(label)]);
  }
  result.regions = regions.count;
  for (const auto& offset : offsets) result.unresolved_regions += offset ? 0 : 1;

  result.range.camera = rig.camera;
  result.range.z = geometry::ImageF::Constant(rig.camera.height, rig.camera.width, kUnknown);
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      if (modulated(row, column) == 0) {
        ++result.unlit;
        continue;
      }
      if (known(row, column) == 0) {
        ++result.unresolved;
        continue;
      }
      const float z = depth_at(row, column, static_cast<double>(phase(row, column)), combined);
      if (!(z > 0)) {
        ++result.rejected;
        continue;
      }
      ++result.reconstructed;
      (carrier.transposed ? result.range.z(column, row) : result.range.z(row, column)) = z;
    }
  }
  return result;
}

Decoder::Decoder(const Rig& rig, const Pattern& pattern, const TrainedColors& colors,
                 const DecodeOptions& options)
    : impl_(std::make_unique<Impl>(rig, pattern, colors, options)) {}
Decoder::~Decoder() = default;
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;

DecodeResult Decoder::decode(const cv::Mat& frame) const { return impl_->decode(frame); }

}  // namespace palpate::sensing
