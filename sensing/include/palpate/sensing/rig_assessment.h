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
  /// Only the first counted_bodies bodies are assessed; the others are scenery. > 0; default: all.
  std::optional<int> counted_bodies = {};
  /// A pixel faces both lenses if its incidence is <= max_incidence [rad]; in (0, pi/2].
  double max_incidence = 65 * std::numbers::pi / 180;
};

/// The coverage of the bodies, in pixels, and the errors of their depths.
/// visible = outside + dark + score.measurable.
struct RigAssessment {
  /// Coverage and errors; the lit pixels are the measurable ones. Pixels that see scenery do not
  /// count, whatever their depth.
  geometry::RangeMapScore score;
  long visible = 0;         ///< pixels that see a body
  long outside = 0;         ///< visible, but outside the projector's field of view
  long dark = 0;            ///< visible, within that field, but shadowed or facing away
  long facing = 0;          ///< lit pixels that face both lenses
  long facing_covered = 0;  ///< facing pixels with a depth
  std::array<long, kReasonCount> reasons{};  ///< outcome of the lit pixels, by `Reason`
  long stray = 0;  ///< of the wrong pixels, those that see no body and no scenery
};

/// Compares a decoded range map with the truth of the simulation.
/// \throws InvalidInput unless both have the same size and every option is in its range.
[[nodiscard]] RigAssessment assess(const DecodeResult& decoded, const SceneTruth& truth,
                                   const AssessmentOptions& options = {});

/// A simulated measurement from end to end.
struct RigTrial {
  Simulation simulation;                ///< its first frame shows the pattern
  std::vector<NamedImages> training;    ///< the other frames, one per colour of the pattern
  TrainedColors colors;                 ///< trained with `training`
  std::optional<DecodeResult> decoded;  ///< empty if the object is not seen or training failed
  std::string failure;                  ///< why `decoded` is empty; else empty
};

struct ShotOptions {
  bool training = true;           ///< also render each colour of the pattern alone
  std::uint64_t first_frame = 0;  ///< number of the first frame, for the noise
};

/// Renders what the camera sees of the bodies under the pattern and under each of its colours
/// alone. Fills `simulation` and `training`: the first half of `try_rig`.
/// \param panel  the pattern as the projector shows it, as for `simulate`.
/// \throws InvalidInput as `simulate`, or if the pattern is not valid.
[[nodiscard]] RigTrial simulate_shot(const Rig& rig, const Pattern& pattern, const cv::Mat& panel,
                                     std::span<const Body> bodies, const VirtualSensor& sensor,
                                     const ShotOptions& options = {});

struct TrialOptions {
  DecodeOptions decode = {};
  /// The rig that the decoder assumes, if it differs from the simulated one: when the pattern was
  /// drawn to compensate the projector's pose, lens or chromatic aberration. Default: the same rig.
  std::optional<Rig> decoder_rig = {};
  std::uint64_t first_frame = 0;  ///< number of the first frame, for the noise
};

/// Simulates a whole measurement: projects the pattern and each of its colours alone onto the
/// bodies, trains the colours with these images, and decodes the image of the pattern. If the
/// pattern has no stripes, the lit pixel nearest to the image centre becomes its anchor. Mosaics
/// are demosaiced for training and decoding, but stored in `RigTrial` as read out.
/// \param panel  the pattern as the projector shows it, as for `simulate`.
/// \throws InvalidInput as `simulate` and `Decoder`.
[[nodiscard]] RigTrial try_rig(const Rig& rig, const Pattern& pattern, const cv::Mat& panel,
                               std::span<const Body> bodies, const VirtualSensor& sensor,
                               const TrialOptions& options = {});

/// Draws each colour of the pattern alone as an image for the projector: float, BGR.
[[nodiscard]] std::vector<cv::Mat> color_panels(const Pattern& pattern,
                                                const geometry::Camera& projector);

}  // namespace palpate::sensing
