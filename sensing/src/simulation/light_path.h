// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "simulation/virtual_scene.h"

namespace palpate::sensing {

/// What the projector's white does to a place that the camera sees.
struct Illumination {
  bool covered = false;            ///< the projector's image, in green, reaches the place
  bool lit = false;                ///< and nothing is in between
  Eigen::Vector2d pixel{0, 0};     ///< px of the panel, in green; iff covered
  double diffuse = 0;              ///< light that a white surface gives back; 0 unless lit
  double highlight = 0;            ///< light of any surface's gloss; 0 unless lit
  double projector_incidence = 0;  ///< [rad] angle of the normal to the light
};

/// From the projector's panel to places in the scene.
class LightPath {
 public:
  LightPath(const Rig& rig, Axis axis, double falloff);

  [[nodiscard]] Illumination illuminate(const VirtualScene& scene, const SurfaceView& place) const;

  /// Where another colour's panel point is whose light goes where green's of `pixel` does; none if
  /// it is not on the panel.
  [[nodiscard]] std::optional<Eigen::Vector2d> shifted(const Eigen::Vector2d& pixel,
                                                       const ChromaticShift& shift) const;

 private:
  [[nodiscard]] std::optional<Eigen::Vector2d> panel_pixel(const Eigen::Vector3d& place) const;
  [[nodiscard]] bool on_panel(const Eigen::Vector2d& pixel) const;

  Rig rig_;
  int axis_;
  double falloff_;
  bool distorted_;
  Eigen::Vector3d origin_;  ///< [mm] the projector's, camera frame
};

}  // namespace palpate::sensing
