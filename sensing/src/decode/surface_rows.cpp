// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/surface_rows.h"

#include <cmath>

#include "image/hot_loop.h"
#include "image/image_plane.h"
#include "palpate/sensing/reason.h"

namespace palpate::sensing {
namespace {

constexpr auto kReconstructed = static_cast<std::int32_t>(Reason::reconstructed);
constexpr auto kOffPanel = static_cast<std::int32_t>(Reason::off_panel);
constexpr auto kGrazing = static_cast<std::int32_t>(Reason::grazing);

/// Newton's method squares the error in each step: from 0.1, above the distortion of any lens, to
/// rounding.
constexpr int kNewtonSteps = 4;
/// Its last step must be smaller than this [normalised]: 20 times the rounding of the coordinates.
constexpr float kMaxLastStep = 1e-6F;

/// Along the epipolar line of a ray, across = start + slope * along; k is the determinant of the
/// rays' and the baseline's coordinates along and forward, zero on the singular line.
struct EpipolarLine {
  float k;
  float start;
  float slope;
};

[[gnu::always_inline]] inline EpipolarLine epipolar_line(const SurfaceRow& row,
                                                         const SurfaceConstants& c, long i) {
  const float k = c.t_along * row.forward[i] - c.t_forward * row.along[i];
  const float inverse = 1 / k;
  return {k, (c.t_along * row.across[i] - c.t_across * row.along[i]) * inverse,
          (c.t_across * row.forward[i] - c.t_forward * row.across[i]) * inverse};
}

/// Normalised coordinate, along the axis, of a pixel's phase. The lags hold at the expected pixel;
/// once the projector pixel is known, they are corrected for the change of the phase of the
/// channels' sum (to first order in the lags, which are small).
[[gnu::always_inline]] inline float along_of_phase(const SurfaceRow& row, const SurfaceConstants& c,
                                                   long i) {
  const float along = row.phase[i] * c.along_per_phase + row.along_at_zero_phase;
  const float moved = along - (row.expected[i] * c.along_per_pixel + c.along_offset);
  return along + moved * (row.red[i] * c.lag_red + row.blue[i] * c.lag_blue);
}

/// Writes the results of a pixel.
/// \param along position on the panel; `straight` without lens distortion, whose derivative is
/// `stretch`.
/// \param across position on the panel.
/// \param known whether these values are valid.
[[gnu::always_inline]] inline void write_surface(const SurfaceRow& row, const SurfaceConstants& c,
                                                 long i, float k, float along, float straight,
                                                 float stretch, float across, bool known) {
  const float divisor = straight * row.forward[i] - row.along[i];
  const float z = (c.t_along - straight * c.t_forward) / divisor;
  const float pixel = across * c.focal_across_px + c.center_across_px;
  const float z_per_phase = std::abs(k * c.along_per_phase / (divisor * divisor * stretch));
  // In front of both instruments: the depth from the projector is k / divisor.
  const bool lit = known & (z > 0) & (k * divisor > 0) & (along >= c.first_along) &
                   (along <= c.last_along) & (pixel >= c.first_across_px) &
                   (pixel <= c.last_across_px);
  const bool sharp = z_per_phase <= c.max_sensitivity * z;
  const bool good = lit & sharp;
  row.z[i] = good ? z : kUnknown;
  row.stripe_pixel[i] = good ? pixel : kUnknown;
  row.z_per_phase[i] = good ? z_per_phase : kUnknown;
  row.reason[i] = good ? kReconstructed : (lit ? kGrazing : kOffPanel);
}

PALPATE_HOT_LOOP void find_row(const SurfaceRow& row, const SurfaceConstants& constants) {
  // Copies and ivdep, because nothing that is written is read.
  const SurfaceRow r = row;
  const SurfaceConstants c = constants;
  PALPATE_INDEPENDENT_PASSES
  for (long i = 0; i < r.columns; ++i) {
    const EpipolarLine line = epipolar_line(r, c, i);
    const float along = along_of_phase(r, c, i);
    write_surface(r, c, i, line.k, along, along, 1, line.start + line.slope * along, true);
  }
}

PALPATE_HOT_LOOP void find_row_through_lens(const SurfaceRow& row,
                                            const SurfaceConstants& constants) {
  const SurfaceRow r = row;
  const SurfaceConstants c = constants;
  const auto& [k1, k2, bend_along, bend_across, k3, k4, k5, k6] = c.distortion;
  PALPATE_INDEPENDENT_PASSES
  for (long i = 0; i < r.columns; ++i) {
    const EpipolarLine line = epipolar_line(r, c, i);
    const float along = along_of_phase(r, c, i);
    float y = along;  // without the lens
    float move = 0;
    float stretch = 0;  // d along / d y on the line
    float across = 0;
#pragma GCC unroll 4
    for (int step = 0; step < kNewtonSteps; ++step) {
      const float x = line.start + line.slope * y;
      const float r2 = x * x + y * y;
      const float numerator = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
      const float denominator = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
      const float scale = 1 / denominator;
      const float radial = numerator * scale;
      const float radial_slope =
          (k1 + r2 * (2 * k2 + r2 * (3 * k3)) - radial * (k4 + r2 * (2 * k5 + r2 * (3 * k6)))) *
          scale;
      const float dy_dy =
          radial + 2 * y * y * radial_slope + 6 * bend_along * y + 2 * bend_across * x;
      const float dy_dx = 2 * x * y * radial_slope + 2 * bend_along * x + 2 * bend_across * y;
      stretch = dy_dy + dy_dx * line.slope;
      const float seen = y * radial + bend_along * (r2 + 2 * y * y) + 2 * bend_across * x * y;
      across = x * radial + 2 * bend_along * x * y + bend_across * (r2 + 2 * x * x);
      move = (along - seen) / stretch;
      y += move;
    }
    const bool converged = (std::abs(move) <= kMaxLastStep) & (stretch > 0);
    write_surface(r, c, i, line.k, along, y, stretch, across, converged);
  }
}

}  // namespace

void find_surface(const SurfaceRow& row, const SurfaceConstants& constants) {
  find_row(row, constants);
}

void find_surface_through_lens(const SurfaceRow& row, const SurfaceConstants& constants) {
  find_row_through_lens(row, constants);
}

}  // namespace palpate::sensing
