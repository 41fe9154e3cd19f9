// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "placement/touch_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "palpate/geometry/mesh_measures.h"
#include "placement/length_units.h"

namespace palpate::probing {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Without a start pose, the middle of the touches is searched within this share of the surface's
/// diagonal around its middle.
constexpr double kMiddle = 0.1;

/// Touches that extend over less than 1/20 of the surface, or more than 4 times as far, are in
/// another unit, or not touches of this surface.
constexpr double kTooSmall = 0.05, kTooLarge = 4;

/// Share of the extent of the surface that touches usually cover: with another unit it tells which.
constexpr double kLeastCovered = 0.1, kMostCovered = 1.5;

/// [mm] Touches farther from the surface (RMS) are not only noise.
constexpr double kSuspiciousRms = 0.3;
/// Share of the touches that lie on the surface if nothing is wrong.
constexpr double kFits = 0.75;
/// An explanation counts if it leaves at most this share of the distances.
constexpr double kExplainsTouches = 1.0 / 3;

double largest_extent(const Matrix3Xd& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

/// Returns true if there is an error beyond noise and beyond motions that the surface leaves free.
bool is_misfit(const geometry::Registration& found) {
  using enum geometry::RegistrationVerdict;
  if (found.verdict == too_few_points) return false;
  const bool fits = found.rms <= kSuspiciousRms && found.overlap >= kFits;
  return !fits || found.verdict == not_converged || found.verdict == poor_fit;
}

}  // namespace

geometry::Registration search_touches(const Matrix3Xd& tips, const geometry::TriangleMesh& surface,
                                      const geometry::RegistrationTarget& target,
                                      const TouchPlacementOptions& options) {
  geometry::RegistrationOptions search;
  if (options.T_camera_base_start) {
    search.T_target_source_start = *options.T_camera_base_start;
    search.search_rotation = options.start_turn;
    search.search_translation = options.start_shift;
  } else {
    const Eigen::AlignedBox3d box = geometry::bounding_box(surface);
    search.T_target_source_start = Eigen::Translation3d(
        Vector3d(box.center() - (tips.rowwise().maxCoeff() + tips.rowwise().minCoeff()) / 2));
    search.search_rotation = std::numbers::pi;
    search.search_translation = kMiddle * box.diagonal().norm();
  }
  return geometry::register_points(tips, target, search);
}

std::optional<std::string> impossible_touches(const Matrix3Xd& tips,
                                              const geometry::TriangleMesh& surface) {
  constexpr int kFewest = 3;  // that register_points takes
  if (tips.cols() < kFewest)
    return fmt::format("there are {} touches; at least {} are needed", tips.cols(), kFewestTouches);
  const double size = geometry::bounding_box(surface).diagonal().norm();
  const double ratio = largest_extent(tips) / size;
  if (ratio >= kTooSmall && ratio <= kTooLarge) return std::nullopt;
  std::string text =
      fmt::format("the touches extend over {:.3g} mm, and the surface over {:.3g} mm",
                  largest_extent(tips), size);
  for (const LengthUnit& unit : kOtherUnits) {
    // Touches cover a good part of the surface.
    const double converted = ratio * unit.mm;
    if (converted > kLeastCovered && converted < kMostCovered)
      return text + fmt::format(": the positions seem to be in {}; give millimetres", unit.name);
  }
  return text +
         ": touch the whole surface, give millimetres, and crop the surface to the touched part";
}

void explain_misfit(const Matrix3Xd& tips, const geometry::TriangleMesh& surface,
                    const geometry::RegistrationTarget& target,
                    const TouchPlacementOptions& options, const geometry::Registration& found,
                    ArmPlacement& placement) {
  if (!is_misfit(found)) return;
  const bool was_accepted = found.verdict == geometry::RegistrationVerdict::accepted;
  const auto fits = [&](const Matrix3Xd& others, const geometry::RegistrationTarget& onto,
                        const TouchPlacementOptions& how) {
    const geometry::Registration better = search_touches(others, surface, onto, how);
    return better.verdict == geometry::RegistrationVerdict::accepted &&
           (!was_accepted || better.rms < kExplainsTouches * found.rms);
  };
  const auto explain = [&](const std::string& cause) {
    placement.determined = false;
    placement.reason += "; " + cause;
  };
  TouchPlacementOptions anywhere = options;
  anywhere.T_camera_base_start.reset();
  if (options.T_camera_base_start) {
    TouchPlacementOptions inverse = options;
    inverse.T_camera_base_start = options.T_camera_base_start->inverse();
    if (fits(tips, target, inverse)) {
      return explain(
          "they fit from the inverse of the start pose: it must turn coordinates of the base into "
          "those of the camera, not the other way round");
    }
    if (fits(tips, target, anywhere)) {
      return explain(
          "they fit at a pose that is farther from the start pose than allowed: correct it, or "
          "leave it out");
    }
  }
  Matrix3Xd mirrored = tips;
  mirrored.row(0) *= -1;
  if (fits(mirrored, target, anywhere)) {
    return explain(
        "they fit if they are mirrored: the axes of the base are left-handed. One has the wrong "
        "sign, or two columns are exchanged");
  }
  geometry::TriangleMesh turned = surface;
  turned.triangles.row(1).swap(turned.triangles.row(2));
  if (options.tip_radius > 0 &&
      fits(tips, geometry::RegistrationTarget(turned, options.tip_radius), anywhere)) {
    return explain(
        "they fit the other side of the surface: its normals must point to where the tip comes "
        "from");
  }
  for (const LengthUnit& unit : kOtherUnits) {
    const double ratio =
        unit.mm * largest_extent(tips) / geometry::bounding_box(surface).diagonal().norm();
    if (ratio < kTooSmall || ratio > kTooLarge) continue;
    if (fits(unit.mm * tips, target, anywhere))
      return explain(fmt::format("they fit if their unit is {}; give millimetres", unit.name));
  }
}

}  // namespace palpate::probing
