// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/light_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::sensing {
namespace {

/// [mm] Distance at which the projector's white is 1.
constexpr double kUnitDistance = 1000;

/// A panel pixel is the image of a direction if the lens model leads back to it within this
/// [tangent]; otherwise the model has folded, and no real lens would send light there.
constexpr double kFoldTolerance = 1e-6;

/// Lambertian surfaces reflect 1 / pi of the light in each direction; Blinn's highlight relative to
/// that is (s + 8) / 8 times cos^s.
double highlight(const Body& body, const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
                 const Eigen::Vector3d& to_camera) {
  if (body.specular == 0) return 0;
  const double cosine = std::max(0.0, normal.dot((to_light + to_camera).normalized()));
  return body.specular * (body.shininess + 8) / 8 * std::pow(cosine, body.shininess);
}

}  // namespace

LightPath::LightPath(const Rig& rig, Axis axis, double falloff)
    : rig_(rig),
      axis_(axis == Axis::x ? 0 : 1),
      falloff_(falloff),
      distorted_(std::any_of(rig.projector.distortion.begin(), rig.projector.distortion.end(),
                             [](double k) { return k != 0; })),
      origin_(rig.T_projector_camera.inverse() * Eigen::Vector3d::Zero()) {}

bool LightPath::on_panel(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= rig_.projector.width - 0.5 &&
         pixel.y() <= rig_.projector.height - 0.5;
}

std::optional<Eigen::Vector2d> LightPath::panel_pixel(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d point = rig_.T_projector_camera * place;
  if (!(point.z() > 0)) return std::nullopt;
  const Eigen::Vector2d direction = point.hnormalized();
  const Eigen::Vector2d pixel = geometry::distort(rig_.projector, direction);
  if (!on_panel(pixel)) return std::nullopt;
  if (distorted_ &&
      !((geometry::undistort(rig_.projector, pixel) - direction).norm() <= kFoldTolerance)) {
    return std::nullopt;
  }
  return pixel;
}

Illumination LightPath::illuminate(const VirtualScene& scene, const SurfaceView& place) const {
  Illumination light;
  const Eigen::Vector3d to_light = origin_ - place.position;
  const double distance = to_light.norm();
  const Eigen::Vector3d direction = to_light / distance;
  light.projector_incidence =
      std::atan2(place.facet.cross(direction).norm(), place.facet.dot(direction));
  const auto pixel = panel_pixel(place.position);
  if (!pixel) return light;
  light.covered = true;
  light.pixel = *pixel;
  // The triangle's own normal decides what is dark, because it is the one that casts shadows.
  if (!(place.facet.dot(direction) > 0) || !scene.sees(place, origin_)) return light;
  light.lit = true;
  const double axis_cosine = (rig_.T_projector_camera * place.position).z() / distance;
  const double metres = distance / kUnitDistance;
  light.diffuse = std::pow(axis_cosine, falloff_) / (metres * metres) *
                  std::max(0.0, place.normal.dot(direction));
  light.highlight = light.diffuse * highlight(scene.body(place), place.normal, direction,
                                              -place.position.normalized());
  return light;
}

std::optional<Eigen::Vector2d> LightPath::shifted(const Eigen::Vector2d& pixel,
                                                  const ChromaticShift& shift) const {
  const Eigen::Array2d focal(rig_.projector.fx, rig_.projector.fy);
  const Eigen::Array2d center(rig_.projector.cx, rig_.projector.cy);
  Eigen::Array2d direction = (pixel.array() - center) / focal;
  direction[axis_] -= shift.gamma;
  const Eigen::Vector2d moved = focal * direction / shift.beta + center;
  if (!on_panel(moved)) return std::nullopt;
  return moved;
}

}  // namespace palpate::sensing
