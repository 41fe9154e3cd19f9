// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "colors/hue_classifier.h"
#include "decode/decoder_geometry.h"
#include "decode/plausibility.h"
#include "image/image_plane.h"
#include "phase/demodulation.h"
#include "regions/phase_offset.h"
#include "regions/unwrapping.h"

namespace palpate::sensing {

/// Offsets of regions on surfaces that have a colour of their own. Such a surface changes the hues
/// of the stripes or, if it reflects a single channel, leaves only light and dark ones. The set of
/// channels that a stripe lights, relative to the most that the surface reflects of each, stays.
///
/// Regions without an offset, and those whose hues contradict their offset, are joined across dark
/// stripes where their phases continue each other. For each number of turns that keeps a group on
/// the panel, the lit and dark channels that it predicts are compared with those that are seen.
class TintedSurfaces {
 public:
  TintedSurfaces(const DecoderGeometry& model, const HueClassifier& classifier);

  /// Channels seen at pixels of regions solved here: bit c of `lit` is set if channel c (green,
  /// red, blue) is lit, and bit c of `known` if the surface reflects it. Zero elsewhere.
  struct Seen {
    Mask lit;
    Mask known;
    Mask single;  ///< 1 where the surface reflects hardly more than one channel, and stripes look
                  ///< alike
    bool any = false;  ///< true if any region was solved; the masks are empty if not
  };

  /// Solves regions; an offset is kept unless the comparison gives another one clearly: any
  /// other number of turns fails in at least 5 % more of the comparisons, and its likelihood ratio
  /// is at least 1000 if a square of a stripe's width counts as one observation.
  /// \param window half the size of the demodulation window.
  void solve(const std::vector<Demodulated>& channels, const Plane& hue,
             const HueClassifier& classifier, const StripeColors& stripes,
             const DecoderGeometry& model, const Reach& window, const Regions& regions,
             std::vector<RegionOffset>& offsets, Seen& seen) const;

  /// Gives pixels seen by `solve` the hue of the stripe that their depth implies, if its channels
  /// are those that are lit. All others keep their hue.
  /// \param stripe_pixel projector pixel across the stripes; NaN where unknown.
  void correct_hues(const Seen& seen, const Plane& stripe_pixel, const StripeColors& stripes,
                    Plane& hue) const;

  /// The channels of a colour.
  struct Channels {
    std::uint8_t lit = 0;
    std::uint8_t known = 0;  ///< fully lit or dark
  };

 private:
  [[nodiscard]] std::vector<std::uint8_t> open_regions(
      const Plane& hue, const HueClassifier& classifier, const StripeColors& stripes,
      const DecoderGeometry& model, const Regions& regions,
      const std::vector<RegionOffset>& offsets, const std::vector<long>& sizes) const;

  std::vector<Channels> colors_;  ///< of the pattern
  std::vector<float> hues_;       ///< [rad] of each colour
  StripeColors stripes_;          ///< up to close to their edges
  double stripe_px_ = 0;          ///< width of a stripe in the working image [px]
};

}  // namespace palpate::sensing
