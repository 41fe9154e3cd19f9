// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/decode_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace palpate::sensing {
namespace {

/// With fewer stripe edges than this, nothing is decided: chains of a few misread edges, as on a
/// small coloured object, would decide.
constexpr long kLeastEdges = 60;
constexpr long kLeastStripeEdges = 4;
/// With fewer pixels with a sinusoid than this, nothing is decided about hues and rows.
constexpr long kLeastHues = 500;

/// Stripes and sinusoid agree if the mean of cos(2 pi d) is at least this: 1 is perfect, 0 is
/// chance.
constexpr double kLeastPhaseAgreement = 0.45;
/// An explanation is likely if it brings the agreement to at least this, and to more than a uniform
/// shift would.
constexpr double kLikely = 0.65;
/// More than this share of the edges in steady parts of the frame must not be displaced.
constexpr double kMostDisplaced = 0.5;

/// On coloured surfaces parts of the frame are displaced with the right rig too, so they make a
/// frame that agrees as a whole wrong only if at least this share of the hues are trained ones.
constexpr double kLeastTrainedParts = 0.6;
/// Successive bands of rows do not fit if more than kMostDisplaced of their edges are displaced,
/// and they have at least this share of the frame's edges. A lens with lateral chromatic aberration
/// displaces fewer at the border of the image.
constexpr double kLeastTorn = 0.2;
/// The other rows fit if less than this share of their edges is displaced, and they have at least
/// this share of all: a wrong rig fits along a line.
constexpr double kFewDisplaced = 0.2;
constexpr double kLeastOthers = 1.0 / 3;

/// The shift must not change by more than this [px] from one deviation of the disparity below its
/// mean to one above: twice the effect of blur and of the colours of a lens.
constexpr double kMostTrend = 0.35;
/// Beyond this slope [px/px], it is the noise of the depths that changes the shift.
constexpr double kSteepestTrend = 0.5;

/// A surface is coloured if one channel returns this many times the light of another.
constexpr double kColored = 3.5;
/// The colours are those that were trained if at least this share of the pixels has their hues.
constexpr double kLeastTrainedHues = 0.3;

/// The sinusoid is missing if less than this share of the lit pixels shows it.
constexpr double kLeastSinusoid = 0.2;
/// The sinusoid runs across its expected axis if at least this share shows it there.
constexpr double kMostAcross = 0.4;

/// Squared steps of brightness within pairs of rows and between the pairs count as equal up to
/// this factor.
constexpr double kUnlikeSteps = 2.5;

/// The shift is uniform if the mean of exp(2 pi i d) is at least this long, and smooth if the mean
/// of cos(2 pi difference of d) between neighbouring stripe edges is at least this.
constexpr double kAlike = 0.8;
constexpr double kSmooth = 0.7;

/// `part` as a share of `all`; 0 if `all` is 0.
double share(double part, long all) { return part / static_cast<double>(std::max(all, 1L)); }
double share(long part, long all) { return share(static_cast<double>(part), all); }

long sum(const std::array<long, kRowBands>& bands) {
  return std::accumulate(bands.begin(), bands.end(), 0L);
}

/// The judgement for swapped channels in the trained colours, or in the frames.
DecodeJudgement swapped(const char* channels, const DecodeEvidence& evidence, double agreement) {
  return {
      DecodeVerdict::wrong_channels,
      fmt::format("{} are swapped in {}: with them exchanged, {:.0f} % of the agreement between "
                  "stripes and sinusoid would be there",
                  channels,
                  evidence.colors_fit_pattern
                      ? "the frames (try the other order of the channels, RGB or BGR, or "
                        "another --bayer)"
                      : "the trained colours (train them again)",
                  100 * agreement)};
}

DecodeJudgement turned(const char* how, double agreement) {
  return {DecodeVerdict::turned_frames,
          fmt::format("the frames are {0}: if they were not, {1:.0f} % of the agreement between "
                      "stripes and sinusoid would be there. Try to turn them back, or calibrate "
                      "the rig with frames that are {0} as well",
                      how, 100 * agreement)};
}

DecodeJudgement explanation_of(const DecodeEvidence& evidence, FrameExplanation explanation,
                               double agreement) {
  switch (explanation) {
    case FrameExplanation::red_blue_swapped:
      return swapped("red and blue", evidence, agreement);
    case FrameExplanation::red_green_swapped:
      return swapped("red and green", evidence, agreement);
    case FrameExplanation::green_blue_swapped:
      return swapped("green and blue", evidence, agreement);
    case FrameExplanation::negative:
      return {DecodeVerdict::wrong_channels,
              "the frames are negatives: bright where they should be dark"};
    case FrameExplanation::stripes_reversed:
      return {DecodeVerdict::reversed_stripes,
              "the stripes of the pattern follow each other in reverse order: try the pattern file "
              "that belongs to the projected image, or check whether the projector mirrors it"};
    case FrameExplanation::mirrored:
      return turned("mirrored", agreement);
    case FrameExplanation::flipped:
      return turned("upside down (flipped)", agreement);
    case FrameExplanation::rotated:
      return turned("rotated by 180 degrees", agreement);
  }
  return {};
}

/// Agreement if the sinusoid were shifted uniformly.
double agreement_of_shift(const DecodeEvidence& evidence) {
  return share(std::hypot(evidence.agreement, evidence.shift), evidence.edges);
}

/// The explanation that fits best, if it is likely.
std::optional<DecodeJudgement> explain(const DecodeEvidence& evidence) {
  const auto best = std::max_element(evidence.explained.begin(), evidence.explained.end());
  const double with_it = share(*best, evidence.explained_edges);
  if (with_it < kLikely || with_it <= agreement_of_shift(evidence)) return std::nullopt;
  return explanation_of(evidence, static_cast<FrameExplanation>(best - evidence.explained.begin()),
                        with_it);
}

/// Bands of rows [first, last).
struct Bands {
  int first = 0;
  int last = 0;
};

/// The bands in which most edges are displaced, if there are enough for a decision.
std::optional<Bands> displaced_bands(const DecodeEvidence& evidence) {
  const double least =
      std::max<double>(kLeastEdges, kLeastTorn * static_cast<double>(sum(evidence.steady_edges)));
  std::optional<Bands> found;
  double most = 0;
  for (int first = 0; first < kRowBands; ++first) {
    double steady = 0, displaced = 0;
    for (int band = first; band < kRowBands; ++band) {
      steady += static_cast<double>(evidence.steady_edges[static_cast<std::size_t>(band)]);
      displaced += static_cast<double>(evidence.displaced_edges[static_cast<std::size_t>(band)]);
      const double excess = displaced - kMostDisplaced * steady;
      if (steady < least || excess <= most) continue;
      most = excess;
      found = Bands{first, band + 1};
    }
  }
  return found;
}

/// Returns true if the frame fits outside these bands.
bool others_fit(const DecodeEvidence& evidence, const Bands& bands) {
  long steady = 0, displaced = 0;
  for (int band = 0; band < kRowBands; ++band) {
    if (band >= bands.first && band < bands.last) continue;
    steady += evidence.steady_edges[static_cast<std::size_t>(band)];
    displaced += evidence.displaced_edges[static_cast<std::size_t>(band)];
  }
  return share(steady, sum(evidence.steady_edges)) >= kLeastOthers &&
         share(displaced, steady) < kFewDisplaced;
}

DecodeJudgement torn(const DecodeEvidence& evidence, const Bands& bands) {
  return {DecodeVerdict::torn_frames,
          fmt::format(
              "stripes and sinusoid are shifted against each other in rows {} to {}. Either "
              "rows were lost or shifted in transfer (check the camera's cable, bandwidth "
              "and buffers, and record again), or the scene moved while these rows were "
              "exposed. If all frames name rows, calibrate again",
              bands.first * evidence.rows / kRowBands, bands.last * evidence.rows / kRowBands - 1)};
}

/// Judges the cause of different phases if no simple exchange explains them.
DecodeJudgement judge_shift(const DecodeEvidence& evidence) {
  const auto bands = displaced_bands(evidence);
  if (bands && others_fit(evidence, *bands)) return torn(evidence, *bands);
  const double smooth = share(evidence.smoothness, evidence.neighbours);
  const double turns = std::atan2(evidence.shift, evidence.agreement) / (2 * std::numbers::pi);
  if (agreement_of_shift(evidence) >= kAlike) {
    return {DecodeVerdict::shifted_sinusoid,
            fmt::format("the sinusoid is {:.2f} of a period from where the stripes put it, "
                        "everywhere alike: the pattern's phase, the order of its stripes or the "
                        "principal point of projector or camera is another, or the frames are "
                        "shifted or cropped",
                        std::abs(turns))};
  }
  if (smooth >= kSmooth) {
    return {DecodeVerdict::wrong_rig,
            "the sinusoid is away from where the stripes put it, by an amount that varies over the "
            "frame: the rig seems to be another (has camera or projector moved? is it the rig of "
            "this projector, and of frames of this size?), or the period of the pattern is"};
  }
  return {DecodeVerdict::wrong_pattern,
          "stripes and sinusoid have nothing to do with each other: pattern or rig belong to "
          "another projector, or the trained colours to another camera"};
}

/// Change of the shift of the edges against the sinusoid between near and far parts [px].
double change_with_depth(const DepthTrend& trend) {
  if (trend.edges < kLeastEdges) return 0;
  const auto edges = static_cast<double>(trend.edges);
  const double mean = trend.disparity / edges;
  const double variance = trend.disparity_squares / edges - mean * mean;
  const double covariance = trend.products / edges - mean * trend.shift / edges;
  if (!(variance > 0) || std::abs(covariance) > kSteepestTrend * variance) return 0;
  return 2 * std::abs(covariance) / std::sqrt(variance);
}

DecodeJudgement wrong_depths(double change) {
  return {
      DecodeVerdict::wrong_rig,
      fmt::format("stripes and sinusoid move against each other by {:.2f} px between near and "
                  "far parts of the scene: the baseline or a focal length of the rig is probably "
                  "wrong. Calibrate again if the camera or the projector was moved",
                  change)};
}

/// Returns true if rows are exchanged or doubled, as in interlaced video.
bool has_wrong_rows(const DecodeEvidence& evidence) {
  const double in = evidence.steps_in_pairs, between = evidence.steps_between_pairs;
  return in > kUnlikeSteps * between || between > kUnlikeSteps * in;
}

std::string few_edges(const DecodeEvidence& evidence) {
  if (evidence.lit == 0) return "too little to judge by: no lit stripes";
  const double with_sinusoid = share(evidence.hues, evidence.lit);
  if (with_sinusoid < kLeastSinusoid) {
    return fmt::format(
        "too little to judge by: only {:.0f} % of the lit pixels show the sinusoid; is "
        "it out of focus, or has the pattern another period or axis?",
        100 * with_sinusoid);
  }
  return fmt::format(
      "too little to judge by: {} readings of {} different stripe edges; {} of {} "
      "are needed",
      evidence.edges + evidence.off_panel, evidence.stripe_edges, kLeastEdges, kLeastStripeEdges);
}

}  // namespace

