// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// A depth is wrong (a gross error) if it differs from the true depth by more than this fraction
/// of it, or there is no surface. Losing one period of a pattern causes an error a few times as
/// large.
inline constexpr double kWrongDepth = 0.01;

/// Some pixels of an image: row 0 is at the top.
using PixelMask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Coverage and errors of a measured range map relative to the truth. All figures of Palpate about
/// the accuracy of range maps have these definitions.
struct RangeMapScore {
  double distance = 0;             ///< [mm] median true depth; NaN if no depth is known
  long measurable = 0;             ///< pixels of the mask whose true depth is known
  long covered = 0;                ///< measurable pixels with a depth, right or wrong
  double coverage = 0;             ///< covered / measurable; NaN if no pixel is measurable
  long measured = 0;               ///< pixels of the whole image with a depth
  long wrong = 0;                  ///< measured pixels whose depth is wrong, see `kWrongDepth`
  double wrong_share = 0;          ///< wrong / measured; NaN if no pixel has a depth
  ErrorStatistics error;           ///< [mm] measured minus true depth of the other measured pixels
  ErrorStatistics relative_error;  ///< the same, each as a fraction of the true depth
  ImageF difference;               ///< [mm] the same as an image; NaN at all other pixels
  PixelMask wrong_pixels;          ///< true where the depth is wrong
};

/// Scores a measured range map.
/// \param truth       [mm] true depths; NaN where there is no surface.
/// \param measurable  where a sensor can measure, for example the pixels that are lit.
/// \throws InvalidInput unless all have the same size.
[[nodiscard]] RangeMapScore score_range_map(const ImageF& measured, const ImageF& truth,
                                            const PixelMask& measurable);

/// The same with all pixels of the image as mask.
[[nodiscard]] RangeMapScore score_range_map(const ImageF& measured, const ImageF& truth);

}  // namespace palpate::geometry
