// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "simulation/virtual_scene.h"

namespace palpate::sensing {

/// Effect of the projector's white light at a place that the camera sees.
struct Illumination {
  bool covered = false;            ///< the place lies in the projector's image (green)
  bool lit = false;                ///< covered, and nothing blocks the light
  Eigen::Vector2d pixel{0, 0};     ///< px of the panel (green); valid if covered
  double diffuse = 0;              ///< light reflected by a white diffuse surface; 0 unless lit
  double highlight = 0;            ///< light of the specular highlight; 0 unless lit
  double projector_incidence = 0;  ///< [rad] angle of the normal to the light
};

/// The light path from the projector's panel to places in the scene.
class LightPath {
 public:
  LightPath(const Rig& rig, Axis axis, double falloff);

  [[nodiscard]] Illumination illuminate(const VirtualScene& scene, const SurfaceView& place) const;

  /// Panel pixel of another colour whose light goes to the same place as green's light from
  /// `pixel`; empty if it is not on the panel.
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