DepthTrend& DepthTrend::operator+=(const DepthTrend& other) {
  edges += other.edges;
  disparity += other.disparity;
  disparity_squares += other.disparity_squares;
  shift += other.shift;
  products += other.products;
  return *this;
}

DecodeEvidence& DecodeEvidence::operator+=(const DecodeEvidence& other) {
  edges += other.edges;
  off_panel += other.off_panel;
  stripe_edges += other.stripe_edges;
  agreement += other.agreement;
  shift += other.shift;
  for (std::size_t i = 0; i < steady_edges.size(); ++i) {
    steady_edges[i] += other.steady_edges[i];
    displaced_edges[i] += other.displaced_edges[i];
  }
  rows = std::max(rows, other.rows);
  trend += other.trend;
  neighbours += other.neighbours;
  smoothness += other.smoothness;
  for (std::size_t i = 0; i < explained.size(); ++i) explained[i] += other.explained[i];
  explained_edges += other.explained_edges;
  for (std::size_t i = 0; i < light.size(); ++i) light[i] += other.light[i];
  lit += other.lit;
  hues += other.hues;
  across += other.across;
  trained_hues += other.trained_hues;
  steps_in_pairs += other.steps_in_pairs;
  steps_between_pairs += other.steps_between_pairs;
  colors_fit_pattern = colors_fit_pattern && other.colors_fit_pattern;
  return *this;
}

