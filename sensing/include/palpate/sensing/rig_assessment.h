// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <numbers>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "palpate/geometry/range_map_score.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {

struct AssessmentOptions {
  /// Only so many bodies count, the first ones; the others are scenery. > 0; not given: all.
  std::optional<int> counted_bodies = {};
  /// A place faces both lenses iff its incidence is <= max_incidence [rad]; in (0, pi/2].
  double max_incidence = 65 * std::numbers::pi / 180;
  /// A depth is wrong iff it is off by more than this fraction of the true one; > 0. A multiple of
  /// the period is lost by a few times as much.
  double wrong_depth = 0.01;
};

/// What of the bodies was measured, in pixels, and how well. visible = outside + dark + lit.
struct RigAssessment {
  double distance = 0;     ///< [mm] median true depth of the visible pixels; NaN without any
  long visible = 0;        ///< pixels that see a body
  long outside = 0;        ///< of these, those whose place the projector's image does not reach
  long dark = 0;           ///< it would, but a surface is in between, or the place faces away
  long lit = 0;            ///< of the visible ones
  long reconstructed = 0;  ///< of the lit ones, those with a depth
  long facing = 0;         ///< of the lit ones, those that face both lenses
  long facing_reconstructed = 0;
  std::array<long, kReasonCount> reasons{};  ///< what became of the lit ones, by `Reason`
  long stray = 0;                            ///< pixels with a depth where no body is
  long measured = 0;                         ///< visible pixels with a depth, lit or not
  long wrong = 0;                            ///< of these, those whose depth is wrong
  geometry::ErrorStatistics error;           ///< [mm] of the measured ones that are not wrong
  geometry::ImageF difference;  ///< [mm] measured minus true depth; NaN where either is unknown
};

/// \throws InvalidInput unless both are of the same size, or an option is outside its range.
[[nodiscard]] RigAssessment assess(const DecodeResult& decoded, const SceneTruth& truth,
                                   const AssessmentOptions& options = {});

/// A measurement from end to end, in simulation.
struct RigTrial {
  Simulation simulation;              ///< its first frame is that of the pattern ...
  std::vector<NamedImages> training;  ///< ... and the others are here, one a colour of the pattern
  TrainedColors colors;               ///< from these
  std::optional<DecodeResult> decoded;  ///< none if the object is not seen or the colours not read
  std::string failure;                  ///< why not; else empty
};

struct ShotOptions {
  bool training = true;           ///< also each colour of the pattern alone
  std::uint64_t first_frame = 0;  ///< number of the first frame, for the noise
};

/// What the camera sees of the bodies under the pattern, and under each of its colours alone:
/// `simulation` and `training`, the first half of `try_rig`.
/// \param panel  the pattern as the projector shows it, as for `simulate`.
/// \throws InvalidInput as `simulate`, or if the pattern is not valid.
[[nodiscard]] RigTrial simulate_shot(const Rig& rig, const Pattern& pattern, const cv::Mat& panel,
                                     std::span<const Body> bodies, const VirtualSensor& sensor,
                                     const ShotOptions& options = {});

struct TrialOptions {
  DecodeOptions decode = {};
  /// What the decoder takes the rig to be: for a pattern that was drawn for the projector's pose or
  /// lens, or against its chromatic aberration. Not given: as it is.
  std::optional<Rig> decoder_rig = {};
  std::uint64_t first_frame = 0;  ///< number of the first frame, for the noise
};

/// Does what a user of the rig does: projects the pattern and each of its colours alone on the
/// bodies, trains the colours with these images, and decodes the pattern's. A pattern without
/// stripes gets the lit pixel that is nearest to the middle of the image as its anchor.
/// \param panel  the pattern as the projector shows it, as for `simulate`.
/// Mosaics are demosaiced for training and decoding; `RigTrial` has them as they were read out.
/// \throws InvalidInput as `simulate` and `Decoder`.
[[nodiscard]] RigTrial try_rig(const Rig& rig, const Pattern& pattern, const cv::Mat& panel,
                               std::span<const Body> bodies, const VirtualSensor& sensor,
                               const TrialOptions& options = {});

/// Images of each colour of the pattern alone, for the projector: float, BGR.
[[nodiscard]] std::vector<cv::Mat> color_panels(const Pattern& pattern,
                                                const geometry::Camera& projector);

}  // namespace palpate::sensing
