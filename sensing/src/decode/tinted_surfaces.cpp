// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/tinted_surfaces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "image/hue.h"
#include "phase/lit_channels.h"
#include "regions/joined_regions.h"
#include "regions/region_samples.h"

namespace palpate::sensing {
namespace {

/// Regions with fewer pixels stay as they are.
constexpr long kLeastTinted = 150;
/// Spacing of the pixels whose hues show whether an offset fits [px], smallest number of them, and
/// the smallest share that must agree.
constexpr long kHueSpacing = 4;
constexpr long kLeastSampledHues = 12;
constexpr double kAgreeingHues = 0.97;

/// Distance from an edge at which a stripe is seen [projector px].
constexpr double kTintMargin = 1.5;
/// Widest gap that is bridged [stripes]: neighbouring stripes that a surface does not reflect.
constexpr double kGapStripes = 3.5;
/// Distance to each side within which each channel is in some stripe [stripes].
constexpr double kSearchedStripes = 2.5;

/// Largest share of failing comparisons if the offset is right: of a group, and of each of its
/// regions.
constexpr double kFailingInGroup = 0.12;
constexpr double kFailingInRegion = 0.2;
/// Any other number of turns fails in at least this larger share of the comparisons: a group whose
/// rows all show the same few edges has many comparisons and little evidence.
constexpr double kClearMargin = 0.05;
/// Probability that a comparison fails if the offset is right.
constexpr double kFailureChance = 0.05;
/// Likelihood ratio at which an offset is accepted.
constexpr double kClearRatio = 1000;

/// Comparisons, and how many failed.
struct Score {
  double compared = 0;
  double failed = 0;
  [[nodiscard]] double share() const { return compared > 0 ? failed / compared : 1; }
};

/// Samples of a group, and the channels that are seen there.
struct SeenSamples {
  std::vector<RegionSample> samples;
  std::vector<PhaseGuess> phases;
  std::vector<std::uint8_t> lit;
  std::uint8_t reflected = 0;
};

/// Compares the channels that are lit with those of the stripes at the samples' projector pixels.
/// \param only the region whose samples are compared; negative for all samples.
Score compare(const SeenSamples& seen, const std::vector<float>& pixels,
              const StripeColors& stripes, const std::vector<TintedSurfaces::Channels>& colors,
              int only) {
  Score score;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (only >= 0 && seen.samples[i].region != only) continue;
    if (std::isnan(pixels[i])) {  // not on the panel
      score.compared += std::popcount(seen.reflected);
      score.failed += std::popcount(seen.reflected);
      continue;
    }
    const int color = stripes.color(pixels[i]);
    if (color < 0) continue;
    const TintedSurfaces::Channels& expected = colors[static_cast<std::size_t>(color)];
    const unsigned looked_at = seen.reflected & expected.known;
    score.compared += std::popcount(looked_at);
    score.failed += std::popcount((seen.lit[i] ^ expected.lit) & looked_at);
  }
  return score;
}

/// A number of turns, the samples' projector pixels across the stripes, and how they fit.
struct Candidate {
  int turns = 0;
  Score score{};
  std::vector<float> pixels{};
};

/// The number of turns that fits best, if it is clear.
std::optional<Candidate> best_turns(const SeenSamples& seen, const DecoderGeometry& model,
                                    const StripeColors& stripes,
                                    const std::vector<TintedSurfaces::Channels>& colors,
                                    double observations) {
  const auto [low, high] = model.turns_on_panel(seen.phases[seen.phases.size() / 2]);
  Candidate best{.score = {1, 1}};
  double second = 1;
  for (int turns = low; turns <= high; ++turns) {
    Candidate one{.turns = turns};
    model.stripes_at_phases(seen.phases, turns, one.pixels);
    one.score = compare(seen, one.pixels, stripes, colors, -1);
    if (one.score.share() < best.score.share()) std::swap(one, best);
    second = std::min(second, one.score.share());
  }
  const double margin = second - best.score.share();
  const double information = std::log((1 - kFailureChance) / kFailureChance);
  const bool clear =
      margin >= kClearMargin && margin * observations * information >= std::log(kClearRatio);
  if (best.pixels.empty() || best.score.share() > kFailingInGroup || !clear) return std::nullopt;
  return best;
}

/// The reflectance of a group's surface. Only from pixels whose whole window lies in their region.
LargestModulation largest_modulation(const Regions& regions, const JoinedRegions& joined,
                                     const RegionGroup& group,
                                     const std::vector<Demodulated>& channels, const Reach& window,
                                     double across) {
  const Labels& label = regions.label;
  LargestModulation largest(label.rows(), label.cols(), across);
  const auto inner = [&](long row, long column) {
    const long top = std::max(0L, row - window.rows);
    const long bottom = std::min(label.rows() - 1, row + window.rows);
    const long left = std::max(0L, column - window.columns);
    const long right = std::min(label.cols() - 1, column + window.columns);
    const int here = label(row, column);
    for (const long r : {top, row, bottom}) {
      for (const long c : {left, column, right}) {
        if (label(r, c) != here) return false;
      }
    }
    return true;
  };
  for_each_pixel(regions, joined, group, [&](long row, long column) {
    if (inner(row, column)) largest.add(row, column, channels);
  });
  largest.finish();
  return largest;
}

SeenSamples see(std::vector<RegionSample> samples, const LargestModulation& largest,
                const std::vector<Demodulated>& channels) {
  SeenSamples seen{
      .samples = std::move(samples), .phases = {}, .lit = {}, .reflected = largest.reflected()};
  for (const RegionSample& sample : seen.samples) {
    seen.phases.push_back({.row = sample.row, .column = sample.column, .phase = sample.phase});
    seen.lit.push_back(largest.lit(sample.row, sample.column, channels));
  }
  return seen;
}

std::vector<long> region_sizes(const Regions& regions) {
  std::vector<long> sizes(static_cast<std::size_t>(regions.count), 0);
  for (long i = 0; i < regions.label.size(); ++i) {
    const int label = regions.label.data()[i];
    if (label >= 0) ++sizes[static_cast<std::size_t>(label)];
  }
  return sizes;
}

}  // namespace

