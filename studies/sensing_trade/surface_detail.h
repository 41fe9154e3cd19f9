// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene.h"

namespace palpate::bench {

/// Errors that show in the picture of a surface, where noise alone would be invisible.
class SurfaceDetail {
 public:
  /// \param difference [mm] measured minus true depth, NaN where there is no depth or a wrong one.
  void add(const Scene& scene, const View& view, const geometry::ImageF& difference);

  /// [%] of the distance: root mean square of the part of the depth error that repeats with each
  /// period of the sinusoid on the surface. In windows of about three periods along the sinusoid, a
  /// cubic and the first two harmonics of the true phase are fitted to the relative errors; the
  /// first harmonic counts. NaN if no window is complete.
  [[nodiscard]] double ripple() const;
  /// [degrees] Median angle between the normals of both depths, each from the pixels two rows and
  /// two columns away.
  [[nodiscard]] double normals() const;

 private:
  double squares_ = 0;
  long windows_ = 0;
  std::vector<double> angles_;  ///< [degrees]
};

}  // namespace palpate::bench
