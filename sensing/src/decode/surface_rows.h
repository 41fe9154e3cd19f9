// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace palpate::sensing {

/// Constants in the computation of depths. "Along" is the axis of the sinusoid in the projector's
/// image, "across" the other one; normalised coordinates, translation in mm.
struct SurfaceConstants {
  float t_along = 0;  ///< from the camera to the projector, in projector coordinates
  float t_across = 0;
  float t_forward = 0;
  float first_along = 0;  ///< the panel's edges
  float last_along = 0;
  float first_across_px = 0;
  float last_across_px = 0;
  float focal_across_px = 0;
  float center_across_px = 0;
  float along_per_pixel = 0;  ///< normalised coordinate = along_per_pixel * pixel + along_offset
  float along_offset = 0;
  float along_per_phase = 0;  ///< [1/rad]
  float lag_red = 0;          ///< slopes of the chromatic lags, phase for phase; zero if the row
  float lag_blue = 0;         ///< has no shares
  float max_sensitivity = 0;  ///< see DecodeOptions
  /// Of the projector's lens: k1 k2, of p1 and p2 first the one that bends `along`, k3 k4 k5 k6.
  std::array<float, 8> distortion{};
};

/// A row of pixels. Unknown values are NaN.
struct SurfaceRow {
  const float* phase = nullptr;   ///< [rad] see DecoderGeometry; NaN gives `off_panel`
  float along_at_zero_phase = 0;  ///< normalised coordinate
  const float* along = nullptr;   ///< rays: R (x, y, 1)
  const float* across = nullptr;
  const float* forward = nullptr;
  const float* expected = nullptr;  ///< projector pixel at which the lags were taken
  const float* red = nullptr;       ///< channel shares; finite
  const float* blue = nullptr;
  float* z = nullptr;              ///< [mm]
  float* stripe_pixel = nullptr;   ///< projector pixel across the stripes
  float* z_per_phase = nullptr;    ///< [mm/rad] |dz / dphase|
  std::int32_t* reason = nullptr;  ///< reconstructed, off_panel or grazing
  long columns = 0;
};

/// Computes the depths of a row: the ray z d of a camera pixel meets the plane of one phase through
/// the projector's centre (Eq. 3.11 for any pose). In single precision, with relative errors of
/// about 1e-7 times z / baseline.
void find_surface(const SurfaceRow& row, const SurfaceConstants& constants);

/// The same for a projector with lens distortion, where the plane is curved. Uses Newton's method
/// along the epipolar line; gives `off_panel` also where it does not converge, as beyond a fold of
/// the lens.
void find_surface_through_lens(const SurfaceRow& row, const SurfaceConstants& constants);

}  // namespace palpate::sensing