TintedSurfaces::TintedSurfaces(const DecoderGeometry& model, const HueClassifier& classifier)
    : stripes_(model.pattern(), kTintMargin),
      stripe_px_(stripe_width(model.carrier(), model.pattern())) {
  const Pattern& pattern = model.pattern();
  for (const PatternColor& color : pattern.colors) {
    Channels channels;
    const std::array<double, kColorChannels> values{color.rgb[1], color.rgb[0], color.rgb[2]};
    for (std::size_t c = 0; c < kColorChannels; ++c) {
      const auto bit = static_cast<std::uint8_t>(1U << c);
      // Twice as far from the limits as a channel that is just lit or dark.
      const bool dark = values[c] <= static_cast<double>(LargestModulation::kDark) / 2;
      const bool lit = values[c] >= 2 * static_cast<double>(LargestModulation::kLit);
      if (dark || lit) channels.known |= bit;
      if (lit) channels.lit |= bit;
    }
    colors_.push_back(channels);
  }
  for (int color = 0; color < classifier.colors(); ++color) {
    float best = -1;
    float of_best = 0;
    for (int step = 0; step < HueClassifier::kSteps; ++step) {
      const float hue = 2 * std::numbers::pi_v<float> * (static_cast<float>(step) + 0.5F) /
                        static_cast<float>(HueClassifier::kSteps);
      const float probability = classifier.probabilities(hue)[color];
      if (probability <= best) continue;
      best = probability;
      of_best = hue;
    }
    hues_.push_back(of_best);
  }
}

