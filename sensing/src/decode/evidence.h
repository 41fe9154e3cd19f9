// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "colors/hue_classifier.h"
#include "decode/decoder_geometry.h"
#include "decode/workspace.h"
#include "palpate/sensing/decode_verdict.h"
#include "palpate/sensing/trained_colors.h"
#include "regions/stripe_transitions.h"

namespace palpate::sensing {

/// The motion of stripe edges in the image with the depth.
struct EdgeMotion {
  double per_period = 0;  ///< [px] for a depth that changes the sinusoid by a period
  double disparity =
      0;  ///< [px mm] times the inverse depth: the distance from the edge at infinity
};

/// Collects the evidence of a decoded frame about its rig, pattern and colours.
class EvidenceFinder {
 public:
  /// \pre the pattern has stripes, and its colours are trained.
  EvidenceFinder(const DecoderGeometry& model, const TrainedColors& colors);

  /// \param work of a frame that has been decoded up to its depths.
  /// \param whole of the whole working image.
  [[nodiscard]] DecodeEvidence find(const Workspace& work, const DecoderGeometry& whole) const;

 private:
  /// Hues that count as one of the trained colours.
  struct Hues {
    float mean = 0;
    float reach = 0;  ///< [rad]
  };
  /// The correction of a frame for which an explanation holds.
  struct Change {
    std::vector<int> color;  ///< the true one of each seen colour; empty if there is none
    bool exchange = false;   ///< left and right side of an edge
    bool reverse = false;    ///< the pattern's stripes
    bool mirror = false;     ///< the working image's columns
    bool flip = false;       ///< the working image's rows
    double turns = 0;        ///< to be added to d
  };

  /// A stripe edge and the phase there.
  struct Comparison {
    int row = 0;
    int column = 0;  ///< of the pixel before the edge
    int edge = 0;
    double turns = 0;  ///< d, including whole periods
  };

  [[nodiscard]] bool has_hue(float hue, int color) const;
  [[nodiscard]] std::vector<Transition> trusted_edges(const Workspace& work) const;
  /// Returns the edges after a change, at their new places in the whole image.
  [[nodiscard]] std::vector<Transition> changed(const std::vector<Transition>& edges,
                                                const Change& change, const ImagePart& part,
                                                const DecoderGeometry& whole) const;
  [[nodiscard]] std::vector<Comparison> compared(const std::vector<Transition>& edges,
                                                 const Workspace& work,
                                                 const DecoderGeometry& whole) const;
  void compare(const std::vector<Transition>& edges, const Workspace& work,
               const DecoderGeometry& whole, DecodeEvidence& evidence) const;
  /// \param z [mm] there; NaN where unknown.
  void add_to_trend(const Comparison& one, double z, DepthTrend& trend) const;
  [[nodiscard]] double explained(const std::vector<Transition>& edges, const Change& change,
                                 const Workspace& work, const DecoderGeometry& whole) const;

  std::vector<int> stripes_;
  StripeEdges by_colors_;
  std::vector<Hues> hues_;
  std::array<std::uint8_t, HueClassifier::kSteps> trained_{};  ///< 1 where a hue is one of them
  std::array<Change, kFrameExplanations> changes_;
  bool colors_fit_ = true;
  EdgeMotion motion_;
};

}  // namespace palpate::sensing