DecodeJudgement judge(const DecodeEvidence& evidence) {
  const long edges = evidence.edges + evidence.off_panel;
  const double across = share(evidence.across, evidence.lit);
  if (evidence.lit >= kLeastHues && edges < kLeastEdges && across > kMostAcross) {
    return {DecodeVerdict::wrong_pattern,
            fmt::format("the sinusoid runs along the other axis of the image: {:.0f} % of the lit "
                        "pixels show it there. The pattern has another axis, or the frames are "
                        "turned by 90 degrees",
                        100 * across)};
  }
  if (evidence.hues >= kLeastHues && has_wrong_rows(evidence)) {
    return {DecodeVerdict::wrong_rows,
            "rows of the frames are exchanged or doubled, as in interlaced video: try to record "
            "whole frames, or to decode one field alone with a rig of its size"};
  }
  const auto [least, most] = std::minmax_element(evidence.light.begin(), evidence.light.end());
  const bool colored = *most > kColored * *least;
  const double trained = share(evidence.trained_hues, evidence.hues);
  if (evidence.hues >= kLeastHues && !colored && trained < kLeastTrainedHues) {
    return {DecodeVerdict::wrong_colors,
            fmt::format("only {:.0f} % of the hues are those of a trained colour: the trained "
                        "colours seem to be those of another camera or projector; train them again",
                        100 * trained)};
  }
  if (edges < kLeastEdges ||
      (evidence.edges >= evidence.off_panel && evidence.stripe_edges < kLeastStripeEdges)) {
    return {DecodeVerdict::too_little, few_edges(evidence)};
  }
  if (colored) {
    return {DecodeVerdict::too_little,
            fmt::format("too little to judge by: the surface is coloured (one of red, green and "
                        "blue is {:.1f} times as bright as another)",
                        *most / std::max(*least, 1e-3 * *most))};
  }
  const double agreement = share(evidence.agreement, edges);
  if (agreement < kLeastPhaseAgreement) {
    const auto explanation = explain(evidence);
    return explanation ? *explanation : judge_shift(evidence);
  }
  if (share(sum(evidence.displaced_edges), sum(evidence.steady_edges)) > kMostDisplaced) {
    return judge_shift(evidence);
  }
  if (trained >= kLeastTrainedParts) {
    const auto bands = displaced_bands(evidence);
    if (bands && others_fit(evidence, *bands)) return torn(evidence, *bands);
    const double change = change_with_depth(evidence.trend);
    if (change > kMostTrend) return wrong_depths(change);
    if (bands) return torn(evidence, *bands);
  }
  return {DecodeVerdict::accepted,
          fmt::format("stripes and sinusoid agree by {:.0f} % at {} readings of stripe edges",
                      100 * agreement, edges)};
}

const char* to_string(DecodeVerdict verdict) {
  switch (verdict) {
    case DecodeVerdict::accepted:
      return "accepted";
    case DecodeVerdict::too_little:
      return "too_little";
    case DecodeVerdict::wrong_channels:
      return "wrong_channels";
    case DecodeVerdict::wrong_colors:
      return "wrong_colors";
    case DecodeVerdict::turned_frames:
      return "turned_frames";
    case DecodeVerdict::wrong_rows:
      return "wrong_rows";
    case DecodeVerdict::torn_frames:
      return "torn_frames";
    case DecodeVerdict::reversed_stripes:
      return "reversed_stripes";
    case DecodeVerdict::shifted_sinusoid:
      return "shifted_sinusoid";
    case DecodeVerdict::wrong_rig:
      return "wrong_rig";
    case DecodeVerdict::wrong_pattern:
      return "wrong_pattern";
  }
  return "unknown";
}

}  // namespace palpate::sensing