std::vector<std::uint8_t> TintedSurfaces::open_regions(
    const Plane& hue, const HueClassifier& classifier, const StripeColors& stripes,
    const DecoderGeometry& model, const Regions& regions, const std::vector<RegionOffset>& offsets,
    const std::vector<long>& sizes) const {
  // Decides if the hues contradict the offset of a region.
  std::vector<PhaseGuess> places;
  std::vector<int> labels;
  for (long row = kHueSpacing / 2; row < hue.rows(); row += kHueSpacing) {
    for (long column = kHueSpacing / 2; column < hue.cols(); column += kHueSpacing) {
      const int label = regions.label(row, column);
      if (label < 0 || !offsets[static_cast<std::size_t>(label)].phase) continue;
      places.push_back({.row = static_cast<int>(row),
                        .column = static_cast<int>(column),
                        .phase = static_cast<double>(regions.phase(row, column)) +
                                 *offsets[static_cast<std::size_t>(label)].phase});
      labels.push_back(label);
    }
  }
  std::vector<float> pixels;
  model.stripes_at_phases(places, 0, pixels);
  std::vector<long> compared(offsets.size(), 0);
  std::vector<long> agreeing(offsets.size(), 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const int color = stripes.color(pixels[i]);
    if (color < 0) continue;
    const auto label = static_cast<std::size_t>(labels[i]);
    ++compared[label];
    agreeing[label] += classifier.best(hue(places[i].row, places[i].column)) == color ? 1 : 0;
  }
  std::vector<std::uint8_t> open(offsets.size(), 0);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const bool contradicted =
        compared[i] >= kLeastSampledHues &&
        static_cast<double>(agreeing[i]) < kAgreeingHues * static_cast<double>(compared[i]);
    open[i] = sizes[i] >= kLeastTinted && (!offsets[i].phase || contradicted) ? 1 : 0;
  }
  return open;
}

void TintedSurfaces::solve(const std::vector<Demodulated>& channels, const Plane& hue,
                           const HueClassifier& classifier, const StripeColors& stripes,
                           const DecoderGeometry& model, const Reach& window,
                           const Regions& regions, std::vector<RegionOffset>& offsets,
                           Seen& seen) const {
  seen.any = false;
  const std::vector<std::uint8_t> open =
      open_regions(hue, classifier, stripes, model, regions, offsets, region_sizes(regions));
  if (std::none_of(open.begin(), open.end(), [](std::uint8_t one) { return one != 0; })) return;
  const int max_gap = static_cast<int>(kGapStripes * stripe_px_);
  JoinedRegions joined;
  join_regions(regions, open, max_gap, joined);
  for (const RegionGroup& group : region_groups(regions, joined)) {
    const LargestModulation largest =
        largest_modulation(regions, joined, group, channels, window, kSearchedStripes * stripe_px_);
    const SeenSamples samples =
        see(sample_group(regions, joined, group, max_gap), largest, channels);
    if (samples.samples.empty()) continue;
    const double observations = static_cast<double>(group.pixels) / (stripe_px_ * stripe_px_);
    const auto best = best_turns(samples, model, stripes_, colors_, observations);
    if (!best) continue;
    std::vector<std::uint8_t> solved(offsets.size(), 0);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      if (joined.group[i] != group.number) continue;
      const Score score = compare(samples, best->pixels, stripes_, colors_, static_cast<int>(i));
      if (score.share() > kFailingInRegion) continue;
      offsets[i] = {kFullTurn * (best->turns + joined.turns[i]), Reason::reconstructed};
      solved[i] = 1;
    }
    if (!seen.any) {
      for (Mask* const mask : {&seen.lit, &seen.known, &seen.single}) {
        mask->setZero(regions.label.rows(), regions.label.cols());
      }
      seen.any = true;
    }
    const std::uint8_t single = largest.single() ? 1 : 0;
    for_each_pixel(regions, joined, group, [&](long row, long column) {
      if (solved[static_cast<std::size_t>(regions.label(row, column))] == 0) return;
      seen.lit(row, column) = largest.lit(row, column, channels);
      seen.known(row, column) = largest.reflected();
      seen.single(row, column) = single;
    });
  }
}

void TintedSurfaces::correct_hues(const Seen& seen, const Plane& stripe_pixel,
                                  const StripeColors& stripes, Plane& hue) const {
  for (long i = 0; i < hue.size(); ++i) {
    if (seen.known.data()[i] == 0) continue;
    const int color = stripes.color(stripe_pixel.data()[i]);
    if (color < 0) continue;
    const auto at = static_cast<std::size_t>(color);
    const unsigned differing =
        (seen.lit.data()[i] ^ colors_[at].lit) & colors_[at].known & seen.known.data()[i];
    if (differing == 0) hue.data()[i] = hues_[at];
  }
}

}  // namespace palpate::sensing
