// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/probing/acquisition.h"

namespace palpate::bench {

/// Palpation as other laboratories record it: one direction a place, no friction. The object is a
/// curved plate over an elastic bed with a stiff inclusion: pressed by depth d along its normal it
/// gives k (d + d^2 / hardening), k = stiffness (1 + (contrast - 1) exp(-r^2 / 2 width^2)) e^w at a
/// distance r from the middle of the inclusion. w is a sum of random waves.
struct PressingKind {
  std::string name;
  double stiffness = 0.25, contrast = 4, width = 9, hardening = 6;  // N/mm, 1, mm, mm
  double waves = 0, wavelength = 25;     ///< standard deviation of w; [mm]
  double noise = 0.03;                   ///< [N] of each component
  double bias = 0.085;                   ///< [N] length of a constant error of the force
  double late = 0.4;                     ///< [mm] touches are found up to this much too deep
  double pitch = 5;                      ///< [mm] of places
  double side = 60;                      ///< [mm] of the square they fill
  double least_tilt = 0, most_tilt = 0;  ///< [degrees] of the pressing against the normal
  double dragged = 0.25;                 ///< of the force, across, times the tangent of the tilt
  double way_back = 0;  ///< share of the force that is missing on the way back; 0: not recorded
  int depths = 10;
  double step = 0.35;                                ///< [mm] of depth
  double position_digit = 1e-4, force_digit = 1e-4;  ///< [mm], [N] last digit recorded
  bool known_surface = true;  ///< otherwise the surface goes through the recorded places
};

/// The three kinds of the shared sets, and more.
[[nodiscard]] std::vector<PressingKind> pressing_kinds();

struct PressingSet {
  probing::Acquisition acquisition;
  geometry::TriangleMesh surface;
  std::vector<haptics::Query> truth;  ///< noise-free, along the normal, from the true surface
};
[[nodiscard]] PressingSet make_pressing_set(const PressingKind& kind, unsigned seed);

}  // namespace palpate::bench
