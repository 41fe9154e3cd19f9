// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/rig_bundle.h"
#include "palpate/sensing/image_size.h"
#include "palpate/sensing/rig_view.h"

namespace palpate::sensing {

/// Result of the joint estimate, with its accuracy.
struct RigFit {
  Bundle bundle;
  std::vector<BundleView> views;  ///< with the weights of their points
  BundleOptions options;          ///< with the standard deviations of the points
};

/// Fits lenses, poses and noise to views, each of which has enough points: each lens alone first
/// (Zhang 2000), then all together, where points that fit badly lose weight.
/// \throws SolverError if the views do not determine a lens, naming it.
[[nodiscard]] RigFit fit_rig(const std::vector<RigView>& views, const ImageSize& camera,
                             const ImageSize& projector, int distortion_terms);

/// Weighted sums over all views.
struct Squares {
  double camera = 0, projector = 0;  ///< px^2
  double camera_points = 0, projector_points = 0;
};
[[nodiscard]] Squares sum_squares(const Bundle& bundle, const std::vector<BundleView>& views);

}  // namespace palpate::sensing
