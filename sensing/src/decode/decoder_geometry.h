// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "decode/surface_rows.h"
#include "palpate/sensing/reason.h"
#include "phase/chromatic.h"
#include "regions/phase_offset.h"
#include "regions/stripe_transitions.h"
#include "setup/carrier.h"
#include "setup/triangulation.h"

namespace palpate::sensing {

/// Results of converting an image of phases; NaN where unknown.
struct SurfaceImages {
  Plane z;             ///< [mm]
  Plane stripe_pixel;  ///< projector pixel across the stripes
  Plane z_per_phase;   ///< [mm/rad] |dz / dphase|
};

/// Everything that a rig and a pattern determine for each pixel of the working image, computed
/// once.
///
/// The working image is the camera's, transposed if the sinusoid varies along its rows. "Phase" is
/// the absolute phase of the pattern minus the carrier: 2 pi pixel / period + phase - carrier.along
/// * row.
class DecoderGeometry {
 public:
  /// \throws InvalidInput if rig or pattern are not valid or the two views do not overlap.
  DecoderGeometry(const Rig& rig, const Pattern& pattern);
  /// The same for a part of the working image: rows, columns and phases are those of the part. The
  /// rig stays that of the whole image.
  DecoderGeometry(const DecoderGeometry& whole, const ImagePart& part);

  [[nodiscard]] const Rig& rig() const { return rig_; }
  [[nodiscard]] const Pattern& pattern() const { return pattern_; }
  [[nodiscard]] const Carrier& carrier() const { return carrier_; }
  [[nodiscard]] const ChromaticModel& chromatic() const { return chromatic_; }
  [[nodiscard]] long rows() const { return rows_; }
  [[nodiscard]] long columns() const { return columns_; }

  /// Phase at a known depth. Empty if the projector does not light that point.
  [[nodiscard]] std::optional<double> phase_at_depth(long row, long column, double z) const;

  /// Phases at stripe edges, without those at which the projector would not light the surface.
  void phases_at_edges(const std::vector<Transition>& transitions,
                       std::vector<PhaseGuess>& guesses) const;

  /// The first and the last number of turns to be added to a phase for it to lie on the panel.
  [[nodiscard]] std::pair<int, int> turns_on_panel(const PhaseGuess& guess) const;

  /// Projector pixels across the stripes that phases imply; NaN where the projector would not light
  /// the surface.
  /// \param turns multiple of 2 pi added to all phases.
  void stripes_at_phases(const std::vector<PhaseGuess>& phases, int turns,
                         std::vector<float>& pixels) const;

  /// Computes depth and projector pixel of each phase. A pixel that is still `reconstructed`
  /// becomes `off_panel` if the projector does not light the point, or `grazing` if |dz / dphase| >
  /// max_sensitivity * z per rad, which happens close to the line where the phase does not depend
  /// on the depth (where Eq. 3.11 divides by zero).
  /// \param phase NaN where unknown.
  void find_surfaces(const Plane& phase, const ChannelShares& shares, double max_sensitivity,
                     SurfaceImages& surfaces, ReasonImage& reasons) const;

 private:
  /// R (x, y, 1) of every pixel's ray, in projector coordinates along the axes of the pattern.
  struct Rays {
    Plane along;   ///< the axis of the sinusoid
    Plane across;  ///< the other axis, along which the stripes follow each other
    Plane forward;
  };

  /// A pixel of the working image and one coordinate of the projector pixel that lights it.
  struct AxisPixel {
    long row = 0;
    long column = 0;
    float pixel = 0;
  };

  [[nodiscard]] Eigen::Vector3d direction(long row, long column) const;
  void prepare_chromatic(const Eigen::Matrix2Xd& rays);
  [[nodiscard]] double phase_of(double pixel, long row) const;
  void find_other_pixels(int axis, const std::vector<AxisPixel>& places,
                         std::vector<float>& pixels) const;

  Rig rig_;
  Pattern pattern_;
  Triangulation triangulation_;
  Carrier carrier_;
  long rows_ = 0;
  long columns_ = 0;
  int axis_ = 0;  ///< of the sinusoid in projector pixels
  Rays rays_;
  ChromaticModel chromatic_;
};

}  // namespace palpate::sensing
