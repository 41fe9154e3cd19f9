// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/multishot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "decode/decoder_geometry.h"
#include "decode/period_code.h"
#include "decode/plausibility.h"
#include "image/hue.h"
#include "image/reasons.h"
#include "palpate/core/error.h"
#include "phase/shifted_noise.h"
#include "phase/shifted_phase.h"

namespace palpate::sensing {
namespace {

/// Two neighbours lie on different surfaces if the phase between them differs from the carrier by
/// more than this share of the carrier: beyond a slope that squeezes two and a half periods into
/// one ...
constexpr double kSteepest = 1.5;
/// ... and by more than this [rad], up to which noise may change it.
constexpr double kLeastStep = 0.4;
/// A pixel this far from such a step sees both surfaces [px].
constexpr int kMixedPixels = 2;

/// [rad] The limit for such a step if the carrier advances by `along` [rad].
float break_limit(double along) {
  return static_cast<float>(std::max(kSteepest * std::abs(along), kLeastStep));
}

/// Checks the images; three equal channels become one.
std::vector<cv::Mat> checked(std::span<const cv::Mat> images, int expected,
                             const geometry::Camera& camera) {
  if (static_cast<int>(images.size()) != expected) {
    throw InvalidInput("images: there are " + std::to_string(images.size()) +
                       "; the pattern and its exposures need " + std::to_string(expected));
  }
  const int type = images[0].type();
  for (std::size_t i = 0; i < images.size(); ++i) {
    const cv::Mat& image = images[i];
    const std::string name = "images[" + std::to_string(i) + "]: ";
    if (image.cols != camera.width || image.rows != camera.height) {
      throw InvalidInput(name + "is " + std::to_string(image.cols) + " x " +
                         std::to_string(image.rows) + " px, the rig's camera has " +
                         std::to_string(camera.width) + " x " + std::to_string(camera.height));
    }
    if (!is_frame(image) || image.type() != type) {
      throw InvalidInput(name +
                         "is not of 8 or 16 bit with 1 or 3 channels, or not of the type of "
                         "the first one");
    }
  }
  std::vector<cv::Mat> kept(images.begin(), images.end());
  if (images[0].channels() == 1) return kept;
  std::vector<cv::Mat> channels;
  for (const cv::Mat& image : images) {
    cv::split(image, channels);
    if (cv::norm(channels[0], channels[1], cv::NORM_INF) != 0 ||
        cv::norm(channels[0], channels[2], cv::NORM_INF) != 0)
      return kept;
  }
  for (cv::Mat& image : kept) cv::extractChannel(image, image, 0);
  return kept;
}

/// Sums over the channels, in the orientation of the camera.
struct ChannelTotals {
  Plane mean;
  Plane amplitude;
  Plane variance;  ///< of one value, summed over channels and exposures
  Plane count;     ///< of channels and exposures
};

ChannelTotals totals_of(const ShiftedImages& sums, const ShiftFit& fit, float least_amplitude) {
  const Plane zero = Plane::Zero(sums.signal.rows(), sums.signal.cols());
  ChannelTotals totals{zero, zero, zero, zero};
  for (std::size_t c = 0; c < sums.channels.size(); ++c) {
    const ShiftedChannel& channel = sums.channels[c];
    const LinearInLight variance =
        fit.freedom > 0
            ? variance_of_light(sums.samples[c], fit.freedom)
            : variance_of_light(
                  samples_between_pixels(channel, fit.spread.trace() / 2, least_amplitude), 1);
    totals.mean += channel.mean;
    totals.amplitude += (channel.re.square() + channel.im.square()).sqrt();
    totals.count += channel.count;
    totals.variance += static_cast<float>(variance.constant) * channel.count +
                       static_cast<float>(variance.slope) * channel.mean;
  }
  return totals;
}

/// Reads one image of the code: bright places are positive, in units of the sinusoid's amplitude.
/// \param images of this bit, one per exposure
Plane read_bit(std::span<const cv::Mat> images, const ShiftedImages& sums,
               const ChannelTotals& totals) {
  Plane value = -totals.mean;
  std::vector<Plane> channels;
  for (std::size_t e = 0; e < images.size(); ++e) {
    split_frame(images[e], false, channels);
    for (std::size_t c = 0; c < channels.size(); ++c)
      value += (1.0F - sums.clipped[e][c].cast<float>()) * channels[c];
  }
  return (totals.amplitude > 0)
      .select(value / totals.amplitude, Plane::Zero(value.rows(), value.cols()));
}

/// Refuses pixels among contradictions: some misread codes agree with the phase by chance.
void drop_chance_agreements(const Plane& phase, ReasonImage& reasons) {
  constexpr long kAround = 3;
  const auto contradicts = (reasons == code(Reason::ambiguous_offset)).cast<int>().eval();
  const auto agrees = (phase == phase).cast<int>().eval();
  for (long row = 0; row < reasons.rows(); ++row) {
    const long top = std::max<long>(0, row - kAround);
    const long height = std::min(reasons.rows() - 1, row + kAround) - top + 1;
    for (long column = 0; column < reasons.cols(); ++column) {
      if (agrees(row, column) == 0) continue;
      const long left = std::max<long>(0, column - kAround);
      const long width = std::min(reasons.cols() - 1, column + kAround) - left + 1;
      if (contradicts.block(top, left, height, width).sum() >
          agrees.block(top, left, height, width).sum())
        reasons(row, column) = code(Reason::ambiguous_offset);
    }
  }
}

/// Jumps by whole turns from row to row beyond those that steps of the surface make by chance, per
/// turn by which the phase advances.
/// \param phase minus the carrier [rad], NaN where unknown
/// \param along [rad] of the carrier from row to row
double jumps_per_turn(const Plane& phase, double along) {
  constexpr auto kTurn = static_cast<float>(kFullTurn);
  constexpr double kWholeByChance = 2 * kLeastStep / kFullTurn;  // share of steps of any height
  const long last = phase.rows() - 1;
  const Plane step = phase.bottomRows(last) - phase.topRows(last);
  const Plane turns = (step / kTurn).round();
  const auto whole = (step - turns * kTurn).abs() < static_cast<float>(kLeastStep);
  const auto jumps = static_cast<double>((whole && turns != 0).count());
  const auto steps = static_cast<double>((step.abs() > break_limit(along) && !whole).count());
  const auto pairs = static_cast<double>((step == step).count());
  const double by_chance = steps * kWholeByChance / (1 - kWholeByChance);
  return std::max(0.0, jumps - by_chance) / (pairs * std::abs(along) / kFullTurn);
}

/// Mean of the sinusoids of the first exposure at pixels with a depth.
cv::Mat mean_color(std::span<const cv::Mat> sinusoids, const Plane& z) {
  cv::Mat sum(sinusoids[0].size(), CV_MAKETYPE(CV_32F, sinusoids[0].channels()), cv::Scalar());
  for (const cv::Mat& image : sinusoids) cv::add(sum, image, sum, cv::noArray(), CV_32F);
  sum *= 1 / (full_scale(sinusoids[0]) * static_cast<double>(sinusoids.size()));
  for (int row = 0; row < sum.rows; ++row) {
    for (int column = 0; column < sum.cols; ++column) {
      if (z(row, column) > 0) continue;
      std::fill_n(sum.ptr<float>(row) + column * sum.channels(), sum.channels(), 0.0F);
    }
  }
  return sum;
}

template <typename Image>
Image reoriented(const Image& image, bool transposed) {
  return transposed ? Image(image.transpose()) : image;
}

/// The phasors of a channel without the carrier, in the orientation of the working image.
Demodulated without_carrier(const ShiftedChannel& channel, const Carrier& carrier) {
  Demodulated out{reoriented(channel.re, carrier.transposed),
                  reoriented(channel.im, carrier.transposed),
                  reoriented(channel.mean, carrier.transposed)};
  for (long row = 0; row < out.re.rows(); ++row) {
    const double angle = carrier.along * static_cast<double>(row);
    const auto cosine = static_cast<float>(std::cos(angle));
    const auto sine = static_cast<float>(std::sin(angle));
    const Eigen::ArrayXf re = out.re.row(row).transpose();
    const Eigen::ArrayXf im = out.im.row(row).transpose();
    out.re.row(row) = (re * cosine + im * sine).transpose();
    out.im.row(row) = (im * cosine - re * sine).transpose();
  }
  return out;
}

}  // namespace

void visit(MultishotOptions& options, FieldVisitor& visitor) {
  constexpr int kMostExposures = 100;
  visitor.begin("MultishotOptions");
  visitor.whole({"exposures",
                 "Number of times that the images of the pattern follow each other, each time with "
                 "another exposure of the camera; a pixel uses those in which it is not clipped"},
                options.exposures, at_least(1).at_most(kMostExposures));
  constexpr bool kExpert = true;
  visitor.real({"min_signal", "Least light of the projector at which a pixel counts as lit",
                "fraction of full scale", kExpert},
               options.min_signal, above(0).below(1));
  visitor.real({"max_phase_variance", "Largest predicted variance of a phase that is used", "rad^2",
                kExpert},
               options.max_phase_variance, above(0).finite());
  visitor.real(
      {"max_sensitivity", "Largest change of a depth with the phase, as a share of the depth",
       "1/rad", kExpert},
      options.max_sensitivity, above(0).finite());
}

struct MultishotDecoder::Impl {
  Impl(const Rig& rig, const Pattern& pattern, const MultishotOptions& the_options);

