// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/camera.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// A figure that is valid, but unlikely, or impossible with real lenses: mostly one in another
/// unit, or of another image.
struct Doubt {
  std::string subject;      ///< "camera", "projector", "t", "axis" or "depths"
  std::string message;      ///< in a sentence, with figures and the likely cause
  bool impossible = false;  ///< nothing useful can come of it
};

/// Judges whether a lens can show an image at these angles. It is unlikely that a corner of the
/// image is more than 65 degrees from the optical axis, that a principal point is outside the image
/// and more than 30 degrees from its middle, or that a whole image is narrower than 0.1 degrees; a
/// corner more than 80 degrees away is impossible.
/// \pre the camera is valid.
[[nodiscard]] std::vector<Doubt> camera_doubts(const geometry::Camera& camera);

/// Judges camera, projector and the distance between them, which is unlikely below 10 mm and above
/// 5 m, and impossible below 1 mm and above 50 m. The principal point of a projector may be
/// anywhere.
/// \pre the rig is valid.
[[nodiscard]] std::vector<Doubt> rig_doubts(const Rig& rig);

/// Judges whether a sinusoid without stripes shows steps of depth, which is unlikely if less than
/// half of the baseline lies along it: with `DecodeOptions::anchors`, there are then depths only if
/// the anchored regions hold most of the pixels, as a single smooth surface does.
/// \pre rig and pattern are valid.
[[nodiscard]] std::vector<Doubt> sinusoid_doubts(const Rig& rig, const Pattern& pattern);

/// Judges a typical depth [mm] of a scene, which is unlikely below 10 mm and above 100 m, and
/// impossible below 1 mm and above 10 km. NaN gives no doubt.
[[nodiscard]] std::vector<Doubt> depth_doubts(double depth);

/// Judges the camera of a range map, and the median of its depths.
/// \param mm_per_unit of the depth image that it comes from; the message then names the units with
/// which the depths would be usual ones.
[[nodiscard]] std::vector<Doubt> range_map_doubts(const geometry::RangeMap& map,
                                                  std::optional<double> mm_per_unit = {});

/// The messages of the impossible ones in one sentence; empty if there are none.
[[nodiscard]] std::string impossible_parts(const std::vector<Doubt>& doubts);

}  // namespace palpate::sensing
