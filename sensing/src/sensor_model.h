// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "carrier.h"
#include "chromatic.h"
#include "phase_offset.h"
#include "triangulation.h"

namespace palpate::sensing {

/// What a rig and a pattern say about every pixel of the working image, computed once.
///
/// The working image is the camera's, transposed if the sinusoid varies along its rows. "Phase" is
/// the absolute phase of the pattern with the carrier taken out: 2 pi pixel / period + phase -
/// carrier.along * row.
class SensorModel {
 public:
  /// \throws InvalidInput if rig or pattern are not valid or the two views do not overlap.
  SensorModel(const Rig& rig, const Pattern& pattern);

  [[nodiscard]] const Rig& rig() const { return rig_; }
  [[nodiscard]] const Pattern& pattern() const { return pattern_; }
  [[nodiscard]] const Carrier& carrier() const { return carrier_; }
  [[nodiscard]] const ChromaticModel& chromatic() const { return chromatic_; }
  [[nodiscard]] long rows() const { return rows_; }
  [[nodiscard]] long columns() const { return columns_; }

  /// Phase where a depth is known. Nothing if the projector does not light that point.
  [[nodiscard]] std::optional<double> phase_at_depth(long row, long column, double z) const;
  /// Phase at a stripe edge of the pattern. Nothing if the projector does not light that point.
  [[nodiscard]] std::optional<double> phase_at_edge(long row, long column, int edge) const;

  /// Depth and projector pixel of a phase.
  struct Surface {
    double z = 0;
    Eigen::Vector2d pixel;
    Reason reason = Reason::reconstructed;
  };
  /// `off_panel` if the projector does not light the point; `grazing` if |dz / dphase| >
  /// max_sensitivity * z per rad: near the line on which the phase says nothing of the depth
  /// (Eq. 3.11 divides by zero there).
  [[nodiscard]] Surface surface_at(long row, long column, double phase, const ChannelShares& shares,
                                   double max_sensitivity) const;

 private:
  [[nodiscard]] Eigen::Vector3d direction(long row, long column) const {
    return directions_.col(row * columns_ + column);
  }
  void prepare_chromatic(const Eigen::Matrix2Xd& rays);

  Rig rig_;
  Pattern pattern_;
  Triangulation triangulation_;
  Carrier carrier_;
  long rows_ = 0;
  long columns_ = 0;
  int axis_ = 0;  ///< of the sinusoid in projector pixels
  /// Of the rays, in projector coordinates, row after row of the working image.
  Eigen::Matrix3Xd directions_;
  ChromaticModel chromatic_;
};

}  // namespace palpate::sensing