  [[nodiscard]] float least_amplitude() const;
  [[nodiscard]] ShiftedImages fit_images(const std::vector<cv::Mat>& images) const;
  [[nodiscard]] std::vector<CodeReading> read_codes(const std::vector<cv::Mat>& images,
                                                    const ShiftedImages& sums,
                                                    const ChannelTotals& totals) const;
  void judge_light(const ShiftedImages& sums, const ChannelTotals& totals,
                   ReasonImage& reasons) const;
  void find_phases(const Combined& combined, const ChannelTotals& totals, const Plane& remainder,
                   const std::vector<CodeReading>& codes, Plane& phase, Plane& sigma,
                   ReasonImage& reasons) const;
  [[nodiscard]] MultishotResult decode(std::span<const cv::Mat> given) const;

  MultishotOptions options;
  DecoderGeometry model;
  PeriodCode code;
  ShiftFit fit;
  std::size_t images_per_exposure;
};

namespace {

const Pattern& with_multishot(const Pattern& pattern) {
  check_pattern(pattern, "pattern");
  if (!pattern.multishot) {
    throw InvalidInput(
        "pattern: has no `multishot`, so it is for single images; decode each image alone, or take "
        "the pattern that several images were made with");
  }
  return pattern;
}

}  // namespace

MultishotDecoder::Impl::Impl(const Rig& rig, const Pattern& pattern,
                             const MultishotOptions& the_options)
    : options(in_range(the_options)),
      model(rig, with_multishot(pattern)),
      code(pattern),
      fit(make_shift_fit(pattern.multishot->shifts)),
      images_per_exposure(pattern.multishot->shifts.size() +
                          static_cast<std::size_t>(pattern.multishot->code_bits)) {
  check_pattern_fits(pattern, rig.projector, "pattern");
}

/// Amplitude of a pixel that the projector lights with `min_signal`.
float MultishotDecoder::Impl::least_amplitude() const {
  const Pattern& pattern = model.pattern();
  return static_cast<float>(options.min_signal * pattern.amplitude /
                            (pattern.mean + pattern.amplitude));
}

ShiftedImages MultishotDecoder::Impl::fit_images(const std::vector<cv::Mat>& images) const {
  ShiftedImages sums;
  for (std::size_t first = 0; first < images.size(); first += images_per_exposure) {
    add_exposure(std::span(images).subspan(first, model.pattern().multishot->shifts.size()), fit,
                 least_amplitude(), model.carrier().transposed, sums);
  }
  return sums;
}

/// In the camera's orientation, row by row.
std::vector<CodeReading> MultishotDecoder::Impl::read_codes(const std::vector<cv::Mat>& images,
                                                            const ShiftedImages& sums,
                                                            const ChannelTotals& totals) const {
  std::vector<CodeReading> codes(static_cast<std::size_t>(totals.mean.size()));
  const int bits = model.pattern().multishot->code_bits;
  const std::size_t first = model.pattern().multishot->shifts.size();
  std::vector<cv::Mat> of_bit(static_cast<std::size_t>(options.exposures));
  for (int bit = 0; bit < bits; ++bit) {
    for (std::size_t e = 0; e < of_bit.size(); ++e)
      of_bit[e] = images[e * images_per_exposure + first + static_cast<std::size_t>(bit)];
    const Plane value = read_bit(of_bit, sums, totals);
    for (std::size_t i = 0; i < codes.size(); ++i) codes[i].append(value.data()[i], bits - 1 - bit);
  }
  return codes;
}

/// In the camera's orientation.
void MultishotDecoder::Impl::judge_light(const ShiftedImages& sums, const ChannelTotals& totals,
                                         ReasonImage& reasons) const {
  const Mask lit = (sums.signal >= least_amplitude()).cast<std::uint8_t>();
  const Mask clipped = lit * (totals.count == 0).cast<std::uint8_t>();
  reasons.setZero(lit.rows(), lit.cols());
  give_reason(clipped, Reason::saturated, reasons);
  give_reason_unless(lit, Reason::unlit, reasons);
}

/// Absolute phases minus the carrier, and their standard deviations [rad]; NaN where unknown. All
/// but the codes are of the working image.
void MultishotDecoder::Impl::find_phases(const Combined& combined, const ChannelTotals& totals,
                                         const Plane& remainder,
                                         const std::vector<CodeReading>& codes, Plane& phase,
                                         Plane& sigma, ReasonImage& reasons) const {
  const Carrier& carrier = model.carrier();
  const long rows = model.rows();
  const long columns = model.columns();
  phase.setConstant(rows, columns, kUnknown);
  sigma.setConstant(rows, columns, kUnknown);
  std::vector<double> largest(static_cast<std::size_t>(3 * options.exposures + 1), 1);
  for (std::size_t n = 1; n < largest.size() && fit.freedom > 0; ++n)
    largest[n] = beyond_chance(static_cast<int>(n) * fit.freedom);
  for (long row = 0; row < rows; ++row) {
    const double turned_by = carrier.along * static_cast<double>(row);
    for (long column = 0; column < columns; ++column) {
      std::uint8_t& reason = reasons(row, column);
      if (reason != sensing::code(Reason::reconstructed)) continue;
      const auto re = static_cast<double>(combined.re(row, column));
      const auto im = static_cast<double>(combined.im(row, column));
      const double wrapped = std::atan2(im, re) + turned_by;
      const Eigen::Vector2d across(-std::sin(wrapped), std::cos(wrapped));
      const double share = across.dot(fit.spread * across) / (re * re + im * im);
      const auto usual = static_cast<double>(totals.variance(row, column));
      const auto left = static_cast<double>(remainder(row, column));
      const auto n = static_cast<std::size_t>(totals.count(row, column));
      const bool chance = fit.freedom == 0 || left <= largest[n] * usual;
      const double variance = share * (chance ? usual : left);
      if (!(variance <= options.max_phase_variance)) {
        const bool weak = !(share * usual <= options.max_phase_variance);
        reason = sensing::code(weak ? Reason::low_modulation : Reason::uneven_phase);
        continue;
      }
      const long place = carrier.transposed ? column * rows + row : row * columns + column;
      const auto absolute = code.absolute(wrapped, codes[static_cast<std::size_t>(place)]);
      if (!absolute) {
        reason = sensing::code(Reason::ambiguous_offset);
        continue;
      }
      phase(row, column) = static_cast<float>(*absolute - turned_by);
      sigma(row, column) = static_cast<float>(std::sqrt(variance));
    }
  }
}

MultishotResult MultishotDecoder::Impl::decode(std::span<const cv::Mat> given) const {
  const int expected = static_cast<int>(images_per_exposure) * options.exposures;
  const std::vector<cv::Mat> images = checked(given, expected, model.rig().camera);
  const Carrier& carrier = model.carrier();
  const ShiftedImages sums = fit_images(images);
  ChannelTotals totals = totals_of(sums, fit, least_amplitude());
  const std::vector<CodeReading> codes = read_codes(images, sums, totals);

  MultishotResult result;
  ReasonImage reasons;
  judge_light(sums, totals, reasons);
  reasons = reoriented(reasons, carrier.transposed);
  std::vector<Demodulated> channels;
  for (const ShiftedChannel& channel : sums.channels)
    channels.push_back(without_carrier(channel, carrier));
  Combined combined;
  combine_channels(channels, model.chromatic(), combined);
  totals.variance = reoriented(totals.variance, carrier.transposed);
  totals.count = reoriented(totals.count, carrier.transposed);
  Plane phase, sigma;
  find_phases(combined, totals, reoriented(sums.remainder, carrier.transposed), codes, phase, sigma,
              reasons);

  Mask edges;
  add_mixed_light(combined, totals.count, carrier.along, sigma, edges);
  give_reason(edges, Reason::border, reasons);
  drop_chance_agreements(phase, reasons);
  keep_reconstructed(reasons, phase);
  result.code_jumps = jumps_per_turn(phase, carrier.along);

  Mask breaks;
  find_breaks(phase, break_limit(carrier.along), {kMixedPixels, kMixedPixels}, breaks);
  give_reason(breaks, Reason::border, reasons);
  keep_reconstructed(reasons, phase);
  const ChromaticError chromatic =
      remaining_error(channels, model.chromatic(), phase,
                      {.along = carrier.along,
                       .offset = model.pattern().phase,
                       .per_pixel = kFullTurn / model.pattern().period},
                      PhaseTexture::none);
  if (channels.size() == 3) {
    sigma = (sigma.square() + static_cast<float>(chromatic.red) * combined.shares.red.square() +
             static_cast<float>(chromatic.blue) * combined.shares.blue.square())
                .sqrt();
  }
  SurfaceImages surfaces;
  model.find_surfaces(phase, combined.shares, options.max_sensitivity, surfaces, reasons);
  keep_reconstructed(reasons, surfaces.z);
  sigma = (surfaces.z == surfaces.z)
              .select(sigma * surfaces.z_per_phase,
                      Plane::Constant(sigma.rows(), sigma.cols(), kUnknown));
  result.decoded.range = {.z = reoriented(surfaces.z, carrier.transposed),
                          .camera = model.rig().camera};
  result.decoded.reasons = reoriented(reasons, carrier.transposed);
  result.decoded.sigma = reoriented(sigma, carrier.transposed);
  result.color = mean_color(std::span(images).first(model.pattern().multishot->shifts.size()),
                            result.decoded.range.z);
  result.disagreement =
      fit.freedom > 0 && sums.power > 0
          ? std::sqrt(std::max(0.0, sums.shared / sums.power) * fit.spread.trace() / 2)
          : std::numeric_limits<double>::quiet_NaN();
  return result;
}

MultishotDecoder::MultishotDecoder(const Rig& rig, const Pattern& pattern,
                                   const MultishotOptions& options)
    : impl_(std::make_unique<Impl>(rig, pattern, options)) {}
MultishotDecoder::~MultishotDecoder() = default;
MultishotDecoder::MultishotDecoder(MultishotDecoder&&) noexcept = default;
MultishotDecoder& MultishotDecoder::operator=(MultishotDecoder&&) noexcept = default;

const Rig& MultishotDecoder::rig() const { return impl_->model.rig(); }
int MultishotDecoder::images() const {
  return static_cast<int>(impl_->images_per_exposure) * impl_->options.exposures;
}
MultishotResult MultishotDecoder::decode(std::span<const cv::Mat> images) const {
  return impl_->decode(images);
}

}  // namespace palpate::sensing
